"""Cleaning: taking the tracker's noise off a span or a take."""
