"""Videos for tests: the shade of each frame tells its number."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np

TICKS = 1000  # per second


def shade(number: int) -> int:
    return 20 + 5 * (number % 44)


def film(path: Path, times_ms: Sequence[int], *, size: tuple[int, int] = (64, 48), keys: int = 12) -> Path:
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=30, options={"g": str(keys), "bf": "2", "crf": "10"})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = Fraction(1, TICKS)
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
