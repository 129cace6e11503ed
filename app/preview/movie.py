"""Pictures and movies of takes, drawn on the calling thread; one renderer for the life of the program."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.preview.camera import Camera
from app.preview.captions import Captions, burnt_in
from app.preview.encoding import codec_named
from app.preview.muxing import Progress, write_mp4
from app.preview.renderer import Picture, Renderer, Shot
from app.preview.soundtrack import Soundtrack
from engine.character import Character, bundled
from engine.formats.base.atomic import write_bytes
from engine.project import Drawing
from engine.review.counting import rate_of
from engine.take import Array, Take

ASPECT = 0.8  # width / height of one head
DEFAULT_CAMERA = (0.0, 4.0, 1.0, 0.0, 0.0)  # around, above, zoom, pan: where a drawing does not tell
PEN, PEN_PX = (240, 228, 66), 3


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
    write_still(Movie(tuple(takes), height), frame, path)


@dataclass(frozen=True, eq=False)
class Movie:
    """What a movie shows.

    Attributes
    ----------
    takes : side by side, all at one rate
    height : of the faces in pixels
    frames : start and stop (half-open); all of the longest take without
    difference : whether the last face is shown again, with how far it is from the first one painted on it
    captions : what is burnt in beneath, if anything
    sound : what is heard, if anything
    """

    takes: tuple[Take, ...]
    height: int
    frames: tuple[int, int] | None = None
    difference: bool = False
    captions: Captions | None = None
    sound: Soundtrack | None = None

    @property
    def range(self) -> tuple[int, int]:
        """The frames that are shown, start and stop (half-open)."""
        return self.frames or (0, max(len(take) for take in self.takes))

    def pictures(self) -> Iterator[Picture]:
        """Draw frame after frame."""
        for frame in range(*self.range):
            yield self.picture_at(frame)

    def picture_at(self, frame: int) -> Picture:
        """Draw one frame."""
        drawn = picture(self.takes, frame, height=self.height)
        if self.difference:
            drawn = np.concatenate(
                [drawn, difference(self.takes[0], self.takes[-1], frame, height=self.height)], axis=1
            )
        return burnt_in(drawn, self.captions, frame) if self.captions is not None else drawn


def write_movie(
    takes: Sequence[Take],
    path: Path,
    *,
    height: int,
    frames: tuple[int, int] | None = None,
    codec: str | None = None,
) -> None:
    """Write takes side by side as an MP4 at the first one's rate, with a codec of `CODECS` or the best there is."""
    write(Movie(tuple(takes), height, frames), path, codec=codec)


def write_still(movie: Movie, frame: int, path: Path) -> None:
    """Write a frame of a movie as a PNG."""
    from PIL import Image

    stored = io.BytesIO()
    Image.fromarray(movie.picture_at(frame)).save(stored, "PNG")
    write_bytes(path, [stored.getvalue()])


def write(movie: Movie, path: Path, *, codec: str | None = None, progress: Progress | None = None) -> None:
    """Write a movie as an MP4; `progress` hears of each frame."""
    start, stop = movie.range
    fps = movie.takes[0].fps
    write_mp4(
        path,
        movie.pictures(),
        count=stop - start,
        rate=rate_of(fps),
        codec=codec_named(codec),
        sound=movie.sound,
        from_s=float(start / rate_of(fps)),
        progress=progress or (lambda done, of: None),
    )


def difference(before: Take, after: Take, frame: int, *, height: int) -> Picture:
    """Return a face with how far it is from another one painted on it, (height, width, 3)."""
    first, second = (take.weights[min(frame, len(take) - 1)] for take in (before, after))
    even = 2 * (height // 2)
    size = 2 * round(even * ASPECT / 2), even
    return _renderer().draw(Shot((second,), Camera(), size, compared_to=first))


def drawn_on(face: Array, drawing: Drawing, *, height: int) -> bytes:
    """Return a PNG of a face, weights (52,), with the lines that somebody drew on it, seen from where they did."""
    from PIL import Image, ImageDraw

    around, above, zoom, right, up, *frame = (*drawing.camera, *DEFAULT_CAMERA[len(drawing.camera) :])
    camera = Camera(around, above, zoom, (right, up), (frame[0], frame[1]) if len(frame) == 2 else None)
    image = Image.fromarray(_renderer().draw(Shot((face,), camera, (2 * round(height * ASPECT / 2), height))))
    pen = ImageDraw.Draw(image)
    for stroke in drawing.strokes:
        points = [(image.width / 2 + x * height, height / 2 + y * height) for x, y in stroke]
        if len(points) > 1:
            pen.line(points, fill=PEN, width=PEN_PX, joint="curve")
        else:
            pen.ellipse(
                [(x - PEN_PX, y - PEN_PX) for x, y in points] + [(x + PEN_PX, y + PEN_PX) for x, y in points], PEN
            )
    stored = io.BytesIO()
    image.save(stored, "PNG", optimize=True)
    return stored.getvalue()


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
