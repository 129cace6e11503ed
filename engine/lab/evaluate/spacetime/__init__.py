"""Retargeting to a second head and back."""
