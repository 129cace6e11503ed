"""Spans: marking frames for work, and filling them."""
