"""Reading small text files of unknown origin."""

from __future__ import annotations

from pathlib import Path

from engine.errors import FormatError
from engine.formats.content import content_of

MAX_BYTES = 64 * 1024 * 1024


def read_text(path: Path) -> str:
    """Return a text in UTF-8, or UTF-16 with its mark; raises `FormatError` where it cannot be read or is no text."""
    content = content_of(path, at_most=MAX_BYTES)
    wide = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        return content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.") from None
