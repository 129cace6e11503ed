"""Running the program that hears: fed, followed and, where nobody wants the answer any more, ended."""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from engine.errors import EngineError

WORKER = Path(__file__).with_name("worker.py")
LOOK_S = 0.1  # between two looks at whether the answer is still wanted
Follow = Callable[[float], bool]  # takes the part of the way that is done, 0..1; returns whether to go on


class Cancelled(EngineError):
    """Nobody wants the answer any more."""


def go_on(part: float) -> bool:
    """Follow nothing, and never stop."""
    return True


def run(job: dict[str, Any], parts: Sequence[bytes], follow: Follow = go_on) -> dict[str, Any]:
    """Return the answer to a job about parts of a recording.

    `follow` is asked ten times a second on the calling thread; where it returns False the process is ended at once and
    `Cancelled` raised. Raises `EngineError` where the process dies.
    """
    process = subprocess.Popen(
        [sys.executable, "-P", str(WORKER)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    lines: queue.Queue[bytes] = queue.Queue()
    head = json.dumps({**job, "lengths": [len(part) for part in parts]}).encode()
    threads = [
        threading.Thread(target=_feed, args=(process, [head, b"\n", *parts]), daemon=True),
        threading.Thread(target=_listen, args=(process, lines), daemon=True),
    ]
    for thread in threads:
        thread.start()
    try:
        return _answer(lines, follow)
    finally:
        process.kill()
        process.wait()
        for thread in threads:
            thread.join()


def _answer(lines: queue.Queue[bytes], follow: Follow) -> dict[str, Any]:
    part = 0.0
    while True:
        if not follow(part):
            raise Cancelled("The speech was not listened to any further.")
        try:
            line = lines.get(timeout=LOOK_S)
        except queue.Empty:
            continue
        if not line:
            raise EngineError("The program that listens ended before it was done.", "Try it with a shorter part.")
        told = json.loads(line)
        if "part" not in told:
            return dict(told)
        part = float(told["part"])


def _feed(process: subprocess.Popen[bytes], pieces: Sequence[bytes]) -> None:
    if process.stdin is None:
        return
    try:
        with process.stdin as pipe:
            for piece in pieces:
                pipe.write(piece)
    except OSError:
        return  # it has ended, which the listening side tells


def _listen(process: subprocess.Popen[bytes], lines: queue.Queue[bytes]) -> None:
    if process.stdout is None:
        return
    with process.stdout as pipe:
        for line in pipe:
            lines.put(line)
    lines.put(b"")
