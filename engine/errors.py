"""Errors a person can act on: one sentence that says what is wrong, and one that says what to do."""

from __future__ import annotations


class EngineError(Exception):
    """Something the user can mend: `sentence` says what is wrong, `advice` what to do about it."""

    def __init__(self, sentence: str, advice: str = "") -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.advice = advice

    def __str__(self) -> str:
        """Return the sentence, followed by the advice where there is one."""
        return f"{self.sentence} {self.advice}".strip()


class FormatError(EngineError):
    """A file is not what its reader needs; the sentence names the file and, where known, row and column."""


class EditError(EngineError):
    """An edit asks for something that the take does not have."""


class AssetError(EngineError):
    """A file that belongs to the program is missing or damaged."""
