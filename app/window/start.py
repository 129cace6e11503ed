"""Starting the window."""

from __future__ import annotations

import logging
import os
import sys
from pathlib import Path
from types import TracebackType

from app.printing import remark
from engine.assets import DEMO_TAKE
from engine.errors import EngineError
from engine.formats import read_take

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")


def start(path: Path | None) -> int:
    """Open a take, or the bundled one, in a window; returns when it is closed."""
    if sys.platform == "linux" and not any(os.environ.get(name) for name in DISPLAYS):
        remark("There is no display to open the window on. The commands work without: retake --help.")
        return 2
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from app.settings import start_log
    from app.window.main_window import MainWindow

    start_log()
    application = QApplication(sys.argv[:1])
    application.setApplicationName("Retake")
    application.setStyle("Fusion")  # the style sheet is drawn over it, alike on every desktop
    window = MainWindow(read_take(DEMO_TAKE), DEMO_TAKE)
    _report_to(window)
    if path is not None:
        window.files.opener.opening.failed.connect(lambda *_: _tell_what_is_open(window))
        window.load(path)
    window.show()
    QTimer.singleShot(0, window.files.offer_left_over)
    return application.exec()


def _tell_what_is_open(window) -> None:  # type: ignore[no-untyped-def]
    if window.session.document.path == DEMO_TAKE:
        window.notices.add("The demo take is open instead.")


def _report_to(window) -> None:  # type: ignore[no-untyped-def]
    """Write uncaught errors to the log and show one sentence; the work stays open."""

    def report(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        logging.getLogger("app").error("uncaught", exc_info=(kind, error, trace))
        if isinstance(error, EngineError):
            window.notices.warn(error.sentence, error.advice)
        else:
            window.notices.warn("Something went wrong; your take is as it was.", "Help > About says where the log is.")

    sys.excepthook = report
