"""The source of `retake retarget` and `retake drive`: a take, or markers with the landmark of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.reading import open_take
from engine.errors import EditError
from engine.formats.base.content import require_file, unread
from engine.formats.livelink.plain import HEADER_BYTES, form_of
from engine.words import counted

if TYPE_CHECKING:
    from engine.character import Character
    from engine.editing import Performance
    from engine.formats.characters.marker_table import MarkerTable

MARKER_HELP = "For markers: correct the landmark of one, its name=a landmark; name= leaves it out."


@dataclass(frozen=True, eq=False)
class MarkedPerformance:
    """A performance to be retargeted.

    Attributes
    ----------
    performance : a take on the bundled head, or a capture
    table : the landmark of each marker of a capture; none for a take
    """

    performance: Performance
    table: MarkerTable | None = None

    def places(self, head: Character) -> dict[str, int]:
        """Return the vertex of each marker on a head; none for a take, whose markers are the standard ones."""
        from engine.formats.characters.marker_places import places_on

        if self.table is None:
            return {}
        source = self.performance.source
        return places_on(head, source.neutral, source.names, self.table)

    def show(self) -> None:
        """Print the landmark of each marker, where its name alone does not say it."""
        from app.cli.tables import show

        if self.table is None or all(row.how == "by name" for row in self.table.rows):
            return
        rows = [
            {"marker": row.marker, "landmark": row.landmark or "a place of its own", "how": row.how, "mm": row.away_mm}
            for row in self.table.rows
        ]
        show("Markers", rows, as_json=False)


def performance_of(
    path: Path,
    *,
    neutral: int,
    fps: float | None,
    sides: str,
    unit: str | None = None,
    marker: Sequence[str] | None = None,
    placed: bool = False,
) -> MarkedPerformance:
    """Read a take or a capture; raises `EngineError`.

    Parameters
    ----------
    path : the file
    neutral : for a capture, a frame in which the face is at rest
    fps : instead of what the file says
    sides : of a take, as `--sides` has it
    unit : for a capture, instead of what the file says
    marker : corrections of what markers were taken for, `name=landmark` each
    placed : whether a landmark file says where the markers are: their names need not be understood then
    """
    from engine.character import bundled
    from engine.editing import Performance, capture_of
    from engine.formats import markers
    from engine.formats.characters.marker_places import match_markers

    changes = pairs(marker or [])
    if path.suffix.lower() not in markers.ENDINGS or is_take(path):
        if changes:
            raise EditError("A take has no markers to correct.", "Leave out --marker.")
        return MarkedPerformance(Performance(open_take(path, fps, sides), bundled()))
    capture = markers.read(path, unit=unit, fps=fps)
    if not 0 <= neutral < len(capture):
        raise EditError(f"Frame {neutral} is not within the capture, which has {counted(len(capture), 'frame')}.")
    if placed:
        source = capture_of(capture, neutral_frame=neutral)
        return MarkedPerformance(Performance(source.take, bundled(), source))
    table = match_markers(capture.positions[neutral], capture.names).corrected(changes)
    source = capture_of(capture, neutral_frame=neutral, turn=table.turn, landmarks=table.landmarks)
    return MarkedPerformance(Performance(source.take, bundled(), source), table)


def is_take(path: Path) -> bool:
    """Return whether a file begins as a Live Link Face take does; a CSV may also hold markers."""
    require_file(path)
    try:
        with path.open("rb") as file:
            return form_of(file.read(HEADER_BYTES)) is not None
    except OSError as error:
        raise unread(path, error) from error


def pairs(texts: Sequence[str]) -> dict[str, str]:
    """Return what `name=value` texts say, by name; raises `EditError` for another text."""
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise EditError(f"{text[:40]!r} is not a name and a value.", "Write them with = between.")
        found[name.strip()] = value.strip()
    return found
