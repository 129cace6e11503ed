"""What a user asks for, on its way to an undo step."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from engine.editing import Request
from engine.take import Array, Take

if TYPE_CHECKING:
    from app.session.document import Document
    from engine.editing import Performance
    from engine.project import Marks

LARGEST_KEPT = 1 << 16  # characters of arrays that a step keeps; a project that is opened sets memory aside for each


@dataclass(frozen=True, eq=False)
class Base:
    """A take that something is asked of.

    Attributes
    ----------
    take : as the edits below left it
    controls : (frames, 16) measured on it
    asked : (frames, 16) what those edits asked for, NaN where nothing
    """

    take: Take
    controls: Array
    asked: Array

    @classmethod
    def of(cls, document: Document) -> Base:
        """Return what is open."""
        return cls(document.take, document.controls, document.asked)


@dataclass(frozen=True, eq=False)
class Asked:
    """A wish of the user.

    Attributes
    ----------
    verb : what the step is, as a project file names it
    inputs : all that it takes to carry it out again
    of : what it is asked of
    title : what the user did, as the Undo menu shows it; empty while a gesture lasts
    marks : what the session's marks become with it, if anything
    also : what else a project file remembers of it
    variants : how many ways of doing it are wanted
    since : when the user asked, on the clock of `time.perf_counter`
    """

    verb: str
    inputs: Request
    of: Base | Performance
    title: str = ""
    marks: Marks | None = None
    also: Mapping[str, Any] = field(default_factory=dict)
    variants: int = 1
    since: float = field(default_factory=time.perf_counter)

    @property
    def frames(self) -> tuple[int, int]:
        """The frames that it is about, half-open."""
        return self.inputs.frames or (0, len(self.of.take))

    @property
    def stored(self) -> dict[str, Any]:
        """What a project file keeps, so that it can be done again; without the inputs where they are very large."""
        inputs = self.inputs.stored()
        if _length(inputs) > LARGEST_KEPT:
            inputs = {name: value for name, value in inputs.items() if not _length(value)}
        together = (
            {"variants": self.variants} if self.variants > 1 else {}
        )  # networks round by how many they make at once
        return {**self.also, "request": self.inputs.verb, **together, **inputs}


def _length(stored: Any) -> int:
    """Return how many characters the packed arrays among an edit's inputs take."""
    if isinstance(stored, Mapping):
        return len(stored["f8"]) if "f8" in stored else sum(_length(value) for value in stored.values())
    return 0
