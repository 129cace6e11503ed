"""The request of a fill, and the check that it fits the take: a mistake is reported before anything is generated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Literal

import numpy as np

from engine.controls import control_index
from engine.errors import EditError
from engine.inpaint.regions import region_shapes
from engine.inpaint.stored import FAULTS, FIELDS, GONE, guide_of, stored_guide
from engine.pose import Pose, filled
from engine.speech.visemes import Cue, class_of
from engine.take import SHAPES, Array, Take, require_frames
from engine.words import counted

LOWEST, HIGHEST = -0.1, 1.1  # range of pinned weights: recorded ones exceed 0..1 a little
FARTHEST_MM = 1000.0  # largest control target: more is a slip, and far more would overflow
Frames = tuple[int, int]
Style = Literal["auto", "bridge", "perform"]
STYLES: tuple[Style, ...] = ("auto", "bridge", "perform")


@dataclass(frozen=True, eq=False)
class FillRequest:
    """The inputs of a fill; `fill` explains those that are not listed here.

    Attributes
    ----------
    lost : allows spans of a single frame
    besides : further spans that are marked for work: no motion is retrieved from them
    unmade : those among them that are not filled yet: they are no context, like lost frames
    seed : which of the many possible motions
    """

    verb: ClassVar[str] = "fill"
    frames: Frames
    region: str = "face"
    pins: Mapping[int, Pose] = field(default_factory=dict)
    guide: Take | None = None
    guide_offset: int = 0
    visemes: tuple[Cue, ...] = ()
    controls: Mapping[str, Array | float] = field(default_factory=dict)
    style: Style = "auto"
    lost: bool = False
    besides: tuple[Frames, ...] = ()
    unmade: tuple[Frames, ...] = ()
    seed: int = 0

    def poses(self) -> dict[int, Array]:
        """Return pins as (52,) weights by frame, NaN where a shape is free."""
        return {frame: filled(pose) for frame, pose in self.pins.items()}

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values; of a guide, the frames around the span."""
        start, stop = self.frames
        guide = stored_guide(self.guide, (start + self.guide_offset, stop + self.guide_offset))
        return {name: field.encode(getattr(self, name)) for name, field in FIELDS.items()} | guide

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> FillRequest:
        """Return the request of what `stored` returned; raises `EditError` for anything else."""
        known = {"seed": 0, **inputs}  # an older version stored the seed beside the request
        try:
            return cls(guide=guide_of(inputs), **{name: field.decode(known[name]) for name, field in FIELDS.items()})
        except FAULTS as error:
            raise GONE from error


def merged_pins(pins: Iterable[tuple[int, Pose]]) -> dict[int, Pose]:
    """Return pins by frame, those of one frame joined; raises `EditError` where two disagree."""
    merged: dict[int, Array] = {}
    for frame, pose in pins:
        new = filled(pose)
        old = merged.get(frame, np.full(len(SHAPES), np.nan))
        clash = np.isfinite(old) & np.isfinite(new) & (old != new)
        if clash.any():
            shape = SHAPES[int(np.flatnonzero(clash)[0])]
            raise EditError(f"Two pins at frame {frame} ask for different values of {shape}.", "Keep one of them.")
        merged[frame] = np.where(np.isfinite(new), new, old)
    return dict(merged)


def checked(request: FillRequest, take: Take) -> FillRequest:
    """Return a request that fits a take; raises `EditError` with one sentence where it does not."""
    _check_span(request, take)
    _check_pins(request)
    if request.guide is not None:
        _check_guide(request, request.guide, take)
    for cue in request.visemes:
        class_of(cue.label)
        if not (np.isfinite([cue.start_s, cue.stop_s]).all() and cue.start_s <= cue.stop_s):
            raise EditError(f"The viseme {cue.label!r} ends before it begins.")
    length = request.frames[1] - request.frames[0]
    return replace(request, controls={name: _curve(name, c, length) for name, c in request.controls.items()})


def _check_span(request: FillRequest, take: Take) -> None:
    start, stop = request.frames
    require_frames(take, start, stop)
    if stop - start < 2 and not request.lost:
        raise EditError("A span of one frame cannot be filled.", "Mark at least two frames.")
    if request.style not in STYLES:
        raise EditError(f"There is no style called {request.style!r}.", f"Styles are: {', '.join(STYLES)}.")
    whole = (start, stop) == (0, len(take)) and region_shapes(request.region).all()
    if whole and not (request.pins or request.guide is not None or request.visemes or request.controls):
        raise EditError(
            "The span covers the whole take and nothing says what should happen in it.",
            "Leave some frames outside it, or add a pin, a guide, visemes or a control curve.",
        )


def _check_pins(request: FillRequest) -> None:
    start, stop = request.frames
    region = region_shapes(request.region)
    for frame, pose in request.poses().items():
        if not start <= frame < stop:
            raise EditError(f"The pin at frame {frame} lies outside the span {start}:{stop}.")
        pinned = np.isfinite(pose)
        if not (pinned & region).any():
            raise EditError(f"The pin at frame {frame} moves nothing in the region {request.region!r}.")
        outside = pinned & ((pose < LOWEST) | (pose > HIGHEST))
        if outside.any():
            shape = SHAPES[int(np.flatnonzero(outside)[0])]
            raise EditError(f"The pin at frame {frame} sets {shape} outside 0..1.")


def _check_guide(request: FillRequest, guide: Take, take: Take) -> None:
    if abs(guide.fps / take.fps - 1) > 1e-3:
        raise EditError(
            f"The guide runs at {guide.fps:.5g} frames per second, the take at {take.fps:.5g}.",
            "Use a guide of the same rate.",
        )
    first, last = request.frames[0] + request.guide_offset, request.frames[1] + request.guide_offset
    if first < 0 or last > len(guide):
        raise EditError(
            f"The guide has {counted(len(guide), 'frame')} and does not cover the span, which needs its frames {first}:{last}.",
            "Use a longer guide, or another offset.",
        )
    if guide.lost[first:last].all():
        raise EditError("The guide has no face anywhere in the span.", "Use another guide or another offset.")


def _curve(name: str, curve: Array | float, length: int) -> Array:
    control_index(name)
    target = np.asarray(curve, np.float64)
    if target.ndim > 1 or target.size not in (1, length):
        raise EditError(
            f"The curve for {name} has {counted(target.size, 'value')} where the span has {counted(length, 'frame')}.",
            "Give one value per frame of the span, or one for all.",
        )
    if np.isnan(target).all():
        raise EditError(f"The curve for {name} asks for nothing: it holds no number.")
    if (target > FARTHEST_MM).any() or (target < 0).any():
        raise EditError(f"The curve for {name} asks for a distance that is negative or beyond {FARTHEST_MM:,.0f} mm.")
    return np.array(np.broadcast_to(target.reshape(-1), (length,)))
