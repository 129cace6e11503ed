"""A painter that writes down what it is told to draw."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

LETTER_PX = 6.0


class Pen:
    """Stands in for a painter; every letter is `LETTER_PX` wide.

    Attributes
    ----------
    drawn : the name of each call that draws and its arguments, in their order
    """

    def __init__(self) -> None:
        self.drawn: list[tuple[str, tuple[Any, ...]]] = []

    def __getattr__(self, name: str) -> Callable[..., None]:
        def note(*arguments: Any) -> None:
            if name.startswith(("draw", "fill")):
                self.drawn.append((name, arguments))

        return note

    def fontMetrics(self) -> SimpleNamespace:
        return SimpleNamespace(
            horizontalAdvance=lambda text: LETTER_PX * len(text),
            elidedText=lambda text, _, room: text[: int(room / LETTER_PX)],
        )

    def of(self, name: str) -> list[tuple[Any, ...]]:
        """The arguments of each call of a name."""
        return [arguments for each, arguments in self.drawn if each == name]

    @property
    def texts(self) -> list[str]:
        """What was written, in its order."""
        return [arguments[-1] for arguments in self.of("drawText")]
