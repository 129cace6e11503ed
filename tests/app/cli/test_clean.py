from __future__ import annotations

import json
import socket
import threading
from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.formats import read_take, write_take
from engine.lab.performer.demo import BUNDLED
from engine.take import Take


def test_a_take_is_cleaned_over_a_range(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "clean.csv"
    assert cli.run(["clean", str(BUNDLED), "--frames", "40:80", "-o", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    before, after = read_take(BUNDLED).weights, read_take(out).weights
    outside = np.r_[0:40, 80 : len(before)]
    np.testing.assert_array_equal(after[outside], before[outside])
    assert told["frames"] == [40, 80] and np.abs(after - before).max() == pytest.approx(told["removed"], abs=1e-6)
    assert np.abs(after - before).max() > 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["clean", str(BUNDLED), "--strength", "2", "-o", "x.csv"],
        ["clean", str(BUNDLED), "--frames", "9:3", "-o", "x.csv"],
        ["replay", str(BUNDLED), "--to", "nowhere"],
        ["replay", str(BUNDLED), "--to", "127.0.0.1:99999"],
        ["live", "--bind", "192.0.2.1", "--port", "0", "--seconds", "0.1"],
    ],
)
def test_what_cannot_be_done_is_said_in_one_sentence(
    arguments: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.run(arguments) == 2
    assert "Traceback" not in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_replayed_take_is_recorded_live(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket(type=socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    short, out = tmp_path / "short.csv", tmp_path / "live.csv"
    write_take(Take(read_take(BUNDLED).weights[:20], 30.0), short)
    sender = threading.Timer(0.4, cli.run, [["replay", str(short), "--to", f"127.0.0.1:{port}"]])
    sender.start()
    assert cli.run(["live", "--port", str(port), "--record", str(out), "--seconds", "3", "--json"]) == 0
    sender.join()
    told = [json.loads(line) for line in capsys.readouterr().out.splitlines() if line.startswith("{")]
    assert told[-1]["subjects"] == ["Retake"] and told[-1]["frames"] == 20 and told[-1]["drops"] == {}
    np.testing.assert_allclose(read_take(out).weights, read_take(short).weights, atol=1e-6)
