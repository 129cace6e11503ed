"""Denoising of tracked weights: a causal recurrent network for any frame rate (BSS20b)."""
