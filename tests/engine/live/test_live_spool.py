from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import EngineError
from engine.formats import read_take
from engine.live.record import Recorder
from engine.live.spool import Spool
from engine.live.stream import Arrival
from engine.take import SHAPES

RNG = np.random.default_rng(0)
WEIGHTS = RNG.random((400, len(SHAPES))).astype(np.float32)
ROTATIONS = RNG.uniform(-0.5, 0.5, (400, 9)).astype(np.float32)
LOST = np.isin(np.arange(400), np.r_[100:130, 250])
ORDER = np.argsort(np.arange(400) + 8 * RNG.random(400) * (RNG.random(400) < 0.1))  # a tenth comes late


def arrival(index: int) -> Arrival:
    weights = None if LOST[index] else WEIGHTS[index]
    return Arrival(index / 60, 60.0, weights, ROTATIONS[index], late=False)


def recorded(recorder: Recorder, spool: Spool, count: int) -> None:
    for step, index in enumerate(ORDER[:count]):
        recorder.add(arrival(int(index)))
        if step % 37 == 0:
            spool.save()


def test_what_is_saved_is_the_recording(tmp_path: Path) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, 400)
    spool.save(all_rows=True)
    found, wanted = read_take(tmp_path / "take.partial.csv"), recorder.take()
    assert found.fps == wanted.fps
    np.testing.assert_array_equal(found.lost, wanted.lost)
    np.testing.assert_allclose(found.weights, wanted.weights, atol=1e-9)
    np.testing.assert_allclose(found.rotations[~LOST], wanted.rotations[~LOST], atol=1e-9)


@pytest.mark.parametrize("count", [90, 120, 260, 400])
def test_a_recording_that_is_cut_short_opens_up_to_a_moment_ago(tmp_path: Path, count: int) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, count)  # and then nothing: no close, no flush
    left = read_take(tmp_path / "take.partial.csv")
    assert len(left) >= count - 37 - 60 - 9
    np.testing.assert_array_equal(left.lost, LOST[: len(left)])
    np.testing.assert_allclose(left.weights[~left.lost], WEIGHTS[: len(left)][~left.lost], atol=1e-9)
    spool.close(remove=True)
    assert not list(tmp_path.iterdir())


def test_what_an_earlier_crash_left_is_kept(tmp_path: Path) -> None:
    (tmp_path / "take.partial.csv").write_text("precious")
    assert Spool(Recorder(), tmp_path / "take.csv").path.name == "take.partial2.csv"
    assert (tmp_path / "take.partial.csv").read_text() == "precious"


def test_a_full_disk_leaves_whole_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, 200)
    before = spool.path.read_bytes()

    class Full:
        """A file on a disk with room for a few bytes more."""

        def __init__(self) -> None:
            self.room = 100

        def write(self, lines: bytes) -> int:
            if not self.room:
                raise OSError(28, "No space left on device")
            written, self.room = opened.write(lines[: self.room]), 0
            return written

        def __getattr__(self, name: str) -> object:
            return getattr(opened, name)

    opened = spool._file
    monkeypatch.setattr(spool, "_file", Full())
    with pytest.raises(EngineError, match="no space"):
        spool.save(all_rows=True)
    assert spool.failed and spool.path.read_bytes() == before


def test_a_folder_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(EngineError, match="cannot be written"):
        Spool(Recorder(), tmp_path / "nowhere" / "take.csv")
