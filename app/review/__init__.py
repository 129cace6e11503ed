"""Reviewing in the window: the list of changes, the verdict, and the report."""
