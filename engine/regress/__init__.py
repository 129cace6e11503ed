"""From control curves to a whole face: U-Net regressor and stacked denoising autoencoder (BSBS19)."""
