"""Draws the picture of the README: the bundled demo take, mid-drag.  python -m tests.pictures.readme"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.settings import Settings
from app.window.main_window import MainWindow
from engine.controls import CONTROL_INDEX
from engine.formats import read_take
from engine.lab.performer import demo

PICTURE = Path(__file__).parents[2] / "assets" / "pictures" / "window.png"
SIZE, FRAME, BY_MM, STEPS, STEP_MS = (1440, 900), 88, -7.0, 24, 80
LANE = CONTROL_INDEX["lips_vertical"]


def script(window: MainWindow, path: Path) -> Iterator[Callable[[], bool]]:
    """Do one step after the other; each yields what to wait for."""
    session, area = window.session, window.curves.viewport()
    plain, left = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton

    def still() -> bool:
        drawn = window.preview.drawing.idle and not window.preview._still.isActive()
        return window.inference.idle and drawn and window.flagging.idle

    yield lambda: still() and not window.status["engine"].text()
    window.preview.show_view("Split")
    session.view.set_range(20, 236)
    session.view.move_playhead(FRAME)
    yield still
    lane = window.curves.lane(LANE)
    start = window.curves.mapFromScene(lane.x_of(FRAME), lane.y_of(float(session.document.controls[FRAME, LANE])))
    pixels = lane.y_of(BY_MM) - lane.y_of(0.0)
    QTest.mouseMove(area, start)
    QTest.mousePress(area, left, plain, start)
    for step in range(1, STEPS + 1):
        at = start + QPoint(0, round(pixels * step / STEPS))
        QTest.mouseMove(area, at)
        yield still
    window.status["speed"].clear()  # of the machine that drew it, not of the reader's
    window.grab().save(str(path))
    window.actions_by_name["cancel"].trigger()  # nothing was changed, so closing asks nothing
    QTest.mouseRelease(area, left, plain, at)
    yield still


def main() -> None:
    """Write the picture, or to the path that is given."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE
    application = QApplication(sys.argv[:1])
    application.setStyle("Fusion")
    folder = Path(tempfile.mkdtemp())
    window = MainWindow(read_take(demo.BUNDLED), demo.BUNDLED, Settings(folder / "s.ini"), unsaved=folder / "unsaved")
    window.resize(*SIZE)
    window.show()
    steps = script(window, path)
    waiting = [next(steps)]

    def on() -> None:
        if waiting[0]():
            try:
                waiting[0] = next(steps)
            except StopIteration:
                timer.stop()
                window.close()

    timer = QTimer(interval=STEP_MS, timeout=on)
    timer.start()
    application.exec()


if __name__ == "__main__":
    main()
