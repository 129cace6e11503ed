"""Ten thousand random events over twenty seeds: no Qt warning, no exception, no stall, no lost edit, memory flat.

Run: QT_QPA_PLATFORM=offscreen nice python -m tests.journeys.random_walk [events] [seeds] [first seed]
"""

from __future__ import annotations

import gc
import sys
import tempfile
import traceback
from pathlib import Path

import numpy as np
from PySide6.QtWidgets import QApplication

from app.settings import Settings
from app.window.main_window import MainWindow
from engine.formats import read_take
from engine.performance import demo
from tests.journeys.walking import Walk, lay_out_files, undisturbed
from tests.performance.soak import resident_mb

STALL_MS = 200.0
CHECK_EVERY = 50  # events


def walk(seed: int, events: int, raised: list[str]) -> Walk:
    """Walk one seed from a fresh window to its end."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lay_out_files(folder)
        settings = Settings(folder / "settings.ini")
        window = MainWindow(read_take(demo.BUNDLED), demo.BUNDLED, settings, unsaved=folder / "unsaved")
        walker = Walk(window, seed, folder)
        ready: list[bool] = []
        window.inference.ready.connect(lambda: ready.append(True))
        with undisturbed(walker):
            window.show()
            walker._wait(lambda: bool(ready))
            for index in range(events):
                walker.step()
                assert not raised, (raised, walker.done[-20:])
                if index % CHECK_EVERY == 0:
                    walker.check()
            walker.end()
        window.deleteLater()
        QApplication.processEvents()
        return walker


def main() -> int:
    """Walk, and say what came of it."""
    events, seeds, first = (int(each) for each in (*sys.argv[1:4], *("10000", "20", "0")[len(sys.argv) - 1 :]))
    application = QApplication(["walk"])
    application.setStyle("Fusion")
    raised: list[str] = []
    sys.excepthook = lambda *error: raised.append("".join(traceback.format_exception(*error)))
    each, failed, memory_mb = max(1, events // seeds), 0, list[float]()
    for seed in range(first, first + seeds):
        try:
            walker = walk(seed, each, raised)
        except AssertionError as error:
            print(f"seed {seed}: {error}", flush=True)
            failed += 1
            raised.clear()
            continue
        gc.collect()
        memory_mb.append(resident_mb())
        wall, own = np.array(walker.spent_ms).T
        slow = [f"{walker.done[at]} {own[at]:.0f}" for at in np.flatnonzero(own > STALL_MS)]
        print(
            f"seed {seed}: {each} events, {memory_mb[-1]:.0f} MB; of the window's thread p99 {np.quantile(own, 0.99):.0f} ms,"
            f" most {own.max():.0f} ms (by the clock {wall.max():.0f} ms); stalls: {'; '.join(slow) or 'none'}",
            flush=True,
        )
        failed += bool(slow)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
