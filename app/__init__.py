"""The program with a window and a command line; it imports the engine, never the reverse.

To begin with
    `__main__` starts the window or a command; `main_job` is what `make run` does without a display.
The window, from the top down
    `window` puts all together; `actions` is what the user can do; `dialogs` open beside the work; then one folder for
    each thing the user sees: `clean`, `curves`, `inspector`, `live`, `notes`, `pins`, `preview`, `retarget`, `spans`,
    `timeline`; and `widgets`, the small pieces they share.
Under the window
    `playback` is sound, video and the clock; `session` is what is open, edited and kept; `settings` is remembered
    between starts; `background` runs slow work beside the window, and `theme` says what everything looks like.
Beside the window
    `cli` is the command line, `bench` measures every promised speed.
"""

import os

# A face is a small matrix product: shared out to threads, they wait for each other twenty times as long as it takes.
# Set before numpy is first imported, which is when it counts them.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
