from __future__ import annotations

import json
import sqlite3
import zlib
from pathlib import Path

import numpy as np

from engine.formats import read_take, write_take
from engine.lab.performer import demo
from engine.project import replay
from engine.take import SHAPES, runs
from tests.engine.project.projects import reopened
from tests.engine.project.versions import SECOND_VERSION


def test_a_take_in_a_file_of_the_second_version_is_written_as_it_came_and_its_fill_with_it(tmp_path: Path) -> None:
    """The second version kept the values of the file and their decimals, and of an edit not what it found."""
    path, take = tmp_path / "old.retake", read_take(demo.BUNDLED)
    lines = demo.BUNDLED.read_bytes().splitlines()
    header, rows = lines[0].decode().split(","), [line.split(b",") for line in lines[1:]]
    lost = np.array([row[1] == b"0" for row in rows])
    recorded = np.array([np.zeros(61) if len(row) == 2 else np.array(row[2:], float) for row in rows])
    start, stop = runs(take.lost)[0]
    filled = np.random.default_rng(0).random((stop - start, len(SHAPES)))
    timecodes = b"\n".join(row[0] for row in rows)
    database = sqlite3.connect(path)
    database.executescript(SECOND_VERSION)
    packed = zlib.compress
    blobs = [packed(array.tobytes()) for array in (take.weights, take.lost, take.rotations)]
    database.execute(
        "INSERT INTO take VALUES (1, 'demo', ?, ?, ?, ?, ?, ?)", (take.fps, take.start_s, len(take), *blobs)
    )
    blobs = [packed(array.tobytes()) for array in (np.arange(len(rows)), recorded, lost)]
    database.execute(
        "INSERT INTO origin VALUES (1, ?, ?, ?, ?, ?, ?, ?, 10, x'0a', 1)",
        (json.dumps(header), len(rows), len(timecodes), packed(timecodes), *blobs),
    )
    asked = packed(np.full((stop - start, 1), np.nan).tobytes())
    database.execute(
        "INSERT INTO edits VALUES (0, 'fill', 'fill', '{}', ?, ?, ?, '[\"lips_vertical\"]', ?)",
        (start, stop - start, packed(filled.tobytes()), asked),
    )
    database.execute("INSERT INTO state VALUES (1, 1, '', '2025-01-02T03:04:05Z')")
    database.commit()
    database.close()

    found = reopened(path)
    write_take(found.original, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == demo.BUNDLED.read_bytes()
    write_take(replay(found).take, tmp_path / "filled.csv")
    again = read_take(tmp_path / "filled.csv")
    assert not again.lost.any()
    np.testing.assert_allclose(again.weights[start:stop], filled, atol=1e-10)
