"""The control curves: one lane each, and the tools that bend them."""
