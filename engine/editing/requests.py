"""The requests of the verbs: a small frozen type for each, complete enough to be stored and repeated.

`stored` returns a request as JSON values, and `restored` builds the same request from them, bit for bit. Nothing here
loads a network or a solver, so that a window can build requests before they are loaded.
"""

from __future__ import annotations

import base64
import binascii
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Literal, Protocol, cast

import numpy as np

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.errors import EditError
from engine.inpaint.request import FillRequest
from engine.pose import Pose, filled
from engine.retouch import PASTE_FEATHER_S, SMOOTH_FEATHER_S
from engine.take import SHAPE_INDEX, SHAPES, Array

Frames = tuple[int, int]  # half-open
Change = Literal["set", "add", "scale"]
CHANGES: tuple[Change, ...] = ("set", "add", "scale")
DEFAULT_BELIEVABILITY = 0.5  # as `engine.regress.plausibility` has it, which takes torch to load
GONE = EditError("This edit does not say what it was made from.", "Make it anew.")


class Request(Protocol):
    """The interface of all requests, those of `heads` too.

    Attributes
    ----------
    verb : its name in a project file
    """

    verb: ClassVar[str]

    @property
    def frames(self) -> Frames | None:
        """The frames that it changes; None for all."""

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""


@dataclass(frozen=True, eq=False)
class DragRequest:
    """Target curves of the controls, which the face follows (BSBS19 section 4).

    Attributes
    ----------
    start : first frame
    asked : (n, 16) targets, or (n, 8) without the extended controls; NaN, and the take's own value, is no target
    believability : plausibility limit: 0 for none, 1 to stay within what this take or the recordings did
    """

    verb: ClassVar[str] = "drag"
    start: int
    asked: Array
    believability: float = DEFAULT_BELIEVABILITY

    @property
    def frames(self) -> Frames:
        """The frames of the target curves."""
        return self.start, self.start + len(self.asked)

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values, with the curves of those controls that have targets."""
        columns = np.flatnonzero(~np.isnan(self.asked).all(axis=0))
        curves = {ALL_CONTROLS[column].name: packed(self.asked[:, column]) for column in columns}
        known = {"start": self.start, "length": len(self.asked), "curves": curves}
        return {**known, "believability": self.believability}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> DragRequest:
        """Return the request that was stored."""
        curves = {ALL_INDEX[name]: unpacked(curve) for name, curve in inputs["curves"].items()}
        if any(curve.shape != (inputs["length"],) for curve in curves.values()) or not curves:
            raise GONE
        asked = np.full((int(inputs["length"]), len(ALL_CONTROLS)), np.nan)
        for column, curve in curves.items():
            asked[:, column] = curve
        return cls(int(inputs["start"]), asked, float(inputs["believability"]))


@dataclass(frozen=True)
class ControlRequest:
    """A change of one control over a range of frames.

    Attributes
    ----------
    control : its name
    frames : half-open
    change, amount : set to, add or scale by so many mm or degrees, or so many times
    believability : as of a drag
    """

    verb: ClassVar[str] = "control"
    control: str
    frames: Frames
    change: Change
    amount: float
    believability: float = DEFAULT_BELIEVABILITY

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {
            "control": self.control,
            "frames": list(self.frames),
            "change": self.change,
            "amount": self.amount,
            "believability": self.believability,
        }

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> ControlRequest:
        """Return the request that was stored."""
        if inputs["change"] not in CHANGES:
            raise GONE
        numbers = float(inputs["amount"]), float(inputs["believability"])
        return cls(str(inputs["control"]), _frames(inputs["frames"]), cast(Change, inputs["change"]), *numbers)


@dataclass(frozen=True, eq=False)
class WeightRequest:
    """A curve that replaces one weight; no network is involved.

    Attributes
    ----------
    shape : its name
    start : first frame
    curve : (n,)
    """

    verb: ClassVar[str] = "weight"
    shape: str
    start: int
    curve: Array

    @property
    def frames(self) -> Frames:
        """The frames of the curve."""
        return self.start, self.start + len(self.curve)

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {"shape": self.shape, "start": self.start, "curve": packed(self.curve)}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> WeightRequest:
        """Return the request that was stored."""
        return cls(str(inputs["shape"]), int(inputs["start"]), unpacked(inputs["curve"]))


@dataclass(frozen=True, eq=False)
class PasteRequest:
    """Copied weights in place, (n, 52) from frame `start`; the frames beside them ease over to the take."""

    verb: ClassVar[str] = "paste"
    start: int
    weights: Array
    feather_s: float = PASTE_FEATHER_S

    @property
    def frames(self) -> Frames:
        """The frames that are pasted over."""
        return self.start, self.start + len(self.weights)

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {"start": self.start, "weights": packed(self.weights), "feather_s": self.feather_s}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> PasteRequest:
        """Return the request that was stored."""
        return cls(int(inputs["start"]), unpacked(inputs["weights"]), float(inputs["feather_s"]))


@dataclass(frozen=True)
class SmoothRequest:
    """All weights low-passed over a range of frames by a Butterworth filter of zero phase."""

    verb: ClassVar[str] = "smooth"
    frames: Frames
    cutoff_hz: float
    feather_s: float = SMOOTH_FEATHER_S

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {"frames": list(self.frames), "cutoff_hz": self.cutoff_hz, "feather_s": self.feather_s}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> SmoothRequest:
        """Return the request that was stored."""
        return cls(_frames(inputs["frames"]), float(inputs["cutoff_hz"]), float(inputs["feather_s"]))


@dataclass(frozen=True)
class CleanRequest:
    """The tracker's noise removed over a range of frames; `strength` 0 leaves the take as it is, 1 cleans it fully."""

    verb: ClassVar[str] = "clean"
    frames: Frames
    strength: float = 1.0

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        return {"frames": list(self.frames), "strength": self.strength}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> CleanRequest:
        """Return the request that was stored."""
        return cls(_frames(inputs["frames"]), float(inputs["strength"]))


@dataclass(frozen=True, eq=False)
class PinRequest:
    """Poses required exactly at frames; the change spreads over a range (SLS12 section 6).

    Attributes
    ----------
    pins : pose by frame
    frames : half-open; outside it nothing changes
    whole : a pin without a weight pins that weight where the take has it; otherwise such weights are free
    closure : how firmly lips and lids that meet keep meeting; None as usual, 0 lets go
    """

    verb: ClassVar[str] = "pin"
    pins: Mapping[int, Pose]
    frames: Frames
    whole: bool = True
    closure: float | None = None

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values."""
        poses = {str(frame): _named(pose) for frame, pose in self.pins.items()}
        return {"pins": poses, "range": list(self.frames), "whole": self.whole, "closure": self.closure}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> PinRequest:
        """Return the request that was stored."""
        pins = {
            int(frame): {str(name): float(value) for name, value in pose.items()}
            for frame, pose in inputs["pins"].items()
        }
        closure = inputs["closure"]
        return cls(pins, _frames(inputs["range"]), bool(inputs["whole"]), None if closure is None else float(closure))


@dataclass(frozen=True, eq=False)
class SpansRequest:
    """Several spans filled one after the other, each with the pins and controls that lie in it.

    Attributes
    ----------
    spans : half-open ranges
    steering : what steers all of them; its `frames` do not count
    """

    verb: ClassVar[str] = "fill"
    spans: tuple[Frames, ...]
    steering: FillRequest = field(default_factory=lambda: FillRequest((0, 0)))

    @property
    def frames(self) -> Frames:
        """The frames from the first span's first to the last span's last."""
        return min(start for start, _ in self.spans), max(stop for _, stop in self.spans)

    def stored(self) -> dict[str, Any]:
        """Return the request as JSON values; a guide by its frames around all spans."""
        return {**replace(self.steering, frames=self.frames).stored(), "spans": [list(span) for span in self.spans]}

    @classmethod
    def restored(cls, inputs: Mapping[str, Any]) -> SpansRequest:
        """Return the request that was stored."""
        return cls(tuple(_frames(span) for span in inputs["spans"]), FillRequest.restored(inputs))


_BY_VERB = {
    each.verb: each
    for each in (DragRequest, ControlRequest, WeightRequest, PasteRequest, SmoothRequest, CleanRequest, PinRequest)
}
VERBS: tuple[str, ...] = (*_BY_VERB, FillRequest.verb)


def restored(verb: str, inputs: Mapping[str, Any]) -> Request:
    """Return the request of a verb from its stored form; raises `EditError` for anything else."""
    try:
        if verb == FillRequest.verb:
            return SpansRequest.restored(inputs) if "spans" in inputs else FillRequest.restored(inputs)
        return _BY_VERB[verb].restored(inputs)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, binascii.Error) as error:
        raise GONE from error


def packed(array: Array) -> dict[str, Any]:
    """Return an array as JSON values, NaN too."""
    rows = np.ascontiguousarray(array, "<f8")
    return {"shape": list(rows.shape), "f8": base64.b64encode(rows.tobytes()).decode("ascii")}


def unpacked(stored: Mapping[str, Any]) -> Array:
    """Return the array that `packed` stored; raises `ValueError` or `TypeError` for anything else."""
    numbers = np.frombuffer(base64.b64decode(stored["f8"], validate=True), "<f8")
    return numbers.reshape([int(size) for size in stored["shape"]]).astype(np.float64)


def _frames(stored: Any) -> Frames:
    start, stop = stored
    return int(start), int(stop)


def _named(pose: Pose) -> dict[str, float]:
    """Return a pose's weights by shape, without the free ones."""
    weights = filled(pose)
    return {name: float(weights[SHAPE_INDEX[name]]) for name in SHAPES if np.isfinite(weights[SHAPE_INDEX[name]])}
