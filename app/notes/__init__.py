"""Notes: remarks on frames."""
