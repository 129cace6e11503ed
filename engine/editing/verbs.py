"""The verbs of the user: each takes a take and a request, and returns a patch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from engine.editing.editor import Editor
from engine.editing.requests import (
    CleanRequest,
    ControlRequest,
    DragRequest,
    PasteRequest,
    PinRequest,
    SmoothRequest,
    SpansRequest,
    WeightRequest,
)
from engine.inpaint.request import FillRequest
from engine.patch import Patch
from engine.take import Array, Take, runs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from engine.clean.takes import Cleaned
    from engine.pose import Pose


def drag(take: Take, request: DragRequest, *, held: Array | None = None) -> Patch:
    """Move the face to target curves of its controls; `held`, (frames, 16), are the targets of earlier edits, NaN for none."""
    return Editor(take, asked=held).patch(request)


def set_control(take: Take, request: ControlRequest) -> Patch:
    """Change one control over a range of frames; the whole face follows."""
    return Editor(take).patch(request)


def replace_weight(take: Take, request: WeightRequest) -> Patch:
    """Put a curve in place of one weight."""
    return Editor(take).patch(request)


def paste(take: Take, request: PasteRequest) -> Patch:
    """Put copied weights in place; the frames beside them ease over."""
    return Editor(take).patch(request)


def smooth(take: Take, request: SmoothRequest) -> Patch:
    """Low-pass all weights over a range of frames, shifting nothing in time."""
    return Editor(take).patch(request)


def fill(take: Take, request: FillRequest) -> Patch:
    """Fill a span with motion (BSS20)."""
    return Editor(take).patch(request)


def fill_variants(take: Take, request: FillRequest, count: int) -> list[Patch]:
    """Fill a span once per seed from the request's seed on; a smooth curve has a single variant."""
    return Editor(take).variants(request, count)


def fill_spans(take: Take, request: SpansRequest) -> Patch:
    """Fill several spans one after the other."""
    return Editor(take).patch(request)


def clean(take: Take, request: CleanRequest) -> Patch:
    """Remove the tracker's noise from a range of frames by blending the take with the network's estimate (BSS20b)."""
    return Editor(take).patch(request)


def cleaned(take: Take, request: CleanRequest) -> Cleaned:
    """Return the result of `clean`, but for rounding, with what was removed and the lag."""
    from engine.clean.takes import clean as by_network

    return by_network(take, strength=request.strength, frames=request.frames)


def pin(take: Take, request: PinRequest) -> Patch:
    """Pin poses exactly at frames and spread the change over a range (SLS12 section 6)."""
    return Editor(take).patch(request)


def pose_reaching(take: Take, frame: int, controls: Mapping[str, float]) -> Array:
    """Return the pose, (52,), nearest to a frame's whose controls have given values in mm, as far as weights allow."""
    from engine.spacetime import pin as pins

    return pins.pose_reaching(take, frame, controls)


def lost_spans(take: Take) -> tuple[tuple[int, int], ...]:
    """Return the lost runs of a take as spans to fill."""
    return tuple(runs(take.lost))


def merged_pins(pins: Iterable[tuple[int, Pose]]) -> dict[int, Pose]:
    """Return pins by frame, those of one frame joined; raises `EditError` where two disagree."""
    from engine.inpaint import request

    return request.merged_pins(pins)
