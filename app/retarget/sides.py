"""Source and target side by side, as the preview draws them."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from app.retarget.retargeting import Retargeting
from app.retarget.solving import LABELS
from app.retarget.target import Target
from app.session import Session
from app.session.sides import Dot, Side
from engine.character import Character, bundled
from engine.editing import standard_places
from engine.errors import EditError
from engine.take import Array
from engine.words import counted

if TYPE_CHECKING:
    from engine.editing import Source

MARGIN = 0.25  # of a capture's extent, around it


def sides(session: Session, retargeting: Retargeting, chosen: str, *, dots: bool) -> tuple[Side, ...]:
    """Return the heads to show side by side; none where the take itself is shown.

    `chosen` is the marker that a click on the target places; `dots` are drawn on heads where they are asked for.
    """
    target, head = retargeting.target, retargeting.target.head
    if session.view.tool != "retarget" or (head is not None and not retargeting.ready):
        return ()
    frame = session.view.playhead
    capture = retargeting.capture
    if capture is not None:
        left = _of_capture(capture, frame, chosen if dots else "")
    else:
        left = _of_take(session, retargeting.performance.head, chosen, dots=dots)
    if head is None:
        hint = "Choose a head in the panel at the right:\nit will stand here and move as the source does."
        return left, Side("no head yet", None, box=_box(bundled().neutral.astype(np.float64)), hint=hint)
    by_name = retargeting.method == LABELS and capture is None
    state = "solved" if retargeting.result is not None else "weights by name" if by_name else "live"
    on_target = _on_head(target, retargeting.names, chosen) if dots else ()
    right = Side(f"{head.name} · {state}", retargeting.face_at(frame), head, on_target, pickable=dots and bool(chosen))
    return left, right


def _of_take(session: Session, head: Character, chosen: str, *, dots: bool) -> Side:
    shown: tuple[Dot, ...] = ()
    if dots:
        shown = tuple(
            Dot(name, vertex, number=str(number), chosen=name == chosen)
            for number, (name, vertex) in enumerate(_standard(head), 1)
        )
    return Side(
        f"{session.document.name} · {head.name}", session.document.frame_weights(session.view.playhead), head, shown
    )


def _of_capture(capture: Source, frame: int, chosen: str) -> Side:
    places = capture.neutral + capture.displacements[min(frame, len(capture) - 1)]
    dots = tuple(
        Dot(name, place=place, number=str(number) if name == chosen else "", chosen=name == chosen)
        for number, (name, place) in enumerate(zip(capture.names, places, strict=True), 1)
    )
    return Side(f"{capture.take.name} · {counted(len(dots), 'marker')}", None, None, dots, _box(capture.neutral))


def _on_head(target: Target, names: tuple[str, ...], chosen: str) -> tuple[Dot, ...]:
    return tuple(
        Dot(name, target.places[name], number=str(number), chosen=name == chosen)
        for number, name in enumerate(names, 1)
        if name in target.places
    )


def _box(points: Array) -> tuple[Array, Array]:
    low, high = points.min(axis=0), points.max(axis=0)
    return low - MARGIN * (high - low), high + MARGIN * (high - low)


@lru_cache(maxsize=4)
def _standard(head: Character) -> tuple[tuple[str, int], ...]:
    try:
        return tuple(standard_places(head).items())
    except EditError:
        return ()
