"""When something was said, as people tell it."""

from __future__ import annotations

from datetime import datetime

from engine.words import plain


def signed(author: str, time: str) -> str:
    """Return who said something and when, on this computer's clock; a time that is none stands as it is."""
    return plain(", ".join(part for part in (author, when(time)) if part))


def when(time: str) -> str:
    """Return a time of ISO 8601 with day and minute; text that is no time as it is."""
    try:
        return f"{datetime.fromisoformat(time).astimezone():%d %b %Y, %H:%M}"
    except (ValueError, OverflowError, OSError):
        return time
