"""The take: one recorded performance at a constant frame rate."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from engine.errors import EditError
from engine.words import counted

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# Apple's ARKit order by region; every array of weights in this program has these columns.
_EYE = ("eyeBlink", "eyeLookDown", "eyeLookIn", "eyeLookOut", "eyeLookUp", "eyeSquint", "eyeWide")
SHAPES: tuple[str, ...] = (
    *(f"{shape}Left" for shape in _EYE),
    *(f"{shape}Right" for shape in _EYE),
    *("jawForward", "jawRight", "jawLeft", "jawOpen"),
    *("mouthClose", "mouthFunnel", "mouthPucker", "mouthRight", "mouthLeft"),
    *(f"mouth{shape}{side}" for shape in ("Smile", "Frown", "Dimple", "Stretch") for side in ("Left", "Right")),
    *("mouthRollLower", "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper"),
    *(f"mouth{shape}{side}" for shape in ("Press", "LowerDown", "UpperUp") for side in ("Left", "Right")),
    *("browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight"),
    *("cheekPuff", "cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight", "tongueOut"),
)
SHAPE_INDEX: dict[str, int] = {name: index for index, name in enumerate(SHAPES)}
MODEL_FPS = 30.0
T = TypeVar("T", bound=np.generic)


def _frozen(array: npt.ArrayLike, dtype: type) -> npt.NDArray[np.generic]:
    if isinstance(array, np.ndarray) and array.dtype == dtype and not array.flags.writeable and array.base is None:
        return array  # nobody can change it any more, so it need not be copied
    frozen: npt.NDArray[np.generic] = np.array(array, dtype=dtype)
    frozen.flags.writeable = False
    return frozen


@dataclass(frozen=True, eq=False)
class Take:
    """A performance as curves; arrays are read-only, an edit makes a new take.

    Attributes
    ----------
    weights : (frames, 52) float64, nominally 0..1, columns as `SHAPES`; lost frames hold interpolated values
    fps : frames per second
    lost : (frames,) bool, frames for which the tracker had no face
    rotations : (frames, 9) float64, radians; head yaw, pitch, roll, then left eye, then right eye
    name : what to call it on screen
    notices : sentences about the import that the user should see
    start_s : time of the first frame, seconds after midnight
    origin : how the file it came from was written, so that it can be written back the same way
    """

    weights: Array
    fps: float
    lost: Mask = field(default_factory=lambda: np.zeros(0, bool))
    rotations: Array = field(default_factory=lambda: np.zeros((0, 9)))
    name: str = "untitled"
    notices: tuple[str, ...] = ()
    start_s: float = 0.0
    origin: object = None

    def __post_init__(self) -> None:
        weights = np.asarray(self.weights)
        if weights.ndim != 2 or weights.shape[1] != len(SHAPES) or not len(weights):
            raise EditError(f"A take needs at least one frame of {len(SHAPES)} weights.")
        if not np.isfinite(weights).all() or not (np.isfinite(self.fps) and self.fps > 0):
            raise EditError("A take needs finite weights and a frame rate above zero.")
        frames = len(weights)
        lost = self.lost if len(self.lost) == frames else np.zeros(frames, bool)
        rotations = self.rotations if len(self.rotations) == frames else np.zeros((frames, 9))
        object.__setattr__(self, "weights", _frozen(weights, np.float64))
        object.__setattr__(self, "lost", _frozen(lost, np.bool_))
        object.__setattr__(self, "rotations", _frozen(rotations, np.float64))

    def __len__(self) -> int:
        return len(self.weights)

    @property
    def duration_s(self) -> float:
        """Length in seconds, counting each frame as one frame period."""
        return len(self) / self.fps

    @property
    def has_head(self) -> bool:
        """Whether head rotation was recorded: all-zero columns mean that the app's option was off."""
        return bool(np.any(self.rotations[:, :3]))

    def with_weights(self, weights: Array) -> Take:
        """Return the same take with other weights, (frames, 52); lost frames as in `with_rows`."""
        if weights.shape != self.weights.shape:
            raise EditError(f"The new weights have {counted(weights.shape[0], 'frame')}, the take {len(self)}.")
        return self.with_rows(0, weights)

    def with_rows(self, start: int, rows: Array, *, found: Mask | None = None) -> Take:
        """Return the same take with the weights of the frames from `start` replaced, (n, 52).

        A lost frame is lost no more once its weights change, or where `found`, (n,) bool, says so. The frames that stay
        lost are interpolated anew where a frame beside them changed, as a reader of the written file will do.
        """
        stop = start + len(rows)
        weights, lost = self.weights.copy(), self.lost
        weights[start:stop] = rows
        if lost.any():
            changed = (weights[start:stop] != self.weights[start:stop]).any(axis=1)
            changed = changed if found is None else changed | found
            lost = lost.copy()
            lost[start:stop] &= ~changed
            first, last = self.with_lost_beside(start, stop)
            first, last = max(first - 1, 0), min(last + 1, len(self))
            known = np.zeros(last - first, bool)
            known[start - first : stop - first] = changed
            _interpolate(weights[first:last], lost[first:last], known)
        return replace(self, weights=_owned(weights), lost=_owned(lost))

    def with_exact_rows(self, start: int, rows: Array, lost: Mask) -> Take:
        """Return the same take with weights, (n, 52), and lost frames, (n,) bool, from `start` as given, to the bit."""
        weights, now_lost = self.weights.copy(), self.lost.copy()
        weights[start : start + len(rows)] = rows
        now_lost[start : start + len(rows)] = lost
        return replace(self, weights=_owned(weights), lost=_owned(now_lost))

    def with_lost_beside(self, start: int, stop: int) -> tuple[int, int]:
        """Return the half-open range start to stop, grown over the lost frames that adjoin it."""
        before, after = np.flatnonzero(~self.lost[:start]), np.flatnonzero(~self.lost[stop:])
        return int(before[-1]) + 1 if len(before) else 0, stop + int(after[0]) if len(after) else len(self)

    def curve(self, shape: str) -> Array:
        """Return the weight curve of one shape, (frames,)."""
        try:
            return np.asarray(self.weights[:, SHAPE_INDEX[shape]])
        except KeyError:
            raise EditError(
                f"There is no shape called {shape!r}.", "Shapes have ARKit names, such as jawOpen."
            ) from None


def _owned(array: npt.NDArray[T]) -> npt.NDArray[T]:
    """Return an array of our own as one that nobody can change any more, which a take need not copy."""
    array.flags.writeable = False
    return array


def _interpolate(values: Array, lost: Mask, changed: Mask) -> None:
    """Put lost frames of values, (frames, n), on straight lines, in place, in each run beside a `changed` frame."""
    for start, stop in runs(lost):
        first, last = max(start - 1, 0), min(stop, len(values) - 1)
        if (start, stop) == (0, len(values)) or not changed[first : last + 1].any():
            continue
        left = values[first if start > 0 else last]
        right = values[last if stop < len(values) else first]
        slope = (right - left) / (stop - start + 1)
        values[start:stop] = slope * np.arange(1, stop - start + 1)[:, None] + left


def runs(mask: Mask) -> list[tuple[int, int]]:
    """Return the half-open ranges [start, stop) over which a (frames,) mask is true."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, np.int8), [0]]))
    return [(int(a), int(b)) for a, b in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)]


def timecode(time_s: float, fps: float) -> str:
    """Return `HH:MM:SS:FF` for a time in seconds at a frame rate; a rate such as 29.97 is counted as 30, none dropped."""
    frame, whole = round(time_s * fps), max(1, round(fps))
    seconds, sign = abs(frame) // whole, "-" if frame < 0 else ""
    digits = max(2, len(str(whole - 1)))
    return f"{sign}{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}:{abs(frame) % whole:0{digits}d}"


def require_frames(take: Take, start: int, stop: int) -> None:
    """Raise `EditError` where frames from `start` up to, and without, `stop` are none or not within a take."""
    if not 0 <= start < stop <= len(take):
        raise EditError(f"Frames {start}:{stop} are not within the take, which has {counted(len(take), 'frame')}.")
