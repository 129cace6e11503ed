"""A timecode has hours, minutes, seconds and frames, so that it cannot be read as anything else."""

from __future__ import annotations

import pytest

from engine.take import timecode


@pytest.mark.parametrize(
    ("frame", "fps", "told"),
    [
        (0, 60.0, "00:00:00:00"),
        (192, 60.0, "00:00:03:12"),
        (30 * 3600 + 61 * 30 + 7, 30.0, "01:01:01:07"),
        (299, 29.97, "00:00:09:29"),
        (1, 1.0, "00:00:01:00"),
        (119, 120.0, "00:00:00:119"),
        (-30, 30.0, "-00:00:01:00"),
    ],
)
def test_timecode(frame: int, fps: float, told: str) -> None:
    assert timecode(frame / fps, fps) == told
