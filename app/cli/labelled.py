"""`retake retarget --method manifold`: a performance onto another head by frames at which a person posed it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from engine.errors import EditError
from engine.words import counted

if TYPE_CHECKING:
    from app.cli.performance import MarkedPerformance
    from engine.character import Character
    from engine.editing import Performance
    from engine.formats.labels import LabelFile
    from engine.take import Take

LABEL_HELP = "For manifold: frames and how the target stands there, in JSON or CSV."
SUGGEST_HELP = "For manifold: print this many frames worth labelling next, and write nothing."


def suggest(performance: Performance, count: int, labels: Path | None) -> list[int]:
    """Return frames worth labelling, best first, beside those of a label file; raises `EngineError`."""
    from engine.editing import suggest_frames

    if count < 1:
        raise EditError("Ask for one suggested frame or more.")
    known = list(_read(labels).labels) if labels is not None else []
    if known and max(known) >= len(performance.take):
        frames = counted(len(performance.take), "frame")
        raise EditError(f"Frame {max(known)} has a label; the source has {frames}.")
    return suggest_frames(performance, count, known)


def retarget(performance: MarkedPerformance, character: Path | None, labels: Path | None) -> tuple[Take, Character]:
    """Return the take that the labels make of a performance, and the head it is for; raises `EngineError`."""
    from engine.character import bundled
    from engine.editing import LabelRequest, RetargetRequest, retarget_from_labels
    from engine.formats.characters.opening import character_of

    if labels is None:
        raise EditError("There are no labelled frames.", "Name a file of them with --labels; --suggest says which.")
    asked = _read(labels)
    path = character or asked.target
    if path is None and asked.elsewhere:
        name = asked.elsewhere.replace("\\", "/").rpartition("/")[2][:60]
        raise EditError(
            f"{labels.name} is for the head {name!r}, which does not lie beside it.", "Name the head with --character."
        )
    target = bundled() if path is None else character_of(path)
    request = LabelRequest(asked.labels, RetargetRequest(target, performance.places(target)))
    return retarget_from_labels(performance.performance, request).take, target


def _read(path: Path) -> LabelFile:
    from engine.formats import labels

    return labels.read(path)
