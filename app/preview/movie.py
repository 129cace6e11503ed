"""Pictures and movies of takes, drawn on the calling thread; one renderer for the life of the program."""

from __future__ import annotations

import io
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from app.preview.camera import Camera
from app.preview.encoding import codec_named
from app.preview.renderer import Picture, Renderer, Shot
from engine.character import Character, bundled
from engine.formats.base.atomic import write_bytes
from engine.take import Array, Take

if TYPE_CHECKING:
    from av.video.stream import VideoStream

ASPECT = 0.8  # width / height of one head


class _Studio:
    """The one renderer, made on first use."""

    renderer: Renderer | None = None


def use(character: Character) -> None:
    """Draw on this head from now on."""
    if _Studio.renderer is None:
        _Studio.renderer = Renderer(character)
    _Studio.renderer.character = character


def _renderer() -> Renderer:
    if _Studio.renderer is None:
        use(bundled())
    assert _Studio.renderer is not None
    return _Studio.renderer


def picture(takes: Sequence[Take], frame: int, *, height: int) -> Picture:
    """Return takes side by side at a frame, (height, width, 3); the shorter ones hold their last frame."""
    faces = tuple(take.weights[min(frame, len(take) - 1)] for take in takes)
    even = 2 * (height // 2)
    width = 2 * round(even * ASPECT * len(faces) / 2)
    return _renderer().draw(Shot(faces, Camera(), (width, even)))


def write_picture(takes: Sequence[Take], frame: int, path: Path, *, height: int) -> None:
    """Write takes side by side at a frame as a PNG."""
    from PIL import Image

    stored = io.BytesIO()
    Image.fromarray(picture(takes, frame, height=height)).save(stored, "PNG")
    write_bytes(path, [stored.getvalue()])


def write_movie(
    takes: Sequence[Take],
    path: Path,
    *,
    height: int,
    frames: tuple[int, int] | None = None,
    codec: str | None = None,
) -> None:
    """Write takes side by side as an MP4 at the first one's rate, with a codec of `CODECS` or the best there is."""
    import av

    chosen = codec_named(codec)
    start, stop = frames or (0, max(len(take) for take in takes))
    stored = io.BytesIO()
    with av.open(stored, "w", format="mp4") as container:
        first = picture(takes, start, height=height)
        rate = Fraction(takes[0].fps).limit_denominator(1001)
        stream = cast("VideoStream", container.add_stream(chosen.encoder, rate=rate))
        stream.width, stream.height, stream.pix_fmt = first.shape[1], first.shape[0], "yuv420p"
        stream.options = dict(chosen.options)
        for frame in range(start, stop):
            drawn = picture(takes, frame, height=height)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(drawn), format="rgb24")))
        container.mux(stream.encode())
    write_bytes(path, [stored.getvalue()])


def comparison(before: Array, after: Array, *, height: int) -> bytes:
    """Return a PNG of two faces, weights (52,) each, and where the second one moved, in mm: before, after, difference."""
    from PIL import Image

    width = 2 * round(height * ASPECT / 2)
    renderer = _renderer()
    pair = renderer.draw(Shot((before, after), Camera(), (2 * width, height)))
    moved = renderer.draw(Shot((after,), Camera(), (width, height), compared_to=before))
    stored = io.BytesIO()
    Image.fromarray(np.concatenate([pair, moved], axis=1)).save(stored, "PNG", optimize=True)
    return stored.getvalue()
