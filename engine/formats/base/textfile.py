"""Reading small text files of unknown origin."""

from __future__ import annotations

from pathlib import Path

from engine.errors import FormatError
from engine.formats.base.content import content_of

MAX_BYTES = 64 * 1024 * 1024
_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb": "utf-8-sig"}


def read_text(path: Path, *, at_most: int = MAX_BYTES, latin: bool = False) -> str:
    """Return a text in UTF-8, or UTF-16 with or without its mark; with `latin`, in Latin-1 where it is neither.

    Raises `FormatError` where it cannot be read or is no text.
    """
    content = content_of(path, at_most=at_most)
    encodings = [_MARKS.get(content[:2]) or _unmarked(content) or "utf-8", *(["cp1252", "latin-1"] if latin else [])]
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if latin and "\0" in text[:4096]:
            break
        return text
    raise FormatError(f"{path.name} is not a text file.")


def _unmarked(content: bytes) -> str:
    """Return the encoding of UTF-16 text without a mark, told by the zeros beside its letters; else nothing."""
    head = content[:64]
    if len(head) < 8:
        return ""
    if not any(head[0::2]) and all(head[1::2]):
        return "utf-16-be"
    return "utf-16-le" if all(head[0::2]) and not any(head[1::2]) else ""
