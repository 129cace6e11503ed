"""Cleaning against filters and memoryless learners."""
