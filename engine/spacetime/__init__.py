"""Movement matching (SLS12): pins that spread, markers and takes that move to another head, with no training."""
