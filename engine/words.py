"""Text that comes from outside, made safe to show; and numbers with their nouns."""

from __future__ import annotations

import re

NAME_LENGTH = 60  # characters of a name in a line with other things
SENTENCE_LENGTH = 300  # characters of a message
_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"
# Characters that turn the direction of what follows: with them `exe.gpj` reads `jpg.exe`.
_DIRECTIONS = "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
# C0 and C1 control codes without line feed, lone halves of a surrogate pair, and what is not a character.
_CONTROLS = "\x00-\x09\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufdd0-\ufdef\ufff9-\ufffb\ufffe\uffff"
_UNSAFE = re.compile(f"[{_CONTROLS}{_DIRECTIONS}]")
_LINE_ENDS = re.compile("\r\n|[\r\v\f\x85\u2028\u2029]")
_SPACES = re.compile(r"\s+")
MARKS_IN_A_ROW = 4  # accents on one letter; more are drawn over the lines above and below
_MARKS = re.compile(r"[\u0300-\u036f\u0483-\u0489\u1ab0-\u1aff\u1dc0-\u1dff\u20d0-\u20ff\ufe20-\ufe2f]+")


def plain(text: str, *, lines: bool = False, longest: int | None = None) -> str:
    """Return text from outside as it may be shown: no control codes, no turns of direction, no piles of accents.

    Control codes become the replacement character. White space is one space, save line ends where `lines` are kept.
    A text of more than `longest` characters is shortened in its middle.
    """
    text = text[: 20 * longest] if longest else text  # what is cut away in any case costs no time
    text = _LINE_ENDS.sub("\n", text).replace("\t", " ")
    text = _MARKS.sub(lambda found: found[0][:MARKS_IN_A_ROW], _UNSAFE.sub(_REPLACEMENT, text))
    text = text if lines else _SPACES.sub(" ", text).strip()
    return shortened(text, longest) if longest else text


def shortened(text: str, longest: int) -> str:
    """Return text of at most `longest` characters, with an ellipsis in the middle: names differ at their ends."""
    if len(text) <= longest:
        return text
    end = (longest - 1) // 3
    return f"{text[: longest - 1 - end]}…{text[len(text) - end :]}"


def terminal(text: str) -> str:
    """Return text as a terminal may get it: control codes and turns of direction as escapes such as ``\\x1b``."""
    return _UNSAFE.sub(lambda found: _escaped(found[0]), text.replace("\r\n", "\n"))


def _escaped(character: str) -> str:
    if character == "\t":
        return character
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def counted(number: int, noun: str, nouns: str = "") -> str:
    """Return a number with its noun: ``1 frame``, ``1,250 frames``; `nouns` where it is not made by an s."""
    return f"{number:,} {plural(number, noun, nouns)}"


def plural(number: int, noun: str, nouns: str = "") -> str:
    """Return a noun, or a verb, as it stands with a number."""
    return noun if number == 1 else nouns or f"{noun}s"
