"""Reference video: frames by their own time stamps, so that a changing frame rate is no matter."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.film import EXPECTED, begin_s, moving, open_film

if TYPE_CHECKING:
    import av

Picture = npt.NDArray[np.uint8]  # (height, width, 3)

MAX_PIXELS = 8192 * 4608
LARGE_PIXELS = 4096 * 2304
SHOWN_PX = 480  # the longer side of what is kept: the panel is small
CACHE_BYTES = 96 * 2**20
NEAR_S = 1.0  # going on decoding is quicker than seeking up to here
MAX_DECODED = 2_000  # frames in search of one; a stream that needs more is damaged
WIDEST = 8.0  # width of a pixel over its height, or the inverse; more is damage
MATRIX_BYTES = 36
LAST_S = 1.0 / 24  # how long a frame is shown that has no successor


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture and the half-open stretch of time for which it is shown, seconds from the first frame."""

    start_s: float
    stop_s: float
    picture: Picture


class Video:
    """An open file; to be used by one thread only.

    Raises `FormatError`, with one plain sentence, where there is no picture to be had.
    """

    def __init__(self, path: Path) -> None:
        import av

        self.path = path
        self._error = av.FFmpegError
        self._file = open_film(path)
        try:
            self._stream = self._picture_stream()
        except FormatError:
            self._file.close()
            raise
        self._begin_s = begin_s(self._file)
        self._ahead: Iterator[av.VideoFrame] | None = None
        self._next: tuple[float, Picture] | None = None  # decoded, but until when it lasts is not known yet
        self._end_s = math.inf  # until it is known
        self._starts: list[float] = []
        self._frames: list[Frame] = []

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def frame_at(self, time_s: float) -> Frame | None:
        """Return the frame that is shown at a time, None before the first and after the last."""
        if not 0 <= time_s < self._end_s:
            return None
        found = self._kept(time_s)
        try:
            return found or self._decoded(time_s)
        except (self._error, ValueError, OSError) as error:
            self._ahead = self._next = None
            raise FormatError(f"{self.path.name} is damaged at {time_s:.1f} s.", "Export the video again.") from error

    def _picture_stream(self) -> Any:
        found = moving(self._file)
        if not found:
            raise FormatError(f"{self.path.name} has no moving picture.", EXPECTED)
        stream = found[0]
        if stream.codec_context is None or not stream.time_base:
            raise FormatError(f"{self.path.name} is in a format that cannot be decoded here.", EXPECTED)
        _require_small(stream.codec_context.width, stream.codec_context.height, self.path)
        stream.thread_type = "AUTO"
        if stream.codec_context.width * stream.codec_context.height > LARGE_PIXELS:
            stream.codec_context.thread_count = 1  # each thread holds pictures of its own, 57 MB each at 8K
        return stream

    def _kept(self, time_s: float) -> Frame | None:
        at = bisect_right(self._starts, time_s) - 1
        return self._frames[at] if at >= 0 and time_s < self._frames[at].stop_s else None

    def _decoded(self, time_s: float) -> Frame | None:
        if self._next is None or not 0 <= time_s - self._next[0] <= NEAR_S:
            self._seek(time_s)
        for _ in range(MAX_DECODED):
            frame = self._step()
            if frame is None:
                self._end_s = time_s
                return None
            self._keep(frame, time_s)
            if frame.stop_s > time_s:
                return frame if frame.start_s <= time_s else None
        raise FormatError(f"{self.path.name} is damaged at {time_s:.1f} s.", "Export the video again.")

    def _seek(self, time_s: float) -> None:
        """Go to a key frame before a time: where pictures are stored out of order the first found may lie after it."""
        for earlier_s in (0.0, 1.0, 10.0, math.inf):
            back_s = max(0.0, time_s - earlier_s)
            self._file.seek(int((self._begin_s + back_s) / self._stream.time_base), stream=self._stream, backward=True)
            self._ahead = self._file.decode(self._stream)
            self._next = self._read()
            if self._next is not None and self._next[0] <= time_s:
                return

    def _step(self) -> Frame | None:
        """Return the next frame with its end, which is where the one after it begins."""
        if self._next is None:
            return None
        start_s, picture = self._next
        self._next = self._read()
        return Frame(start_s, self._next[0] if self._next else start_s + LAST_S, picture)

    def _read(self) -> tuple[float, Picture] | None:
        """Return the next frame that says when it is shown."""
        for frame in self._ahead or ():
            if frame.pts is not None:
                _require_small(frame.width, frame.height, self.path)
                start_s = float(frame.pts * self._stream.time_base) - self._begin_s
                return start_s, _small(frame, self._stream.codec_context.sample_aspect_ratio)
        return None

    def _keep(self, frame: Frame, around_s: float) -> None:
        """Remember a frame, and forget what is farthest from a time."""
        at = bisect_right(self._starts, frame.start_s)
        if at and self._starts[at - 1] == frame.start_s:
            self._frames[at - 1] = frame
            return
        self._starts.insert(at, frame.start_s)
        self._frames.insert(at, frame)
        while len(self._frames) * frame.picture.nbytes > CACHE_BYTES:
            first_is_farther = around_s - self._starts[0] > self._starts[-1] - around_s
            for kept in (self._starts, self._frames):
                kept.pop(0 if first_is_farther else -1)


def _require_small(width: int, height: int, path: Path) -> None:
    if not 0 < width * height <= MAX_PIXELS:
        raise FormatError(f"{path.name} has pictures of {width} × {height}, which cannot be shown.", EXPECTED)


def _small(frame: av.VideoFrame, pixel_aspect: Fraction | None) -> Picture:
    """Return a frame at the size it is shown, with square pixels, the right way up."""
    aspect = float(pixel_aspect) if pixel_aspect and 1 / WIDEST <= pixel_aspect <= WIDEST else 1.0
    scale = min(1.0, SHOWN_PX / max(frame.width * aspect, frame.height))
    width, height = (max(2, round(side * scale)) for side in (frame.width * aspect, frame.height))
    picture: Picture = (
        frame.reformat(width=width, height=height, format="rgb24").to_ndarray().astype(np.uint8, copy=False)
    )
    return np.ascontiguousarray(_upright(picture, frame.side_data.get("DISPLAYMATRIX")))


def _upright(picture: Picture, matrix: Any) -> Picture:
    """Return a picture turned and mirrored as the display matrix of its film says: x' = a x + c y, y' = b x + d y."""
    if matrix is None or len(bytes(matrix)) < MATRIX_BYTES:
        return picture
    a, b, _, c, d = np.frombuffer(bytes(matrix), np.int32, 5).tolist()
    if abs(a) + abs(d) < abs(b) + abs(c):
        picture, a, d = picture.transpose(1, 0, 2), c, b
    return picture[:: -1 if d < 0 else 1, :: -1 if a < 0 else 1]
