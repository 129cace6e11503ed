"""The take: one recorded performance at a constant frame rate."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

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
        """Return the same take with other weights, (frames, 52)."""
        if weights.shape != self.weights.shape:
            raise EditError(f"The new weights have {counted(weights.shape[0], 'frame')}, the take {len(self)}.")
        return replace(self, weights=weights)

    def with_rows(self, start: int, rows: Array) -> Take:
        """Return the same take with the weights of the frames from `start` replaced, (n, 52)."""
        weights = self.weights.copy()
        weights[start : start + len(rows)] = rows
        weights.flags.writeable = False
        return self.with_weights(weights)

    def curve(self, shape: str) -> Array:
        """Return the weight curve of one shape, (frames,)."""
        try:
            return np.asarray(self.weights[:, SHAPE_INDEX[shape]])
        except KeyError:
            raise EditError(
                f"There is no shape called {shape!r}.", "Shapes have ARKit names, such as jawOpen."
            ) from None


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
