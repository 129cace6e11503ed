"""Topology-preserving transfer (ZLL17): a performance onto a head without shapes, a mesh that follows a few points."""
