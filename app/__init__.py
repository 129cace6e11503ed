"""The program with a window and a command line; it imports the engine, never the reverse."""

import os

# A face is a small matrix product: shared out to threads, they wait for each other twenty times as long as it takes.
# Set before numpy is first imported, which is when it counts them.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
