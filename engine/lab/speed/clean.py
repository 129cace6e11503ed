"""Cleaning a live stream: one frame, one packet, and one packet to its clean face."""

from __future__ import annotations

import time

import numpy as np

from engine.clean.infer import bundled
from engine.lab.speed.timing import Speed, percentile_ms
from engine.live.decode import decode
from engine.live.livelink import Stamp, encode
from engine.live.stream import Stream
from engine.take import SHAPES

FRAMES = 2000


def measure() -> list[Speed]:
    """Measure a frame of cleaning, of decoding, and both together as a stream does them."""
    rng = np.random.default_rng(0)
    weights = rng.random((FRAMES + 2, len(SHAPES)), np.float32)
    cleaner, state = bundled(), [bundled().start(weights[0])]

    def step(index: int) -> None:
        state[0] = cleaner.step(weights[index], 1 / 60, state[0])

    data = [encode(Stamp(frame), frame_weights, subject="speed") for frame, frame_weights in enumerate(weights)]
    text = ["|".join(f"{name}-{100 * row[at]:.0f}" for at, name in enumerate(SHAPES)).encode() for row in weights]
    stream = Stream()

    def packet(index: int) -> None:
        stream.receive(data[index], time.perf_counter(), time.perf_counter)

    return [
        Speed("clean_frame_ms_p95", percentile_ms(step, FRAMES), "ms", 0.25),
        Speed("live_decode_us_p95", percentile_ms(lambda index: decode(data[index]), FRAMES) * 1e3, "us", 50.0),
        Speed("live_decode_text_us_p95", percentile_ms(lambda index: decode(text[index]), FRAMES) * 1e3, "us", 50.0),
        Speed("live_packet_to_weights_ms_p95", percentile_ms(packet, FRAMES), "ms", 3.0),
    ]
