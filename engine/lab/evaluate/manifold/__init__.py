"""Retargeting from labelled frames, and driving a mesh by points."""
