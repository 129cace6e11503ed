"""Filling against interpolation, propagation and copying; what is asked for, hand edits, a blind sheet."""
