"""Thousands of redraws and edits in one window: memory must not grow, references to None must not leak away.

Run: QT_QPA_PLATFORM=offscreen python -m tests.performance.soak [redraws] [edits]
"""

from __future__ import annotations

import gc
import resource
import sys
import threading

from PySide6.QtCore import QEventLoop
from PySide6.QtWidgets import QApplication

from app.window.main_window import MainWindow
from engine.lab.performer import demo

ALLOWED_MB = 30.0


def resident_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def main() -> int:
    redraws, edits = (int(argument) for argument in (sys.argv[1:3] or ("2000", "1000")))
    application = QApplication(["soak"])
    window = MainWindow(demo.performance())
    window.show()
    loop = QEventLoop()
    window.inference.ready.connect(loop.quit)
    loop.exec()
    session = window.session
    before_mb, before_none = 0.0, 0
    for index in range(redraws):
        session.view.set_range(index % 50, index % 50 + 200)
        session.view.move_playhead(index % len(session.document.take))
        window.curves.viewport().repaint()
        application.processEvents()
        if index == redraws // 10:
            before_mb, before_none = resident_mb(), sys.getrefcount(None)
    for index in range(edits):
        asked = session.document.controls[100:130].copy()
        asked[:, 0] += 0.5 + index % 5
        steps = session.document.undo.index()
        window.inference.ask(100, asked)
        window.inference.finish("edit")
        while session.document.undo.index() == steps:
            application.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)
        session.document.undo.undo()
    gc.collect()
    grown, fallen = resident_mb() - before_mb, before_none - sys.getrefcount(None)
    window.close()
    window.deleteLater()
    application.processEvents()
    threads = [thread.name for thread in threading.enumerate() if thread is not threading.main_thread()]
    print(f"resident memory grew by {grown:.1f} MB; references to None fell by {fallen}; threads left: {threads}")
    return int(grown > ALLOWED_MB or fallen > 100)


if __name__ == "__main__":
    sys.exit(main())
