"""The window: how it starts, its frame, and what puts the panels together."""
