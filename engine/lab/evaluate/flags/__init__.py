"""Flags against planted faults."""
