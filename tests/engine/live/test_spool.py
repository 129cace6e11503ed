from __future__ import annotations

import os
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest

from engine.errors import EngineError
from engine.formats import read_take
from engine.formats.livelink import header
from engine.live.record import Recorder
from engine.live.spool import Spool, recovered
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


class Full:
    """A file on a disk with room for a few bytes more."""

    def __init__(self, file: BinaryIO) -> None:
        self.file, self.room = file, 100

    def write(self, lines: bytes) -> int:
        if not self.room:
            raise OSError(28, "No space left on device")
        written, self.room = self.file.write(lines[: self.room]), 0
        return written

    def __getattr__(self, name: str) -> object:
        return getattr(self.file, name)


def test_a_full_disk_leaves_whole_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, 200)
    before = spool.path.read_bytes()

    monkeypatch.setattr(spool, "_file", Full(spool._file))
    with pytest.raises(EngineError, match="no space"):
        spool.save(all_rows=True)
    assert spool.failed and spool.path.read_bytes() == before


def test_a_folder_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(EngineError, match="cannot be written"):
        Spool(Recorder(), tmp_path / "nowhere" / "take.csv")


@pytest.mark.parametrize("how", ["deleted", "replaced", "moved with its folder"])
def test_a_file_that_vanishes_is_written_anew_from_the_beginning(tmp_path: Path, how: str) -> None:
    folder, recorder = tmp_path / "live", Recorder()
    folder.mkdir()
    spool = Spool(recorder, folder / "take.csv")
    recorded(recorder, spool, 200)
    if how == "deleted":
        spool.path.unlink()
    elif how == "replaced":
        (tmp_path / "other.csv").write_text("precious")
        (tmp_path / "other.csv").replace(spool.path)
    else:
        folder.rename(tmp_path / "moved")
        with pytest.raises(EngineError, match="cannot be written"):
            spool.save()
        assert spool.failed
        folder.mkdir()
    spool.save(all_rows=True)
    assert not spool.failed and spool.path.parent == folder
    np.testing.assert_allclose(read_take(spool.path).weights, recorder.take().weights, atol=1e-9)
    if how == "replaced":
        assert (folder / "take.partial.csv").read_text() == "precious"
    spool.close(remove=True)
    assert sorted(path.name for path in folder.iterdir()) == (["take.partial.csv"] if how == "replaced" else [])


def test_what_did_not_fit_on_a_full_disk_comes_when_there_is_room(tmp_path: Path) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, 100)
    opened, spool._file = spool._file, Full(spool._file)
    for index in ORDER[100:300]:
        recorder.add(arrival(int(index)))
    for _ in range(2):
        with pytest.raises(EngineError, match="no space"):
            spool.save()
    spool._file = opened
    spool.save(all_rows=True)
    np.testing.assert_allclose(read_take(spool.path).weights, recorder.take().weights, atol=1e-9)


@pytest.mark.parametrize("tear", range(1, 700, 37))
def test_a_torn_row_at_the_end_costs_that_row_alone(tmp_path: Path, tear: int) -> None:
    recorder = Recorder()
    spool = Spool(recorder, tmp_path / "take.csv")
    recorded(recorder, spool, 300)
    spool.save(all_rows=True)
    spool.close(remove=False)
    content = spool.path.read_bytes()
    for tail in (b"", b"\0" * 5000):
        spool.path.write_bytes(content[:-tear] + tail)
        rows = content[:-tear].count(b"\n") - 1
        found = recovered(spool.path)
        assert found is not None and abs(len(found) - rows) <= 9  # late ones at the end stand for gaps
        np.testing.assert_allclose(
            found.weights[~found.lost], recorder.take().weights[: len(found)][~found.lost], atol=1e-9
        )


def test_a_recording_of_nothing_is_none_and_what_is_no_recording_an_error(tmp_path: Path) -> None:
    path = tmp_path / "take.partial.csv"
    whole = header()
    for content in (b"", whole[:20], whole, whole + b"00:00:00:00.000,0\n", whole + b"00:00:00:00.000,61,0.5"):
        path.write_bytes(content)
        assert recovered(path) is None
    path.write_bytes(b"my own notes\n1,2,3,4\n")
    with pytest.raises(EngineError):
        recovered(path)


def test_the_file_is_brought_to_the_disk_once_a_second_and_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now, recorder, synced = [0.0], Recorder(), []
    monkeypatch.setattr("engine.live.spool.time.monotonic", lambda: now[0])
    spool = Spool(recorder, tmp_path / "take.csv")
    fsync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda file: (synced.append(now[0]), fsync(file)))
    for step in range(40):
        now[0] = step / 8
        recorder.add(arrival(step))
        spool.save()
        if spool._syncing is not None:
            spool._syncing.join()
    assert synced == [1.0, 2.0, 3.0, 4.0]
    spool.save(all_rows=True)
    assert len(synced) == 5
