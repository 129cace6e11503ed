"""A take in every style of clock at every rate: read, edited where rows are absent, written and read again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import find_peaks

from engine.formats import livelink, read_take, write_take
from engine.take import SHAPE_INDEX, SHAPES
from tests.engine.formats.livelink.test_clock import FINE, Stamps, drop_frames_unsaid, exact, named, stamps

JAW = SHAPE_INDEX["jawOpen"]


@pytest.mark.parametrize(("style", "rate"), [case for case in FINE if case[0] is not drop_frames_unsaid], ids=named)
def test_peaks_stay_where_they_were_and_edits_in_a_gap_are_written(tmp_path: Path, style: Stamps, rate: float) -> None:
    true_rate = float(exact(rate))
    frames = round(5 * rate)
    jaw = np.abs(np.sin(np.pi * np.arange(frames) / true_rate))  # a peak each second from 0.5 s on
    absent = range(round(1.9 * rate), round(2.2 * rate))
    rows = [frame for frame in range(frames) if frame not in absent]
    lines = [",".join(livelink.DEFAULT_HEADER)]
    for frame, code in zip(rows, stamps(style, rate, rows), strict=True):
        values = np.zeros(61)
        values[JAW] = jaw[frame]
        lines.append(f"{code.decode()},61,{','.join(f'{value:.6f}' for value in values)}")
    (tmp_path / "given.csv").write_text("\n".join(lines) + "\n")

    take = read_take(tmp_path / "given.csv")
    assert (len(take), take.fps) == (frames, pytest.approx(true_rate))
    peaks = find_peaks(take.curve("jawOpen"), height=0.9)[0] / take.fps
    np.testing.assert_allclose(peaks, np.arange(5) + 0.5, atol=0.5001 / true_rate)

    edited = take.with_rows(absent[1], np.full((4, len(SHAPES)), 0.3))
    write_take(edited, tmp_path / "edited.csv")
    again = read_take(tmp_path / "edited.csv")
    assert (len(again), again.fps) == (frames, take.fps)
    np.testing.assert_allclose(again.weights[absent[1] : absent[1] + 4], 0.3)
    np.testing.assert_array_equal(again.weights[: absent[0]], take.weights[: absent[0]])
    np.testing.assert_array_equal(again.weights[absent[-1] + 1 :], take.weights[absent[-1] + 1 :])
    assert set((tmp_path / "given.csv").read_text().splitlines()) <= set(
        (tmp_path / "edited.csv").read_text().splitlines()
    )
