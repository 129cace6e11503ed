"""Retargets a take or a capture to another head: by its movement, or from a few labelled frames."""
