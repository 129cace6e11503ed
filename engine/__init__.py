"""Methods for editing facial performances: numpy, scipy and torch, no window and no renderer."""
