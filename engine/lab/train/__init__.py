"""Training of each network, one package per method."""
