"""Live Link Face takes as spreadsheets and statistics programs save them again, brought back to the app's own CSV.

Separators may be semicolons or tabs, decimals have commas, cells quotes, the text is UTF-16, lines end as on an old
Mac, and a column of row numbers stands before the rest.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from engine.errors import FormatError

MOST_BYTES = 1 << 28  # such files are taken apart cell by cell; over an hour at 60 fps
HEADER_BYTES = 1 << 16  # of the first line, where the form of a file shows
DECIMAL_COMMA = re.compile(r"(-?[\d:]*),(\d+(?:[eE][-+]?\d+)?)")
INDEX = ("", "index", "unnamed: 0")  # what a column of row numbers is called
ADVICE = "Save it as CSV with commas, without quotes."
NOTICE = "Another program saved this file in a form of its own; Retake writes it as Live Link Face does."


@dataclass(frozen=True)
class Form:
    """How a file of cells is written.

    Attributes
    ----------
    encoding : of its text
    separator : of its cells
    numbered : whether a column of row numbers stands before the timecodes
    plain : whether that is what the app writes
    """

    encoding: str
    separator: str
    numbered: bool
    plain: bool


def form_of(head: bytes) -> Form | None:
    """Return how a file that begins with these bytes is written; None where it is no Live Link Face take."""
    encoding = "utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    text = head.decode(encoding, "ignore")
    first = re.split(r"[\r\n]", text, maxsplit=1)[0]
    separator = max(",;\t", key=first.count)
    names = [name.strip(' "').lower() for name in first.split(separator, 2)]
    numbered = len(names) > 1 and names[0] in INDEX and names[1] == "timecode"
    if not numbered and names[0] != "timecode":
        return None
    mac = "\r" in text and "\n" not in text
    plain = (encoding, separator, numbered, mac, '"' in text) == ("utf-8-sig", ",", False, False, False)
    return Form(encoding, separator, numbered, plain)


def plain_csv(content: bytes, path: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return a take as the app would write it, and what to say of that; a file that is so already comes back untouched.

    Raises `FormatError` where it is too large for that, or no text.
    """
    form = form_of(content[:HEADER_BYTES])
    if form is None or form.plain:
        return content, ()
    if len(content) > MOST_BYTES:
        raise FormatError(f"{path.name} is too large in this form.", ADVICE)
    try:
        return b"".join(_lines(content.decode(form.encoding), form)), (NOTICE,)
    except UnicodeDecodeError:
        raise FormatError(f"{path.name} is not a text file.") from None
    except csv.Error:
        raise FormatError(f"{path.name} is no table of cells.", ADVICE) from None


def _lines(text: str, form: Form) -> Iterator[bytes]:
    for row in csv.reader(io.StringIO(text, newline=None), delimiter=form.separator):
        if any(row):
            cells = row if form.separator == "," else [_with_point(cell) for cell in row]
            yield ",".join(cells[form.numbered :]).encode() + b"\n"


def _with_point(cell: str) -> str:
    found = DECIMAL_COMMA.fullmatch(cell.strip()) if "," in cell else None
    return f"{found[1] or 0}.{found[2]}" if found else cell
