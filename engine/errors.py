"""Errors a person can act on: one sentence that says what is wrong, and one that says what to do."""

from __future__ import annotations

LONGEST = 300  # characters of a sentence with its advice; what a file holds may be named in either, at any length


class EngineError(Exception):
    """Something the user can mend: `sentence` says what is wrong, `advice` what to do about it.

    Both are one line, whatever a file's name or a label in it may hold, and no longer than people read.
    """

    def __init__(self, sentence: str, advice: str = "") -> None:
        self.advice = _short(advice, LONGEST * 2 // 3)
        self.sentence = _short(sentence, LONGEST - len(self.advice) - 1)
        super().__init__(self.sentence)

    def __str__(self) -> str:
        """Return the sentence, followed by the advice where there is one."""
        return f"{self.sentence} {self.advice}".strip()


def _short(text: str, most: int) -> str:
    """Return a text without line breaks and control characters, its middle left out where it is too long."""
    line = "".join(letter if letter.isprintable() else " " for letter in text[: 8 * LONGEST])
    if len(line) <= most and len(text) <= 8 * LONGEST:
        return line
    end = most // 2
    return f"{line[: most - end - 1].rstrip()}…{text[-end:] if text[-end:].isprintable() else line[-end:]}"


class FormatError(EngineError):
    """A file is not what its reader needs; the sentence names the file and, where known, row and column."""


class EditError(EngineError):
    """An edit asks for something that the take does not have."""


class AssetError(EngineError):
    """A file that belongs to the program is missing or damaged."""
