"""Videos for tests: the shade of each frame tells its number."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np

TICKS = 1000  # per second


def shade(number: int) -> int:
    return 20 + 5 * (number % 44)


def film(
    path: Path, times_ms: Sequence[int], *, size: tuple[int, int] = (64, 48), keys: int = 12, pixel_aspect: float = 1.0
) -> Path:
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=30, options={"g": str(keys), "bf": "2", "crf": "10"})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = Fraction(1, TICKS)
        stream.codec_context.sample_aspect_ratio = Fraction(pixel_aspect).limit_denominator(100)
        for number, time_ms in enumerate(times_ms):
            picture = np.full((size[1], size[0], 3), shade(number), np.uint8)
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame.pts, frame.time_base = time_ms, Fraction(1, TICKS)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return path


def sound_only(path: Path, samples: np.ndarray | None = None, rate: int = 48_000) -> Path:
    """Write sound, (n,), as AAC without a picture."""
    samples = np.zeros(1024, np.float32) if samples is None else samples
    with av.open(str(path), "w") as file:
        stream = file.add_stream("aac", rate=rate, layout="mono")
        stream.bit_rate = 192_000
        for at in range(0, len(samples), 1024):
            frame = av.AudioFrame.from_ndarray(samples[None, at : at + 1024], format="fltp", layout="mono")
            frame.sample_rate, frame.pts = rate, at
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return path


def flash_and_click(
    path: Path,
    *,
    at_s: float = 2.0,
    sound_from_s: float = 0.0,
    picture_from_s: float = 0.0,
    rate: int = 48_000,
    length_s: float = 3.0,
) -> Path:
    """Write a film of 25 frames per second whose picture flashes and whose sound clicks at a time of the film.

    Either track may begin later than the film does.
    """
    with av.open(str(path), "w") as file:
        picture = file.add_stream("libx264", rate=25, options={"crf": "10"})
        picture.width, picture.height, picture.pix_fmt = 64, 48, "yuv420p"
        sound = file.add_stream("aac", rate=rate, layout="mono")
        for number in range(round(25 * picture_from_s), round(25 * length_s)):
            level = 255 if number == round(25 * at_s) else 0
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), level, np.uint8), format="rgb24")
            frame.pts, frame.time_base = number, Fraction(1, 25)
            file.mux(picture.encode(frame))
        samples = np.zeros(round(length_s * rate), np.float32)
        samples[round(at_s * rate) :][:48] = 0.9
        for at in range(round(sound_from_s * rate), len(samples), 1024):
            block = av.AudioFrame.from_ndarray(samples[None, at : at + 1024], format="fltp", layout="mono")
            block.sample_rate, block.pts, block.time_base = rate, at, Fraction(1, rate)
            file.mux(sound.encode(block))
        file.mux(picture.encode())
        file.mux(sound.encode())
    return path


def turned(path: Path, matrix: tuple[int, int, int, int]) -> Path:
    """Let a film's display matrix be x' = a x + c y, y' = b x + d y, as phones write it that are held upright."""
    a, b, c, d = (value << 16 for value in matrix)
    content = bytearray(path.read_bytes())
    at = content.find(b"tkhd") + 44
    content[at : at + 36] = struct.pack(">9i", a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(content)
    return path
