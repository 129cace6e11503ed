"""Reading small text files of unknown origin."""

from __future__ import annotations

from pathlib import Path

from engine.errors import FormatError

MAX_BYTES = 64 * 1024 * 1024


def read_text(path: Path) -> str:
    """Return a text in UTF-8, or UTF-16 with its mark; raises `FormatError` where it cannot be read or is no text."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FormatError(f"{path.name} is too large for a text of cues.")
        content = path.read_bytes()
    except OSError as error:
        raise FormatError(f"{path.name} could not be read: {(error.strerror or 'unknown reason').lower()}.") from error
    wide = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        return content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.") from None
