"""Training of the cleaning network."""
