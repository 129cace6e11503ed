"""The wish to have a performance on another head, and what carries it out."""

from __future__ import annotations

from app.retarget.carry import Target
from app.session.asked import Asked
from app.session.edits import Tell
from engine.editing import (
    LabelRequest,
    Matching,
    Performance,
    Retargeted,
    RetargetRequest,
    retarget,
    retarget_from_labels,
)

MOVEMENT, LABELS = "movement", "labels"  # the methods
KIND = "retarget"  # of the edits that put a take on another head


def whole(performance: Performance, target: Target, matching: Matching, method: str) -> Asked:
    """Return the wish to have all of a performance on a target, by the movement of markers or by labels."""
    movement = target.request(matching)
    also = {
        "target": str(target.path or ""),
        "source": performance.take.name,
        "method": method,
        "labels": {str(frame): dict(pose) for frame, pose in target.labels.items()},
        "reading": target.reading.stored(),
    }
    request = LabelRequest(target.labels, movement) if method == LABELS else movement
    return Asked(KIND, request, performance, f"carry to {movement.head.name}", also=also)


def carry_out(asked: Asked, tell: Tell) -> Retargeted:
    """Return what the target does; `tell` is told the share done, and may raise to stop it."""
    assert isinstance(asked.of, Performance)
    if isinstance(asked.inputs, LabelRequest):
        return retarget_from_labels(asked.of, asked.inputs, tell)
    assert isinstance(asked.inputs, RetargetRequest)
    return retarget(asked.of, asked.inputs, tell)
