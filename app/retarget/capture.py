"""A capture that was opened: its marker motion, the landmark of each marker, and the markers' places on the target."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from app.retarget.target import Target, with_markers
from engine.editing import capture_of
from engine.errors import EditError
from engine.formats import markers
from engine.formats.characters.marker_table import MarkerMatch, MarkerTable
from engine.words import counted

if TYPE_CHECKING:
    from engine.editing import Source


@dataclass(frozen=True, eq=False)
class Capture:
    """A capture, ready to be retargeted.

    Attributes
    ----------
    source : its marker motion
    target : the head it is carried to, its markers placed there
    doubt : why its markers could not be understood; None where they were
    """

    source: Source
    target: Target
    doubt: EditError | None = None

    def on(self, target: Target) -> Target:
        """Return the target with the capture's markers; placed anew where another head was chosen meanwhile."""
        if target.head is self.target.head:
            return replace(target, markers=self.target.markers, places=self.target.places)
        return with_markers(target, self.source, self.target.markers)


def captured(path: Path, neutral_frame: int, target: Target) -> Capture:
    """Read a capture and tell what its markers are by a frame in which the face is at rest; raises `EngineError`.

    Markers that lie on no face are kept: a person places them.
    """
    from engine.formats.characters.marker_places import match_markers

    read, doubt = markers.read(path), None
    if not 0 <= neutral_frame < len(read):
        raise EditError(f"Frame {neutral_frame} is not within the capture, which has {counted(len(read), 'frame')}.")
    try:
        table = match_markers(read.positions[neutral_frame], read.names)
    except EditError as error:
        doubt = error
        table = MarkerTable(tuple(MarkerMatch(name, "", 0.0, "by place") for name in read.names))
    source = capture_of(
        read, neutral_frame=neutral_frame, turn=None if doubt else table.turn, landmarks=table.landmarks
    )
    return Capture(source, with_markers(target, source, table), doubt)
