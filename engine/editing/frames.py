"""Ranges of frames as people write them."""

from __future__ import annotations

from engine.errors import EditError
from engine.take import Take
from engine.words import counted


def parse_frames(text: str, take: Take) -> tuple[int, int]:
    """Return the half-open range that `A:B` names; raises `EditError` when it is not within the take."""
    try:
        start, stop = (int(part) for part in text.split(":"))
    except ValueError:
        raise EditError(
            f"{text!r} is not a range of frames.", "Write the first frame and the one after the last: 40:60."
        ) from None
    if not 0 <= start < stop <= len(take):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {counted(len(take), 'frame')}.")
    return start, stop
