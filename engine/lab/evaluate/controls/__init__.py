"""A whole take from its control curves alone."""
