"""The request to retarget a performance, and the function that solves it."""

from __future__ import annotations

from app.retarget.target import Target
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
    """Return the request to retarget a whole performance, by the movement of markers or by labels."""
    movement = target.request(matching)
    also = {
        "target": str(target.path or ""),
        "source": performance.take.name,
        "method": method,
        "labels": {str(frame): dict(pose) for frame, pose in target.labels.items()},
        "reading": target.reading.stored(),
    }
    request = LabelRequest(target.labels, movement) if method == LABELS else movement
    return Asked(KIND, request, performance, f"retarget to {movement.head.name}", also=also)


def carry_out(asked: Asked, tell: Tell) -> Retargeted:
    """Return the target's weights; calls `tell` with the share done, which may raise to stop it."""
    assert isinstance(asked.of, Performance)
    if isinstance(asked.inputs, LabelRequest):
        return retarget_from_labels(asked.of, asked.inputs, tell)
    assert isinstance(asked.inputs, RetargetRequest)
    return retarget(asked.of, asked.inputs, tell)
