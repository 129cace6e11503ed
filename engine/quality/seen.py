"""The input of the flags: a take's curves, those before the edits, visemes and sound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from engine.controls import CONTROL_INDEX
from engine.errors import EditError
from engine.extended import bundled_face
from engine.formats.audio import Audio
from engine.quality.tuning import TUNING, Tuning
from engine.speech.lane import VisemeLane
from engine.take import Array, Mask, Take
from engine.words import counted

LIDS = {side: CONTROL_INDEX[f"eyelid_{side.lower()}"] for side in ("Right", "Left")}
_CHUNK = 4096  # frames that fit the cache


@dataclass(frozen=True, eq=False)
class Sound:
    """How loud a take's sound is.

    Attributes
    ----------
    loudness : (n,) root mean square of each frame period of the sound, from its own first sample on
    duration_s : length of the sound
    offset_s : time of the take at which it begins
    """

    loudness: Array
    duration_s: float
    offset_s: float = 0.0


@dataclass(frozen=True, eq=False)
class Seen:
    """What is looked at.

    Attributes
    ----------
    weights : (frames, 52)
    controls : (frames, controls), measured on the weights
    fps : frames per second
    lost : (frames,) bool, where the tracker had no face and nobody has filled one in since
    asked : (frames, controls) targets, NaN for none; None where there is none anywhere
    original_controls : (frames, controls) before any edit; None without one
    visemes : the cues with their times
    original_weights : (frames, 52) before any edit; None without one
    rotations : (frames, 3) radians, yaw, pitch and roll of the head; None where it was not recorded
    sound : what is heard; None without sound
    tuning : the thresholds that count
    """

    weights: Array
    controls: Array
    fps: float
    lost: Mask
    asked: Array | None = None
    original_controls: Array | None = None
    visemes: VisemeLane | None = None
    original_weights: Array | None = None
    rotations: Array | None = None
    sound: Sound | None = None
    tuning: Tuning = TUNING

    @cached_property
    def length(self) -> int:
        """Number of frames."""
        return len(self.weights)

    @cached_property
    def kept(self) -> Mask:
        """Frames with a face, (frames,) bool."""
        return np.asarray(~self.lost)

    @cached_property
    def blinks(self) -> tuple[Array, Array]:
        """The gap of the wider open lids, (frames,) mm, and the drops of that curve."""
        gap = rounded(np.max([self.controls[:, control] for control in LIDS.values()], axis=0))
        return gap, drops(gap, self.frames(self.tuning.blink_within_s))

    def frames(self, seconds: float) -> int:
        """Return the number of frames that a time lasts, at least one."""
        return max(1, round(seconds * self.fps))


def seen_of(
    take: Take,
    original: Take | None = None,
    asked: Array | None = None,
    visemes: VisemeLane | None = None,
    *,
    controls: tuple[Array, Array] | None = None,
    sound: Sound | None = None,
) -> Seen:
    """Return what there is to look at in a take, beside the one that it was made from.

    Parameters
    ----------
    asked : (frames, controls) targets, NaN for none
    controls : of the take and of the original, (frames, controls) each, where they have been measured

    Raises `EditError` for an original of another length.
    """
    measure = bundled_face().measure
    turned = take.rotations[:, :3] if take.has_head else None
    if original is None:
        measured = measure(take.weights) if controls is None else controls[0]
        return Seen(take.weights, measured, take.fps, take.lost, asked, None, visemes, rotations=turned, sound=sound)
    if len(original) != len(take):
        raise EditError(
            f"The original has {counted(len(original), 'frame')}, the take {len(take)}.",
            "Name the take that was edited.",
        )
    now, before = controls if controls is not None else (measure(take.weights), measure(original.weights))
    return Seen(take.weights, now, take.fps, take.lost, asked, before, visemes, original.weights, turned, sound)


def sound_of(audio: Audio, *, fps: float, offset_s: float = 0.0) -> Sound:
    """Return how loud a recording is in each frame period of a take at `fps`."""
    periods = max(1, round(audio.duration_s * fps))
    loudness = np.asarray(audio.peaks(0.0, periods / fps, periods).rms[:periods], np.float64)
    return Sound(loudness, audio.duration_s, offset_s)


def strengths(seen: Seen, low: int, high: int, *, reach: int, verdict: Callable[[Array, Mask], Array]) -> Array:
    """Return a verdict on each of the frames [low, high), (high - low,), a part at a time that fits the cache.

    `verdict` gets rows of weights, (n, 52), and which of them have a face; its result for a row may depend on the
    `reach` rows to either side.
    """
    found = np.zeros(high - low)
    for start in range(low, high, _CHUNK):
        stop = min(high, start + _CHUNK)
        first, last = max(0, start - reach), min(seen.length, stop + reach)
        result = verdict(seen.weights[first:last], seen.kept[first:last])
        found[start - low : stop - low] = result[start - first : stop - first]
    return found


def rounded(gap_mm: Array) -> Array:
    """Return a curve without its last digits, so that equal frames are equal whether measured whole or in parts."""
    return np.asarray(np.round(gap_mm, 6))


def drops(gap_mm: Array, within: int) -> Array:
    """Return how far a lid fell before each frame and rises after it, the lesser, mm; 0 but at the bottoms of blinks.

    Parameters
    ----------
    gap_mm : (frames,) between the lids
    within : frames in which it falls, and in which it rises
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # here: the window is seen before scipy is loaded

    size = within + 1
    fell = maximum_filter1d(gap_mm, size, origin=within - size // 2, mode="nearest") - gap_mm
    rises = maximum_filter1d(gap_mm, size, origin=-(size // 2), mode="nearest") - gap_mm
    bottom = gap_mm <= minimum_filter1d(gap_mm, 2 * within + 1, mode="nearest")
    bottom[1:] &= gap_mm[1:] < gap_mm[:-1]  # the first of equal ones
    return np.asarray(np.where(bottom, np.minimum(fell, rises), 0.0))


def lowest(curve: Array, ranges: np.ndarray) -> Array:
    """Return the least of a curve, (frames,), over each of the half-open ranges, (n, 2)."""
    padded = np.append(curve, np.inf)  # a range may end with the curve
    return np.asarray(np.minimum.reduceat(padded, ranges.reshape(-1))[::2] if len(ranges) else np.zeros(0))
