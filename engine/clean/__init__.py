"""Removing the tracker and keeping the actor: a causal recurrent network for any frame rate (BSS20b)."""
