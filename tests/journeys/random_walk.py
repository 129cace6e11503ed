"""Ten thousand random events over twenty seeds: no Qt warning, no exception, no stall, no lost edit, memory flat.

Run: QT_QPA_PLATFORM=offscreen nice python -m tests.journeys.random_walk [events] [seeds] [first seed]

Each seed walks in a process of its own, so that its memory is its own. A stall is work of the window's thread: the clock
would count what other programs take from it.
"""

from __future__ import annotations

import gc
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

import numpy as np
from PySide6.QtWidgets import QApplication

from app.settings import Settings
from app.window.main_window import MainWindow
from engine.formats import read_take
from engine.lab.performer import demo
from tests.journeys.walking import Walk, lay_out_files, undisturbed
from tests.performance.soak import resident_mb

STALL_MS = 200.0
CHECK_EVERY = 50  # events
WARM = 0.4  # of the events: by then every network is loaded and every lane was shown
GROWN_MB = 120.0  # that undo steps, lanes and heads of a walk may take


def walk(seed: int, events: int, raised: list[str]) -> tuple[Walk, float, float]:
    """Walk one seed from a fresh window to its end; returns the walk, and the memory when it was warm and at its end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lay_out_files(folder)
        settings = Settings(folder / "settings.ini")
        window = MainWindow(read_take(demo.BUNDLED), demo.BUNDLED, settings, unsaved=folder / "unsaved")
        walker, warm_mb, ready = Walk(window, seed, folder), 0.0, list[bool]()
        window.inference.ready.connect(lambda: ready.append(True))
        with undisturbed(walker):
            window.show()
            walker.wait(lambda: bool(ready))
            for index in range(events):
                walker.step()
                assert not raised, (raised, walker.done[-20:])
                if index % CHECK_EVERY == 0:
                    walker.check()
                if index == int(WARM * events):
                    gc.collect()
                    warm_mb = resident_mb()
            gc.collect()
            end_mb = resident_mb()
            walker.end()
        return walker, warm_mb, end_mb


def walk_one(seed: int, events: int) -> int:
    """Walk one seed in this process, and say what came of it."""
    application = QApplication(["walk"])
    application.setStyle("Fusion")
    raised: list[str] = []
    sys.excepthook = lambda *error: raised.append("".join(traceback.format_exception(*error)))
    try:
        walker, warm_mb, end_mb = walk(seed, events, raised)
    except Exception as error:
        told = str(error) if isinstance(error, AssertionError) else traceback.format_exc()
        print(f"seed {seed}: {told}", flush=True)
        return 1
    wall, own = np.array(walker.spent_ms).T
    slow = [f"{walker.done[at]} {own[at]:.0f} ms" for at in np.flatnonzero(own > STALL_MS)]
    print(
        f"seed {seed}: {events} events, {walker.steps} steps saved, {warm_mb:.0f} MB warm, {end_mb:.0f} MB at the end; "
        f"the window's thread p50 {np.quantile(own, 0.5):.0f} ms, p99 {np.quantile(own, 0.99):.0f} ms, most {own.max():.0f} ms "
        f"(by the clock p99 {np.quantile(wall, 0.99):.0f} ms); stalls: {'; '.join(slow) or 'none'}",
        flush=True,
    )
    return int(bool(slow) or end_mb - warm_mb > GROWN_MB)


def main() -> int:
    """Walk each seed, and say how many went wrong."""
    events, seeds, first = (int(each) for each in (*sys.argv[1:4], *("10000", "20", "0")[len(sys.argv) - 1 :]))
    if seeds == 1:
        return walk_one(first, events)
    each, wrong = str(max(1, events // seeds)), 0
    for seed in range(first, first + seeds):
        wrong += (
            subprocess.run([sys.executable, "-m", __spec__.name, each, "1", str(seed)], check=False).returncode != 0
        )
    print(f"{seeds} seeds of {each} events, {wrong} went wrong")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
