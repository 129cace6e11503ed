"""Synthetic performances and tracker faults: material for training, tests and the bundled demo take."""
