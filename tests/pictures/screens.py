"""Draws the window in its tools on the screen it is run on, dark and light, to be looked at.

Run, for each size: xvfb-run -a -s "-screen 0 1280x720x24" python -m tests.pictures.screens FOLDER
With QT_SCALE_FACTOR=2 on 2560x1440 as on a screen at 200 %.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from PySide6.QtWidgets import QApplication

from app.curves.tools import TOOLS
from app.settings import Settings
from app.window.main_window import MainWindow
from engine.controls import CONTROLS
from engine.formats import read_take
from engine.lab.performer import demo

FRAME, CLOSED_FRAME, PATIENCE_S = 175, 100, 60.0
EYE = next(index for index, control in enumerate(CONTROLS) if control.area == "eyelids")


def states(window: MainWindow) -> Iterator[str]:
    """Bring the window from one state to the next; yields their names."""
    session = window.session
    session.view.move_playhead(FRAME)
    for name in TOOLS:
        window.actions_by_name[f"{name}_tool"].trigger()
        yield name
    window.edits.drag_tool()
    session.view.choose_lane(EYE)
    session.view.expand(EYE)
    yield "expanded"
    session.view.expand(EYE)
    session.view.move_playhead(CLOSED_FRAME)
    window.edits.close_here()
    yield "closed"
    for name in ("Eyes", "Mouth"):
        window.preview.look_from(name)
        yield name.lower()


def settle(window: MainWindow) -> None:
    """Let everything be drawn."""
    end = time.monotonic() + PATIENCE_S
    rests: list[Callable[[], bool]] = [
        lambda: window.inference.idle and window.flagging.idle and not window.status["engine"].text(),
        lambda: window.preview.drawing.idle and not window.preview._still.isActive() and not window.curves.moving,
    ]
    quiet_since = time.monotonic()
    while time.monotonic() < min(end, quiet_since + 0.4):
        QApplication.processEvents()
        if not all(rest() for rest in rests):
            quiet_since = time.monotonic()
        time.sleep(0.005)


def main() -> None:
    """Write a picture of the whole screen for each state and theme."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    application = QApplication(sys.argv[:1])
    application.setStyle("Fusion")
    for theme in ("dark", "light"):
        with tempfile.TemporaryDirectory() as own:
            settings = Settings(Path(own) / "settings.ini")
            settings.theme = theme
            window = MainWindow(read_take(demo.BUNDLED), demo.BUNDLED, settings, unsaved=Path(own) / "unsaved")
            window.show()
            settle(window)
            screen = window.screen()
            size = screen.size() * screen.devicePixelRatio()
            for name in states(window):
                settle(window)
                path = folder / f"{size.width()}x{size.height()}_{theme}_{name}.png"
                screen.grabWindow(0).save(str(path))
            window.session.document.undo.setClean()
            window.close()
            settle(window)


if __name__ == "__main__":
    main()
