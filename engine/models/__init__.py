"""What every network shares: checkpoints with their cards, windows, and resampling to the model rate."""
