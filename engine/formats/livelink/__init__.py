"""Live Link Face CSV: what the iPhone app records, and what generators imitate."""

from engine.formats.livelink.columns import DEFAULT_HEADER
from engine.formats.livelink.origin import Origin
from engine.formats.livelink.reader import MAX_COLUMNS, judged, parse, put, read, read_as, reread
from engine.formats.livelink.writer import header, rows, write

__all__ = [
    "DEFAULT_HEADER",
    "MAX_COLUMNS",
    "Origin",
    "header",
    "judged",
    "parse",
    "put",
    "read",
    "read_as",
    "reread",
    "rows",
    "write",
]
