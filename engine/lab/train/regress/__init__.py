"""Training of the regressor, the autoencoder and the prior."""
