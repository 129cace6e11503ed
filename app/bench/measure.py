"""Every speed the program promises, measured on the machine at hand, each beside its goal."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from app.bench.playback import opening_job, playback_job, saving_job
from engine.lab.reporting import Report
from engine.lab.speed.timing import Speed, percentile_ms, performance_of
from engine.take import Take

DRAGS = 60
SIZE = 512


def measure(report: Report) -> list[dict[str, Any]]:
    """Return all rows: the methods', then the window's."""
    from engine.lab.speed.methods import METHODS  # here, since the start of the window is measured from this module

    rows: list[Speed] = []
    for name, method in METHODS.items():
        report(f"measuring {name}")
        rows += method()
    for job in ("render", "window", "playback", "saving", "opening"):
        report(f"measuring {job}")
        rows += _in_own_process(job)
    rows.append(_startup())
    return [{key: value for key, value in asdict(row).items() if key != "at_least"} for row in rows]


def _in_own_process(job: str) -> list[Speed]:
    """Run a measurement where nothing else holds a renderer: one process has room for one."""
    environment = dict(os.environ, QT_QPA_PLATFORM=os.environ.get("QT_QPA_PLATFORM", "offscreen"))
    done = subprocess.run(
        [sys.executable, "-m", "app.bench.measure", job], env=environment, capture_output=True, text=True, check=True
    )
    rows = [line.split() for line in done.stdout.splitlines()]
    return [Speed(name, float(value), unit, float(goal)) for name, value, unit, goal in rows]


def _startup() -> Speed:
    """Measure a cold start to a window that has painted and takes input."""
    began = time.perf_counter()  # one clock for all processes of a machine
    (painted,) = _in_own_process("startup")
    return Speed(painted.name, painted.value - began, painted.unit, painted.goal)


def render_job() -> list[Speed]:
    """Measure drawing one frame after another."""
    from app.preview.renderer import Renderer, Shot
    from engine.character import bundled

    take = performance_of(8.0)
    renderer = Renderer(bundled())
    spent = percentile_ms(
        lambda index: renderer.draw(Shot((take.weights[index],), size=(SIZE, SIZE))), DRAGS, percentile=50
    )
    return [Speed("render_512_ms", spent, "ms", 20.0)]


def window_job() -> list[Speed]:
    """Measure from the mouse event to the new face on screen, on an 8 s and on a 60 min take."""
    long_take = performance_of(3600.0)
    short, long = _drag_to_preview(performance_of(8.0)), _drag_to_preview(long_take)
    return [
        Speed("drag_to_preview_ms_p95", short, "ms", 50.0),
        Speed("drag_to_preview_60min_ms_p95", long, "ms", 50.0),
        Speed("curve_repaint_ms_p95", _repaint(long_take, whole=False), "ms", 16.0),
        Speed("curve_repaint_60_curves_60min_ms_p95", _repaint(long_take, whole=True), "ms", 50.0),
        Speed("timeline_repaint_60min_ms_p95", _repaint_timeline(long_take, whole=False), "ms", 16.0),
        Speed("timeline_repaint_whole_60min_ms_p95", _repaint_timeline(long_take, whole=True), "ms", 16.0),
    ]


def _repaint(take: Take, *, whole: bool) -> float:
    """Measure panning the eight lanes by a frame, or those and every raw weight over the whole of a long take."""
    from PySide6.QtWidgets import QApplication

    from app.window.main_window import MainWindow

    application = QApplication.instance() or QApplication(["retake"])
    window = MainWindow(take)
    window.show()
    if whole:
        for control in range(8):
            window.session.view.expand(control)
        window.session.view.set_range(0.0, len(take) - 1000.0)
    application.processEvents()

    def pan(index: int) -> None:
        first, last = window.session.view.range
        window.session.view.set_range(first + 1, last + 1)
        window.curves.viewport().repaint()

    spent = percentile_ms(pan, DRAGS)
    window.close()
    return spent


def _repaint_timeline(take: Take, *, whole: bool) -> float:
    """Measure panning a timeline with all its lanes full: an hour of sound, cues, spans, flags, pins and notes."""
    from PySide6.QtWidgets import QApplication

    from app.session import Session
    from app.theme import DARK
    from app.timeline.panel import Timeline
    from engine.formats.audio import Audio
    from engine.project import Marks, Note, Pin, Span
    from engine.quality import Flag
    from engine.speech.lane import attached
    from engine.speech.visemes import NAMES, Cue

    application = QApplication.instance() or QApplication(["retake"])
    session = Session(take)
    shown = Timeline(session, DARK, gutter_px=150)
    rng, every = np.random.default_rng(0), range(0, len(take) - 60, 300)
    begins = np.sort(rng.random(round(10 * take.duration_s))) * take.duration_s
    cues = [Cue(a, b, NAMES[i % len(NAMES)]) for i, (a, b) in enumerate(itertools.pairwise(begins.tolist()))]
    session.document.attach_audio(Audio(rng.uniform(-0.5, 0.5, round(8000 * take.duration_s)).astype(np.float32), 8000))
    session.document.set_visemes(attached(cues, "an hour"))
    session.document.set_flags(
        tuple(Flag("spike", i, i + 1 + i % 40, (i % 97) / 97, "A spike.") for i in range(0, len(take), 20))
    )
    spans = tuple(Span(i, i + 20) for i in every)
    pins = tuple(Pin(i, {}, i - 9, i + 9) for i in every if i)
    session.document.set_marks(Marks(spans, pins, tuple(Note(i, "", "", "a note") for i in every)))
    session.view.set_range(0.0, len(take) - 1000.0 if whole else 16 * take.fps)
    shown.resize(1000, shown.sizeHint().height())
    shown.show()
    application.processEvents()

    def pan(index: int) -> None:
        first, last = session.view.range
        session.view.set_range(first + 1, last + 1)
        shown.repaint()

    spent = percentile_ms(pan, DRAGS)
    shown.close()
    return spent


def _drag_to_preview(take: Take) -> float:
    from PySide6.QtCore import QEventLoop, QTimer
    from PySide6.QtWidgets import QApplication

    from app.window.main_window import MainWindow

    application = QApplication.instance() or QApplication(["retake"])
    window = MainWindow(take)
    window.show()
    face = window.preview.face
    ratio = face.devicePixelRatioF()
    face.setFixedSize(round(SIZE / ratio), round(SIZE / ratio))
    spent: list[float] = []
    loop = QEventLoop()
    window.preview.timed.connect(spent.append)
    window.preview.timed.connect(loop.quit)
    window.inference.ready.connect(loop.quit)
    loop.exec()
    patience = QTimer(singleShot=True, interval=2000)
    patience.timeout.connect(loop.quit)
    start = len(take) // 2
    window.session.view.move_playhead(start + 10)
    for index in range(DRAGS + 5):
        asked = window.session.document.controls[start : start + 30].copy()
        asked[:, 0] += 0.1 * (index + 1)
        window.inference.ask(start, asked)
        patience.start()
        loop.exec()
        application.processEvents()
    window.inference.cancel()
    window.session.document.undo.setClean()
    window.close()
    return float(np.percentile(spent[5:], 95))


def startup_job() -> list[Speed]:
    """Open the window and stop the clock when it has painted; the clock began in the process that asked."""
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from app.window.main_window import MainWindow
    from engine.formats import read_take
    from engine.lab.performer import demo

    application = QApplication(["retake"])
    window = MainWindow(read_take(demo.BUNDLED), demo.BUNDLED)
    window.show()
    stamp: list[float] = []

    def painted() -> None:
        window.repaint()
        stamp.append(time.perf_counter())
        application.quit()

    QTimer.singleShot(0, painted)
    application.exec()
    window.shut_down()
    return [Speed("startup_s", stamp[0], "s", 3.0)]


JOBS: dict[str, Callable[[], list[Speed]]] = {
    "render": render_job,
    "window": window_job,
    "playback": playback_job,
    "saving": saving_job,
    "opening": opening_job,
    "startup": startup_job,
}

if __name__ == "__main__":
    for row in JOBS[sys.argv[1]]():
        print(row.name, row.value, row.unit, row.goal)
