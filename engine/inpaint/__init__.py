"""Motion in-filling: generation of a span's motion from its context and any guidance there is (BSS20)."""
