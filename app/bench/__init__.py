"""Every speed the program promises, measured beside its goal: `retake bench`."""
