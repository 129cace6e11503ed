"""A phone's stream in the whole window: delay, memory, a flood, and whether the recording is what was sent.

Run: xvfb-run -a python -m tests.performance.live [seconds] [--record] [--flood]
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import socket
import sys
import tempfile
import time
from collections import deque
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from engine.lab.performer import demo
from engine.lab.train.clean.material import cubic
from engine.live.livelink import Stamp, encode
from engine.live.replay import Network, packets, schedule
from engine.take import SHAPES, Array, Take

FPS = 60.0
NETWORK = Network(loss=0.05, reorder=0.05, jitter_s=0.004)
FLOOD_PER_S = 5000
TICK_MS = 10
SETTLED_S = 20.0  # networks, renderer and caches are warm by then
WINDOW_S = 60.0  # of the first and of the last figures
GOALS = {"weights_ms_p95": 3.0, "preview_ms_p95": 60.0, "event_loop_late_ms_p95": 50.0}


def performance(seconds: float) -> Take:
    """Return the demo take at sixty frames a second, over and over, so long."""
    own = demo.performance()
    once = cubic(own.weights, np.arange(0, len(own) - 1, own.fps / FPS))
    there_and_back = np.concatenate([once, once[::-1]]).astype(np.float32)
    return Take(np.resize(there_and_back, (round(seconds * FPS), len(SHAPES))), FPS, name="sent")


def send(port: int, seconds: float, tell: Connection) -> None:
    """Send a performance as a phone would; tells (packets, 3) index, time of sending and when that was due."""
    take = performance(seconds)
    encoded = list(packets(take))
    sent = []
    with socket.socket(type=socket.SOCK_DGRAM) as out:
        began = time.perf_counter() + 1.0
        for due, index in schedule(take, NETWORK):
            time.sleep(max(0.0, began + due - time.perf_counter()))
            sent.append((index, time.perf_counter(), began + due))
            out.sendto(encoded[index], ("127.0.0.1", port))
    tell.send(np.array(sent))


def flood(port: int, seconds: float) -> None:
    """Send faces and nonsense from another address, many thousand a second."""
    rng = np.random.default_rng(0)
    kinds = [encode(Stamp(1), rng.random(len(SHAPES)).astype(np.float32), subject="flood"), rng.bytes(700), b""]
    with socket.socket(type=socket.SOCK_DGRAM) as out:
        out.bind(("127.0.0.2", 0))
        time.sleep(3.0)  # the phone comes first: the first face that arrives is the one that is followed
        began = time.perf_counter()
        for index in range(round(seconds * FLOOD_PER_S)):
            time.sleep(max(0.0, began + index / FLOOD_PER_S - time.perf_counter()))
            out.sendto(kinds[index % 3], ("127.0.0.1", port))


def resident_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


class Column:
    """Pairs of numbers, room for all of them from the start: what is noted must not look like growing memory."""

    def __init__(self, room: int) -> None:
        self._rows, self._count = np.zeros((room, 2)), 0
        self._rows += 1e-9  # so that the pages are really there

    def add(self, first: float, second: float) -> None:
        if self._count < len(self._rows):
            self._rows[self._count] = first, second
            self._count += 1

    @property
    def rows(self) -> Array:
        return self._rows[: self._count]


class Log:
    """What is noted while the window runs; times on the clock of `time.perf_counter`.

    Attributes
    ----------
    ready, shown : frame, and when its clean weights were there, or its picture on screen
    late : when the event loop ticked, and by how much late, seconds
    resident : when, and MB
    """

    def __init__(self, seconds: float) -> None:
        self.ready, self.shown = Column(round(2 * seconds * FPS)), Column(round(2 * seconds * FPS))
        self.late, self.resident = Column(round(2000 * seconds / TICK_MS)), Column(round(2 * seconds) + 60)
        self.arrived: deque[tuple[float, int]] = deque(maxlen=1024)  # which frame came when


def watch(window, first: int, log: Log) -> list[object]:  # type: ignore[no-untyped-def]
    """Note everything from now on; returns the timers, to be kept."""
    from PySide6.QtCore import Qt, QTimer

    listener = window.live._listener
    taken = listener.frames

    def frames():  # type: ignore[no-untyped-def]
        new = taken()
        for frame in new:
            index = first + round(frame.time_s * FPS)
            log.arrived.append((frame.arrived_s, index))
            log.ready.add(index, frame.arrived_s + frame.latency_ms / 1e3)
        return new

    def drawn(wanted, _: object) -> None:  # type: ignore[no-untyped-def]
        index = next((index for arrived_s, index in log.arrived if arrived_s == wanted.since), None)
        if index is not None:
            log.shown.add(index, time.perf_counter())

    def tick() -> None:
        now = time.perf_counter()
        if ticked:
            log.late.add(now, max(0.0, now - ticked[-1] - TICK_MS / 1e3))
        ticked[:] = [now]

    ticked: list[float] = []
    listener.frames = frames
    window.preview.drawing.done.connect(drawn)
    timers = []
    for interval, kind, slot in (
        (TICK_MS, Qt.TimerType.PreciseTimer, tick),
        (1000, Qt.TimerType.CoarseTimer, lambda: log.resident.add(time.perf_counter(), resident_mb())),
    ):
        timer = QTimer(window, interval=interval, timerType=kind)
        timer.timeout.connect(slot)
        timer.start()
        timers.append(timer)
    return timers


def delays_ms(log: Log, sent: Array) -> tuple[Array, Array]:
    """Return (n, 2) time of sending and delay until clean weights, and likewise until the picture."""
    when = {int(index): at for index, at, _ in sent}
    weights, preview = (
        np.array([(when[int(index)], (at - when[int(index)]) * 1e3) for index, at in column.rows])
        for column in (log.ready, log.shown)
    )
    return weights, preview


def p95(timed: Array, start_s: float, stop_s: float, percent: float = 95.0) -> float:
    """Return the 95th or another percentile of the second column over a stretch of time."""
    inside = timed[(timed[:, 0] >= start_s) & (timed[:, 0] < stop_s), 1]
    return float(np.percentile(inside, percent)) if len(inside) else float("nan")


def summary(log: Log, sent: Array) -> dict[str, float]:
    """Return the figures of a run, the first seconds left out; how late the sender is tells how busy the machine is."""
    begin, end = sent[0, 1] + SETTLED_S, sent[-1, 1]
    stretch = min(WINDOW_S, (end - begin) / 2)
    weights, preview = delays_ms(log, sent)
    late, resident = log.late.rows, log.resident.rows
    sending = np.stack([sent[:, 1], (sent[:, 1] - sent[:, 2]) * 1e3], axis=1)
    found = {
        "seconds": end - begin,
        "weights_ms_p95": p95(weights, begin, end),
        "preview_ms_p95": p95(preview, begin, end),
        "pictures_per_s": float(np.sum(preview[:, 0] >= begin)) / (end - begin),
        "event_loop_late_ms_p95": 1e3 * p95(late, begin, end),
        "event_loop_late_ms_max": 1e3 * float(late[late[:, 0] >= begin, 1].max()),
    }
    for name, start in (("first", begin), ("last", end - stretch)):
        found[f"weights_ms_p95_{name}"] = p95(weights, start, start + stretch)
        found[f"weights_ms_p50_{name}"] = p95(weights, start, start + stretch, 50.0)
        found[f"preview_ms_p50_{name}"] = p95(preview, start, start + stretch, 50.0)
        found[f"preview_ms_p95_{name}"] = p95(preview, start, start + stretch)
        found[f"sender_late_ms_p95_{name}"] = p95(sending, start, start + stretch)
        inside = resident[(resident[:, 0] >= start) & (resident[:, 0] < start + stretch), 1]
        found[f"resident_mb_{name}"] = float(np.median(inside))
    return found


def check_recording(recorded: Take, sent: Take, indices: Array) -> int:
    """Prove that a recording is what was sent at the frames that arrived; returns how many sent frames are not in it."""
    first = int(indices.min())
    arrived = np.flatnonzero(~recorded.lost)
    assert recorded.fps == sent.fps and set(arrived + first) <= {int(index) for index in indices}
    np.testing.assert_array_equal(recorded.weights[arrived], sent.weights[arrived + first])
    return len(indices) - len(arrived)


def run(seconds: float, *, record: bool, flooded: bool) -> tuple[Log, Array, dict[str, int]]:
    """Return what was noted in a window that listened so long, what was sent, and what was dropped."""
    from PySide6.QtCore import QEventLoop, QTimer
    from PySide6.QtWidgets import QApplication

    application = QApplication(["live"])
    application.setStyle("Fusion")
    context = multiprocessing.get_context("spawn")
    told, tell = context.Pipe(duplex=False)
    log, loop = Log(seconds + 60), QEventLoop()
    with tempfile.TemporaryDirectory() as folder, opened(Path(folder), loop) as window:
        port = listen(window)
        if record:
            window.live.toggle_recording()
        order = schedule(performance(seconds), NETWORK)
        kept = watch(window, order[0][1], log)
        workers = [context.Process(target=send, args=(port, seconds, tell), daemon=True)]
        if flooded:
            workers.append(context.Process(target=flood, args=(port, seconds), daemon=True))
        for worker in workers:
            worker.start()
        done = QTimer(interval=200)
        done.timeout.connect(lambda: (told.poll() or not workers[0].is_alive()) and loop.quit())
        done.start()
        loop.exec()
        sent = told.recv()
        QTimer.singleShot(500, loop.quit)
        loop.exec()
        drops = window.live._listener.status().drops
        if record:
            window.live.toggle_recording()
            missing = check_recording(window.session.document.take, performance(seconds), sent[:, 0])
            print(f"recorded: equal to what was sent at every frame; {missing} of {len(sent)} sent frames not in it")
        for timer in kept:
            timer.stop()
        application.processEvents()
        for worker in workers[1:]:
            worker.terminate()
    return log, sent, drops


@contextmanager
def opened(folder: Path, loop):  # type: ignore[no-untyped-def]
    """Give a window whose networks are loaded."""
    from app.settings import Settings
    from app.window.main_window import MainWindow

    window = MainWindow(demo.performance(), None, Settings(folder / "live.ini"), unsaved=folder / "unsaved")
    window.show()
    window.inference.ready.connect(loop.quit)
    loop.exec()
    yield window
    window.session.document.undo.setClean()
    window.close()


def listen(window) -> int:  # type: ignore[no-untyped-def]
    """Listen on a free port."""
    window.edits.live_tool()
    with socket.socket(type=socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    window.live.port.setValue(port)
    window.live.toggle()
    return port


def main(arguments: list[str]) -> int:
    """Run the window for so long and print the figures; 1 where one of them misses its goal."""
    parser = argparse.ArgumentParser()
    parser.add_argument("seconds", type=float, nargs="?", default=60.0)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--flood", action="store_true")
    options = parser.parse_args(arguments)
    log, sent, drops = run(options.seconds, record=options.record, flooded=options.flood)
    found = summary(log, sent)
    print("\n".join(f"{name:24} {value:9.2f}" for name, value in found.items()))
    print("load of the machine:", " ".join(f"{load:.1f}" for load in os.getloadavg()), f"on {os.cpu_count()} cores")
    print("drops:", ", ".join(f"{count} {reason}" for reason, count in drops.items()) or "none")
    return int(any(not found[name] <= goal for name, goal in GOALS.items()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
