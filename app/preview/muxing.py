"""Writes pictures and sound as one MP4, both on the clock of the pictures."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from app.preview.encoding import Codec, sound_encoder
from app.preview.renderer import Picture
from engine.formats.base.atomic import write_bytes

if TYPE_CHECKING:
    from av.audio.stream import AudioStream
    from av.container import OutputContainer
    from av.video.stream import VideoStream

    from app.preview.soundtrack import Soundtrack

SOUND_RATE = 48_000  # Hz; Opus knows no other that is as good
BITS_PER_S = 96_000  # of a channel

Progress = Callable[[int, int], None]  # frames done, frames in all


def write_mp4(
    path: Path,
    pictures: Iterable[Picture],
    *,
    count: int,
    rate: Fraction,
    codec: Codec,
    sound: Soundtrack | None = None,
    from_s: float = 0.0,
    progress: Progress = lambda done, of: None,
) -> None:
    """Write pictures, (height, width, 3) with even edges, as a movie; a movie that is not finished leaves no file.

    Parameters
    ----------
    count : number of pictures
    rate : pictures per second
    sound, from_s : what is heard, and the time of its take at the first picture
    """
    import av

    stored = io.BytesIO()
    with av.open(stored, "w", format="mp4") as container:
        shown = iter(pictures)
        first = next(shown)
        pixels = _Pixels(container, codec, rate, first)
        heard = _Sound(container, codec, sound, sound.blocks(from_s, float(count / rate))) if sound else None
        pixels.write(first)
        for index, picture in enumerate(shown, 1):
            if heard is not None:
                heard.write_until(index / rate)
            pixels.write(picture)
            progress(index, count)
        if heard is not None:
            heard.finish()
        pixels.finish()
    write_bytes(path, [stored.getvalue()])
    progress(count, count)


class _Pixels:
    """The picture track: each picture is stamped with its number."""

    def __init__(self, container: OutputContainer, codec: Codec, rate: Fraction, first: Picture) -> None:
        stream = cast("VideoStream", container.add_stream(codec.encoder, rate=rate))
        stream.width, stream.height, stream.pix_fmt = first.shape[1], first.shape[0], "yuv420p"
        stream.options = dict(codec.options)
        self._container, self._stream, self._rate, self._number = container, stream, rate, 0

    def write(self, picture: Picture) -> None:
        import av

        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
        frame.pts, frame.time_base = self._number, 1 / self._rate
        self._number += 1
        self._container.mux(self._stream.encode(frame))

    def finish(self) -> None:
        self._container.mux(self._stream.encode())


class _Sound:
    """The sound track: each block is stamped with the number of its first sample."""

    def __init__(
        self, container: OutputContainer, codec: Codec, sound: Soundtrack, blocks: Iterator[np.ndarray]
    ) -> None:
        self._layout = "mono" if sound.channels == 1 else "stereo"
        stream = cast("AudioStream", container.add_stream(sound_encoder(codec), rate=SOUND_RATE, layout=self._layout))
        stream.bit_rate = BITS_PER_S * sound.channels
        self._container, self._stream, self._rate, self._blocks = container, stream, sound.rate, blocks
        self._number = 0

    def write_until(self, time_s: Fraction) -> None:
        """Write blocks that begin before a time of the movie, so that both tracks lie side by side in the file."""
        while self._number < time_s * self._rate and self._write_one():
            pass

    def finish(self) -> None:
        while self._write_one():
            pass
        self._container.mux(self._stream.encode())

    def _write_one(self) -> bool:
        import av

        block = next(self._blocks, None)
        if block is None:
            return False
        frame = av.AudioFrame.from_ndarray(block.reshape(1, -1), format="flt", layout=self._layout)
        frame.sample_rate, frame.pts, frame.time_base = self._rate, self._number, Fraction(1, self._rate)
        self._number += len(block)
        self._container.mux(self._stream.encode(frame))
        return True
