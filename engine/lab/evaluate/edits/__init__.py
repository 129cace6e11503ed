"""Edits that a person would make, asked for and reached."""
