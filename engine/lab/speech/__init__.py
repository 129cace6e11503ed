"""Labels of speech for training: all-phone decoding and lip reading."""
