"""`retake live` in rough hands: what was recorded stays, whatever ends it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from app import cli
from engine.errors import EngineError
from engine.formats import read_take
from engine.lab.performer import demo
from engine.live.replay import replay
from engine.take import Take

SENT = Take(demo.performance().weights[:60], 30.0)


def free_port() -> int:
    with socket.socket(type=socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_recording_and_keeps_it(tmp_path: Path, number: signal.Signals) -> None:
    port, out = free_port(), tmp_path / "live.csv"

    def send() -> None:
        while not (tmp_path / "live.partial.csv").exists():
            time.sleep(0.01)
        replay(SENT, ("127.0.0.1", port))
        os.kill(os.getpid(), number)

    sender = threading.Thread(target=send)
    sender.start()
    assert cli.run(["live", "--port", str(port), "--record", str(out), "--seconds", "30"]) == 0
    sender.join()
    np.testing.assert_allclose(read_take(out).weights, SENT.weights, atol=1e-6)
    assert [path.name for path in tmp_path.iterdir()] == ["live.csv"]


def test_what_a_kill_leaves_opens(tmp_path: Path) -> None:
    port, left = free_port(), tmp_path / "live.partial.csv"
    command = [sys.executable, "-m", "app", "live", "--port", str(port), "--record", str(tmp_path / "live.csv")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    stop = threading.Event()
    sender = threading.Thread(
        target=replay, args=(SENT, ("127.0.0.1", port)), kwargs={"repeat": True, "stop": stop.is_set}
    )
    try:
        assert process.stderr is not None and b"listening" in process.stderr.readline()
        sender.start()
        deadline = time.monotonic() + 30
        while left.stat().st_size < 20_000:
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.05)
    finally:
        process.kill()
        process.communicate()
        stop.set()
    sender.join()
    found = read_take(left)
    assert found.fps == 30.0 and len(found) >= 15
    starts = [
        np.abs(np.roll(SENT.weights, -shift, axis=0)[: len(found)] - found.weights[:60]).max() for shift in range(60)
    ]
    assert min(starts) < 1e-6


def test_a_recording_that_cannot_be_written_where_it_should_is_kept_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    port, out = free_port(), tmp_path / "live.csv"

    def full(take: Take, path: Path) -> None:
        raise EngineError(f"{path.name} could not be written: no space left on device.")

    monkeypatch.setattr("app.cli.clean.write_take", full)
    sender = threading.Timer(0.3, replay, [SENT, ("127.0.0.1", port)])
    sender.start()
    assert cli.run(["live", "--port", str(port), "--record", str(out), "--seconds", "3"]) == 2
    sender.join()
    told = "".join(capsys.readouterr().err.split())
    assert "nospaceleft" in told and "live.partial.csv" in told
    np.testing.assert_allclose(read_take(tmp_path / "live.partial.csv").weights, SENT.weights, atol=1e-6)


@pytest.mark.parametrize("name", ["live.xyz", "live", "nowhere/live.csv"])
def test_a_file_that_cannot_be_recorded_to_is_refused_before_the_performance(tmp_path: Path, name: str) -> None:
    began = time.monotonic()
    assert cli.run(["live", "--port", "0", "--record", str(tmp_path / name), "--seconds", "60"]) == 2
    assert time.monotonic() - began < 20 and not list(tmp_path.iterdir())


def test_nobody_but_this_computer_is_heard_unless_asked(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["live", "--port", "0", "--seconds", "0"]) == 0
    assert "127.0.0.1" in capsys.readouterr().err
    assert cli.run(["live", "--port", "0", "--seconds", "0", "--bind", ""]) == 2


def test_without_packets_no_latency_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["live", "--port", "0", "--seconds", "0.05"]) == 0
    told = capsys.readouterr().out
    assert "0 frames, none dropped" in told and "p95" not in told
