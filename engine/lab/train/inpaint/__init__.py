"""Training of the inpainter and the network of the expected face."""
