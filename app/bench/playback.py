"""Playback with sound, and saving and opening an hour: what must not stall, measured in a whole window."""

from __future__ import annotations

import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from app.playback.clock import Pull
from app.playback.device import LATENCY_S
from app.preview.worker import Wanted
from engine.lab.speed.timing import Speed, performance_of

PLAYED_S = 30.0
RATE, BLOCK = 48_000, 512
PICTURES_GOAL_MS = 34.0  # 30 pictures a second, less one in fifty
BEAT_MS, SHOWN_MS, SETTLED_MS = 1, 500, 5000
SIZE = 512


class NullSink:
    """A loudspeaker that nobody hears, as strict as a real one.

    It asks for a block whenever one has been played, from a thread of its own, with `LATENCY_S` of sound waiting. A
    block that comes later than it was to be heard is an underrun: the sound would have dropped out.

    Attributes
    ----------
    blocks, underruns : how many were asked for, and how many of them came too late
    worst_s : the longest time from when a block was due to be asked for until it was there
    """

    name = "nothing"

    def __init__(self, rate: int, channels: int) -> None:
        self.rate = rate
        self.blocks = self.underruns = 0
        self.worst_s = 0.0
        self._pull: Pull | None = None
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, pull: Pull) -> bool:
        """Begin to pull."""
        if self._thread is None or not self._thread.is_alive():
            self._pull = pull
            self._thread = threading.Thread(target=self._run, name="null sink")
            self._thread.start()
        return True

    def close(self) -> None:
        """Stop pulling."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()

    def _run(self) -> None:
        assert self._pull is not None
        due = time.perf_counter()
        while not self._stop.wait(max(0.0, due - time.perf_counter())):
            if self._pull(BLOCK, due + LATENCY_S) is None:
                return
            took_s = time.perf_counter() - due
            self.blocks += 1
            self.underruns += took_s > LATENCY_S
            self.worst_s = max(self.worst_s, took_s)
            due += BLOCK / self.rate


def playback_job(seconds: float = PLAYED_S) -> list[Speed]:
    """Play the bundled take round and round, sound and picture together, and count what was dropped."""
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from engine.formats import read_take
    from engine.formats.audio import Audio
    from engine.lab.performer import demo

    application = QApplication.instance() or QApplication(["retake"])
    with tempfile.TemporaryDirectory() as folder:
        window = _window(read_take(demo.BUNDLED), Path(folder))
        sinks: list[NullSink] = []

        def opened(rate: int, channels: int) -> NullSink:
            sinks.append(NullSink(rate, channels))
            return sinks[-1]

        window.media._open_sink = opened
        samples = np.random.default_rng(0).uniform(
            -0.5, 0.5, (round(window.session.document.take.duration_s * RATE), 2)
        )
        window.session.document.attach_audio(Audio(samples.astype(np.float32), RATE))
        ratio = window.preview.face.devicePixelRatioF()
        window.preview.face.setFixedSize(round(SIZE / ratio), round(SIZE / ratio))
        shown: list[bytes] = [b""]  # each face once, however often it is drawn

        def drawn(wanted: Wanted, _: object) -> None:
            face = wanted.shot.faces[0]
            if face is not None and face.tobytes() != shown[-1]:
                shown.append(face.tobytes())

        window.preview.drawing.done.connect(drawn)
        window.transport.set_loop(True)
        window.transport.toggle()
        QTimer.singleShot(round(seconds * 1e3), application.quit)
        began = time.perf_counter()
        application.exec()
        spent_s = time.perf_counter() - began
        window.transport.run(0.0)
        pictures = len(shown) - 1
        window.close()
    (sink,) = sinks
    return [
        Speed("playback_underruns", float(sink.underruns), "blocks", 0.0),
        Speed("playback_block_ms_worst", 1e3 * sink.worst_s, "ms", 1e3 * LATENCY_S),
        Speed("playback_ms_per_picture", 1e3 * spent_s / max(1, pictures), "ms", PICTURES_GOAL_MS),
    ]


def saving_job() -> list[Speed]:
    """Save an hour at 60 fps, then a copy of it, and measure the longest the window did not answer meanwhile."""
    from PySide6.QtWidgets import QApplication

    application = QApplication.instance() or QApplication(["retake"])
    with tempfile.TemporaryDirectory() as folder:
        window = _window(performance_of(3600.0, 60.0), Path(folder))
        paths = [Path(folder) / f"{name}.retake" for name in ("hour", "copy")]
        steps = [partial(window.keeper.save_as, path) for path in paths]
        stall_ms, spent_s = _stall(application, window, steps, (window.keeper.saved, window.keeper.failed))
    return [
        Speed("save_60min_window_stall_ms_worst", stall_ms, "ms", 50.0),
        Speed("save_60min_twice_s", spent_s, "s", 15.0),
    ]


def opening_job() -> list[Speed]:
    """Open an hour at 60 fps from its CSV, and measure the longest the window did not answer until it was shown."""
    from PySide6.QtWidgets import QApplication

    from engine.formats import read_take, write_take
    from engine.lab.performer import demo

    application = QApplication.instance() or QApplication(["retake"])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hour.csv"
        write_take(performance_of(3600.0, 60.0), path)
        window = _window(read_take(demo.BUNDLED), Path(folder))
        ends = (window.files.opened, window.files.message)
        stall_ms, spent_s = _stall(application, window, [partial(window.load, path)], ends)
    return [
        Speed("open_60min_window_stall_ms_worst", stall_ms, "ms", 50.0),
        Speed("open_60min_s", spent_s, "s", 4.0),
    ]


def _stall(application, window, steps: Sequence[Callable[[], None]], ends) -> tuple[float, float]:  # type: ignore[no-untyped-def]
    """Do steps in a window, each until one of the signals `ends` it, and close it.

    Returns the longest wait for an answer in ms, and how long all took in s.
    """
    from PySide6.QtCore import QEventLoop, QTimer

    loop = QEventLoop()
    QTimer.singleShot(SETTLED_MS, loop.quit)  # what opening the window sets off is no part of it
    loop.exec()
    for end in ends:
        end.connect(loop.quit)
    beats = [time.perf_counter()]
    beat = QTimer(interval=BEAT_MS)
    beat.timeout.connect(lambda: beats.append(time.perf_counter()))
    beat.start()
    for step in steps:
        step()
        loop.exec()
    QTimer.singleShot(SHOWN_MS, loop.quit)  # what the last of them changed is on screen
    ended = time.perf_counter()
    loop.exec()
    beat.stop()
    application.processEvents()
    window.close()
    return 1e3 * float(np.diff(beats).max()), ended - beats[0]


def _window(take, folder: Path):  # type: ignore[no-untyped-def]
    """Return a window that remembers nothing, with its networks loaded and a face on screen."""
    from PySide6.QtCore import QEventLoop

    from app.settings import Settings
    from app.window.main_window import MainWindow

    window = MainWindow(take, None, Settings(folder / "settings.ini"), unsaved=folder / "unsaved")
    loop, waiting = QEventLoop(), {"ready", "drawn"}

    def arrived(what: str) -> None:
        waiting.discard(what)
        if not waiting:
            loop.quit()

    window.inference.ready.connect(lambda: arrived("ready"))
    window.preview.drawing.done.connect(lambda *_: arrived("drawn"))
    window.show()
    loop.exec()
    return window
