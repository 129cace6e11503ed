"""Phones and the visemes that they belong to."""
