"""Pins: a pose required exactly at a frame, spread over a range."""
