"""One function for each verb of the user: a take and what is asked of it in, the patch that does it out."""

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


def drag(take: Take, asked: DragRequest, *, held: Array | None = None) -> Patch:
    """Bend the face by curves of its controls; `held`, (frames, 16), is what edits below asked, NaN where nothing."""
    return Editor(take, asked=held).patch(asked)


def set_control(take: Take, asked: ControlRequest) -> Patch:
    """Change one control over a range of frames; the whole face follows."""
    return Editor(take).patch(asked)


def replace_weight(take: Take, asked: WeightRequest) -> Patch:
    """Put a curve in place of one weight."""
    return Editor(take).patch(asked)


def paste(take: Take, asked: PasteRequest) -> Patch:
    """Put copied weights in place; the frames beside them ease over."""
    return Editor(take).patch(asked)


def smooth(take: Take, asked: SmoothRequest) -> Patch:
    """Low-pass all weights over a range of frames, shifting nothing in time."""
    return Editor(take).patch(asked)


def fill(take: Take, asked: FillRequest) -> Patch:
    """Fill a span with motion (BSS20)."""
    return Editor(take).patch(asked)


def fill_variants(take: Take, asked: FillRequest, count: int) -> list[Patch]:
    """Fill a span in several ways, from the request's seed on; a smooth curve there is but one."""
    return Editor(take).variants(asked, count)


def fill_spans(take: Take, asked: SpansRequest) -> Patch:
    """Fill several spans one after the other."""
    return Editor(take).patch(asked)


def clean(take: Take, asked: CleanRequest) -> Patch:
    """Remove the tracker's noise from a range of frames: the take, mixed with itself cleaned fully (BSS20b)."""
    return Editor(take).patch(asked)


def cleaned(take: Take, asked: CleanRequest) -> Cleaned:
    """Return what `clean` comes to but for rounding, with what was taken off and by how much it trails."""
    from engine.clean.takes import clean as by_network

    return by_network(take, strength=asked.strength, frames=asked.frames)


def pin(take: Take, asked: PinRequest) -> Patch:
    """Require poses exactly at frames, and spread the change over a range."""
    return Editor(take).patch(asked)


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
