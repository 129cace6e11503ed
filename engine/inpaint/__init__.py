"""Filling a marked span with believable motion, steered by as much or as little as is known (BSS20)."""
