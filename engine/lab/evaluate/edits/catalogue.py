"""Edits that a person would make: thirty kinds, each at the places of a take that call for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks

from engine.controls import ALL_CONTROLS, ALL_INDEX
from engine.easing import ease
from engine.extended import bundled_face
from engine.lab.corpus import Piece
from engine.regress.areas import AREAS
from engine.take import SHAPES, Array, Mask, runs

EASE_FRAMES = 4  # over which a wanted curve comes and goes beside its frames
ROOM = 24  # frames of the piece beyond an edit, so that what eases out can be seen to end
PLACES = 5  # of each kind
MOUTH = AREAS[0].controls
LIDS = ("eyelid_right", "eyelid_left")
HEIGHTS = ("corner_height_right", "corner_height_left")
BROWS = ("brow_right", "brow_left")

Frames = tuple[int, int]  # half-open
Rule = Callable[[Array], list[Frames]]  # control curves, (frames, 16) in mm, to places that fit
Wanted = Callable[[Array], Array]  # a stretch of one control, (n,) in mm, to what it shall be


def _named(*prefixes: str, but: str = "") -> Mask:
    return np.array([name.startswith(prefixes) and not (but and name.endswith(but)) for name in SHAPES])


_LOWER = ("jaw", "mouth", "cheekPuff", "tongue", "noseSneer", "cheekSquint")  # a mouth takes cheeks and nose along
_LID_SHAPES = ("eyeBlink", "eyeSquint", "eyeWide", "cheekSquint")
SPEAKS_OF: dict[str, Mask] = {
    "mouth": _named(*_LOWER),
    "left corner": _named(*_LOWER, but="Right") | _named("mouthRight", "jawRight"),
    "eyes": _named(*_LID_SHAPES),
    "right eye": _named(*_LID_SHAPES, but="Left"),
    "brows of the eyes": _named("brow"),
    "gaze of the eyes": _named("eyeLook"),
}


@dataclass(frozen=True)
class Kind:
    """One thing that people do.

    Attributes
    ----------
    name : in the table
    part : key of `SPEAKS_OF`: the shapes that may move
    places : which moments of a take call for it
    wanted : control by control, in the order in which a person would pull them
    """

    name: str
    part: str
    places: Rule
    wanted: Mapping[str, Wanted]

    @property
    def needs_whole_face(self) -> bool:
        """Whether a take of the mouth alone has no place for it."""
        return "eye" in self.part


@dataclass(frozen=True, eq=False)
class Scripted:
    """One edit: `asked`, (frames of the piece, 16) in mm, is NaN wherever nothing is asked."""

    kind: Kind
    piece: Piece
    frames: Frames
    asked: Array


def _to(value: float) -> Wanted:
    return lambda curve: np.full_like(curve, value)


def _by(mm: float) -> Wanted:
    return lambda curve: curve + mm


def _times(factor: float) -> Wanted:
    return lambda curve: curve * factor


def _about_its_ends(factor: float) -> Wanted:
    def wanted(curve: Array) -> Array:
        line = np.linspace(curve[0], curve[-1], len(curve))
        return np.asarray(line + factor * (curve - line))

    return wanted


def _slower(curve: Array) -> Array:
    """Return a stretch that takes twice as long about its lowest frame."""
    frame, lowest = np.arange(len(curve)), int(np.argmin(curve))
    return np.interp((frame - lowest) / 2 + lowest, frame, curve)


def _earlier(curve: Array) -> Array:
    frame = np.arange(len(curve))
    return np.interp(frame + 3, frame, curve)


def _around(frames: npt.NDArray[np.int64], half: int) -> list[Frames]:
    return [(int(frame) - half, int(frame) + half + 1) for frame in frames]


def _vowels(controls: Array) -> list[Frames]:
    """Return where the mouth opens most, for a quarter of a second."""
    lips = controls[:, ALL_INDEX["lips_vertical"]]
    return _around(find_peaks(lips, height=8.0, prominence=4.0)[0], 3)


def _weak_closures(half: int) -> Rule:
    """Return where lips come near each other between two openings and do not meet: a bilabial that the tracker missed."""

    def rule(controls: Array) -> list[Frames]:
        lips = controls[:, ALL_INDEX["lips_vertical"]]
        return _around(find_peaks(-lips, height=(-8.0, -1.5), prominence=3.0)[0], half)

    return rule


def _stretches(frames: int, kept: Callable[[Array], bool]) -> Rule:
    """Return stretches of so many frames, one after another, whose controls, (frames, 16) in mm, are of a sort."""

    def rule(controls: Array) -> list[Frames]:
        starts = range(0, len(controls) - frames + 1, frames)
        return [(start, start + frames) for start in starts if kept(controls[start : start + frames])]

    return rule


def _speaks(controls: Array) -> bool:
    lips = controls[:, ALL_INDEX["lips_vertical"]]
    return bool(np.ptp(lips) > 6.0 and np.abs(np.diff(lips)).mean() > 0.4)


def _rests(controls: Array) -> bool:
    return bool(np.ptp(controls[:, [ALL_INDEX[name] for name in MOUTH]], axis=0).max() < 4.0)


def _looks(controls: Array) -> bool:
    lids = controls[:, [ALL_INDEX[name] for name in LIDS]]
    return bool(lids.min() > 7.0)


def _blinks(half: int) -> Rule:
    """Return the frames of both lids' blinks and some on either side."""

    def rule(controls: Array) -> list[Frames]:
        lids = controls[:, [ALL_INDEX[name] for name in LIDS]].max(axis=1)
        return [(start - half, stop + half) for start, stop in runs(lids < 5.0) if stop - start <= 9]

    return rule


def _all(controls: Sequence[str], wanted: Wanted) -> dict[str, Wanted]:
    return dict.fromkeys(controls, wanted)


_WIDER = {"lips_horizontal": _by(7.0), "corner_right": _by(4.0), "corner_left": _by(4.0)}

KINDS: tuple[Kind, ...] = (
    Kind("close the lips on a bilabial", "mouth", _weak_closures(1), {"lips_vertical": _to(0.0)}),
    Kind("close the lips earlier", "mouth", _weak_closures(6), {"lips_vertical": _earlier}),
    Kind("open the jaw on a vowel", "mouth", _vowels, {"lips_vertical": _by(6.0)}),
    Kind("lips wider on a vowel", "mouth", _vowels, {"lips_horizontal": _by(5.0)}),
    Kind("raise the upper lip", "mouth", _vowels, {"nose_to_lip": _by(-2.0)}),
    Kind("lower the lower lip", "mouth", _vowels, {"chin_to_lip": _by(-2.0)}),
    Kind("smile while speaking", "mouth", _stretches(45, _speaks), _WIDER),
    Kind("halve all mouth motion", "mouth", _stretches(60, _speaks), _all(MOUTH, _about_its_ends(0.5))),
    Kind("exaggerate a phrase x1.5", "mouth", _stretches(40, _speaks), _all(MOUTH[:2], _about_its_ends(1.5))),
    Kind("hold the mouth for a second", "mouth", _stretches(30, _speaks), _all(MOUTH, lambda c: np.full_like(c, c[0]))),
    Kind("keep the lips shut for a word", "mouth", _stretches(24, _speaks), {"lips_vertical": _to(0.0)}),
    Kind("purse the lips", "mouth", _stretches(20, _rests), {"lips_horizontal": _by(-5.0)}),
    Kind("smile on one side", "left corner", _stretches(30, _rests), {"corner_left": _by(4.0)}),
    Kind("force a blink", "eyes", _stretches(5, _looks), _all(LIDS, _to(0.0))),
    Kind("blink slowly", "eyes", _blinks(8), _all(LIDS, _slower)),
    Kind("remove a blink", "eyes", _blinks(4), _all(LIDS, _about_its_ends(0.0))),
    Kind("wink", "right eye", _stretches(8, _looks), {"eyelid_right": _to(0.0)}),
    Kind("wide eyes", "eyes", _stretches(30, _looks), _all(LIDS, _by(1.0))),
    Kind("squint", "eyes", _stretches(30, _looks), _all(LIDS, _times(0.65))),
    Kind("drowsy eyes", "eyes", _stretches(60, _looks), _all(LIDS, _times(0.4))),
    Kind("corners up", "mouth", _stretches(30, _rests), _all(HEIGHTS, _by(3.0))),
    Kind("one corner up", "left corner", _stretches(30, _rests), {"corner_height_left": _by(3.0)}),
    Kind("corners down", "mouth", _stretches(30, _rests), _all(HEIGHTS, _by(-3.0))),
    Kind("smile up and out", "mouth", _stretches(30, _rests), _all(HEIGHTS, _by(2.5)) | {"lips_horizontal": _by(5.0)}),
    Kind("raise both brows", "brows of the eyes", _stretches(30, _looks), _all(BROWS, _by(2.0))),
    Kind("raise one brow", "brows of the eyes", _stretches(30, _looks), {"brow_left": _by(2.0)}),
    Kind("raise the inner brows", "brows of the eyes", _stretches(30, _looks), {"brow_inner": _by(2.0)}),
    Kind("jaw to one side", "mouth", _stretches(20, _rests), {"jaw_sideways": _by(2.0)}),
    Kind("look aside", "gaze of the eyes", _stretches(30, _looks), {"gaze_horizontal": _by(10.0)}),
    Kind("look up", "gaze of the eyes", _stretches(30, _looks), {"gaze_vertical": _by(6.0)}),
)


def scripted(pieces: Sequence[Piece]) -> list[Scripted]:
    """Return every kind at up to `PLACES` of the places that fit it, evenly spread over all of them."""
    return [edit for kind in KINDS for edit in _spread(_fitting(kind, pieces))]


def _fitting(kind: Kind, pieces: Sequence[Piece]) -> list[tuple[Kind, Piece, Frames]]:
    found = []
    for piece in pieces:
        if piece.whole_face or not kind.needs_whole_face:
            places = kind.places(bundled_face().measure(piece.weights))
            fits = [(a, b) for a, b in places if a >= ROOM and b <= len(piece.weights) - ROOM]
            found += [(kind, piece, frames) for frames in fits]
    return found


def _spread(fitting: Sequence[tuple[Kind, Piece, Frames]]) -> list[Scripted]:
    chosen = np.unique(np.linspace(0, len(fitting) - 1, PLACES).round().astype(int)).tolist() if fitting else []
    places = [fitting[index] for index in chosen]
    return [Scripted(kind, piece, frames, _asked(kind, piece, frames)) for kind, piece, frames in places]


def _asked(kind: Kind, piece: Piece, frames: Frames) -> Array:
    """Return what is asked, (frames of the piece, 16) in mm, eased in and out beside the frames; NaN where nothing is."""
    controls = bundled_face().measure(piece.weights)
    asked = np.full_like(controls, np.nan)
    first, last = frames[0] - EASE_FRAMES, frames[1] + EASE_FRAMES
    frame = np.arange(first, last)
    away = np.maximum(0, np.maximum(frames[0] - frame, frame - frames[1] + 1)) / (EASE_FRAMES + 1)
    for name, wanted in kind.wanted.items():
        curve = controls[:, ALL_INDEX[name]]
        inside = wanted(curve[slice(*frames)])
        held = np.pad(inside, EASE_FRAMES, mode="edge")
        bent = curve[first:last] + ease(1 - away) * (held - curve[first:last])
        asked[first:last, ALL_INDEX[name]] = bent if ALL_CONTROLS[ALL_INDEX[name]].signed else np.maximum(bent, 0.0)
    return asked
