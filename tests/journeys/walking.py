"""A random walk through the window: real events on whatever is there, and what must hold after each of them."""

from __future__ import annotations

import logging
import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest import mock

import numpy as np
from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt, QtMsgType, QUrl, qInstallMessageHandler
from PySide6.QtGui import QDropEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QFileDialog,
    QInputDialog,
    QMenu,
    QMessageBox,
    QSplitter,
    QWidget,
)
from shiboken6 import isValid

from app.actions.table import ACTIONS
from app.curves.tools import TOOLS
from app.settings import PRESETS
from app.window.main_window import MainWindow
from engine.project import replay
from tests.performance.kills import content_of, fingerprint

Answer = QMessageBox.StandardButton
BUTTONS = (Qt.MouseButton.LeftButton,) * 6 + (Qt.MouseButton.RightButton, Qt.MouseButton.MiddleButton)
MODIFIERS = (Qt.KeyboardModifier.NoModifier,) * 6 + (
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)
LEAVE = {"quit"}  # the walk would be over
PATIENCE_S = 240.0
HARMLESS = ("This plugin does not support",)


class Walk:
    """Does one random thing after another.

    Attributes
    ----------
    steps : how many undo steps there were at the end
    done : what was done, for whoever has to find out why
    warnings : of Qt, and what went wrong on other threads
    spent_ms : of each event, how long it took with all that came of it: by the clock, and of the window's own thread
    """

    def __init__(self, window: MainWindow, seed: int, folder: Path) -> None:
        self.window, self.folder, self.rng = window, folder, random.Random(seed)
        self.done: list[str] = []
        self.warnings: list[str] = []
        self.spent_ms: list[tuple[float, float]] = []
        self._pressed: tuple[QWidget, Qt.MouseButton] | None = None
        self._awaited: Callable[[], bool] | None = None  # what has to come of an event, and takes its time
        self._names = self.steps = 0
        self._kinds: list[tuple[Callable[[], str], int]] = [
            (self._press, 14),
            (self._move, 30),
            (self._release, 20),
            (self._click, 10),
            (self._pull, 8),
            (self._key, 12),
            (self._letter, 3),
            (self._action, 8),
            (self._wheel, 12),
            (self._resize, 3),
            (self._split, 2),
            (self._tool, 5),
            (self._drop, 1),
            (self._tab, 2),
            (self._preset, 1),
        ]

    def step(self) -> None:
        """Do one thing, and what comes of it."""
        if self._pressed is not None and self.rng.random() < 0.75:
            kind = self._move if self.rng.random() < 0.8 else self._release
        else:
            kinds, weights = zip(*self._kinds, strict=True)
            kind = self.rng.choices(kinds, weights)[0]
        began, worked = time.perf_counter(), time.thread_time()
        what = kind()
        QApplication.processEvents()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)  # as the event loop would
        self.spent_ms.append((1e3 * (time.perf_counter() - began), 1e3 * (time.thread_time() - worked)))
        self.done.append(what)
        if self._awaited is not None:
            self.wait(self._awaited)
            self._awaited = None
        self._put_away()

    def check(self) -> None:
        """Check that nothing is lost: what is on the screen is what the steps come to, and a release ends a gesture."""
        session = self.window.session
        if self._pressed is None:
            assert not self.window.curves.tool.busy, self.done[-20:]
        state = replay(session.document.contents())
        np.testing.assert_array_equal(state.take.weights, session.document.take.weights)
        assert not self.warnings, (self.warnings, self.done[-20:])

    def end(self) -> None:
        """Let go, save, and check that the file holds every step."""
        if self._pressed is not None:
            self._release()
        self.wait(lambda: self.window.inference.idle and self.window.files.opener.opening.path is None)
        self.check()
        path = self.folder / "walked.retake"
        self.steps = self.window.session.document.undo.count()
        expected = fingerprint(self.window.session.document.contents())
        saved: list[object] = []
        self.window.keeper.saved.connect(saved.append)
        self.window.keeper.save_as(path)
        self.wait(lambda: bool(saved))
        assert fingerprint(self.window.session.document.contents()) == expected
        self.window.session.document.undo.setClean()
        self.window.close()
        self.wait(lambda: not self.window.isVisible())
        assert content_of(path) == expected

    def wait(self, until: Callable[[], bool]) -> None:
        """Go on when something has come, and fail when it does not come."""
        end = time.perf_counter() + PATIENCE_S
        while not until():
            assert time.perf_counter() < end, self.done[-20:]
            QApplication.processEvents()
            time.sleep(0.002)
        QApplication.processEvents()

    def _put_away(self) -> None:
        """Close what opened in front of the window."""
        for _ in range(3):
            popup = QApplication.activePopupWidget()
            if popup is None:
                break
            popup.close()
        for top in QApplication.topLevelWidgets():
            if top is not self.window and top.isVisible() and self.rng.random() < 0.5:
                top.close()

    # --- the mouse

    def _somewhere(self) -> tuple[QWidget, QPoint]:
        window = self.window
        areas: list[QWidget] = [window.curves.viewport()] * 8 + [window.timeline] * 4 + [window.preview.face] * 2
        areas += [window.inspector] * 5 + [window.centralWidget()]
        area = self.rng.choice([each for each in areas if each.isVisible()] or [window])
        place = QPoint(self.rng.randrange(max(1, area.width())), self.rng.randrange(max(1, area.height())))
        inner = area.childAt(place)
        return (area, place) if inner is None else (inner, inner.mapFrom(area, place))

    def _press(self) -> str:
        if self._pressed is not None:
            return self._move()
        widget, at = self._somewhere()
        button = self.rng.choice(BUTTONS)
        QTest.mousePress(widget, button, self.rng.choice(MODIFIERS), at)
        self._pressed = (widget, button)
        return f"press {button.name} on {type(widget).__name__} at {at.toTuple()}"

    def _move(self) -> str:
        widget, at = self._somewhere()
        if self._pressed is not None:
            held, button = self._pressed
            if not isValid(held) or not held.isVisible():  # a list that is renewed deletes what is in it
                return self._release()
            at = QPoint(self.rng.randrange(-30, held.width() + 30), self.rng.randrange(-30, held.height() + 30))
            _drag_to(held, at, button, self.rng.choice(MODIFIERS))
            return f"drag to {at.toTuple()}"
        QTest.mouseMove(widget, at)
        return f"move to {at.toTuple()}"

    def _release(self) -> str:
        if self._pressed is None:
            return self._click()
        (widget, button), self._pressed = self._pressed, None
        if not isValid(widget):
            return "let go of a widget that is gone"
        at = QPoint(self.rng.randrange(max(1, widget.width())), self.rng.randrange(max(1, widget.height())))
        tool, inference, session = self.window.curves.tool, self.window.inference, self.window.session
        drawn = tool.busy and button == Qt.MouseButton.LeftButton and inference.busy
        step, kind = session.document.undo.index(), type(tool).__name__
        QTest.mouseRelease(widget, button, Qt.KeyboardModifier.NoModifier, at)
        if drawn and kind in ("DragTool", "DrawTool") and widget is self.window.curves.viewport():
            refused: list[str] = []
            inference.failed.connect(lambda sentence, _: refused.append(sentence))
            self._awaited = lambda: session.document.undo.index() == step + 1 or bool(refused)
        return f"release {button.name}"

    def _pull(self) -> str:
        """Drag or sketch a curve, from the press to the release."""
        if self._pressed is not None:
            return self._release()
        name = self.rng.choice(("drag", "draw"))
        self.window.actions_by_name[f"{name}_tool"].trigger()
        curves, area = self.window.curves, self.window.curves.viewport()
        box = curves.lane(self.rng.choice(self.window.session.view.lanes)).scene_box()
        points = [
            curves.mapFromScene(
                box.left() + self.rng.random() * box.width(), box.top() + self.rng.uniform(-0.2, 1.2) * box.height()
            )
            for _ in range(4)
        ]
        QTest.mousePress(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, points[0])
        self._pressed = (area, Qt.MouseButton.LeftButton)
        for point in points:
            _drag_to(area, point, Qt.MouseButton.LeftButton, self.rng.choice(MODIFIERS))
        self._release()
        return f"{name} {[point.toTuple() for point in points]}"

    def _click(self) -> str:
        widget, at = self._somewhere()
        double = self.rng.random() < 0.2
        button, modifier = self.rng.choice(BUTTONS), self.rng.choice(MODIFIERS)
        (QTest.mouseDClick if double else QTest.mouseClick)(widget, button, modifier, at)
        return f"{'double-' if double else ''}click {button.name} on {type(widget).__name__} at {at.toTuple()}"

    def _wheel(self) -> str:
        widget, at = self._somewhere()
        turn = QPoint(0, self.rng.choice((-240, -120, 120, 240)))
        if self.rng.random() < 0.2:
            turn = turn.transposed()
        held = self._pressed[1] if self._pressed is not None else Qt.MouseButton.NoButton
        event = QWheelEvent(
            QPointF(at),
            QPointF(widget.mapToGlobal(at)),
            QPoint(),
            turn,
            held,
            self.rng.choice(MODIFIERS),
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(widget, event)
        return f"wheel {turn.toTuple()} on {type(widget).__name__}"

    # --- keys and commands

    def _key(self) -> str:
        entry = self.rng.choice([each for each in ACTIONS if each.name not in LEAVE])
        keys = self.window.actions_by_name[entry.name].shortcuts()
        if not keys:
            return self._action()
        combination = self.rng.choice(keys)[0]
        QTest.keyClick(QApplication.focusWidget() or self.window, combination.key(), combination.keyboardModifiers())
        return f"key {combination.key().name}"

    def _letter(self) -> str:
        letter = self.rng.choice("abkn019.-+/ ")
        QTest.keyClicks(QApplication.focusWidget() or self.window, letter)
        return f"letter {letter!r}"

    def _tab(self) -> str:
        key = self.rng.choice((Qt.Key.Key_Tab, Qt.Key.Key_Backtab, Qt.Key.Key_Escape))
        QTest.keyClick(QApplication.focusWidget() or self.window, key)
        return key.name

    def _action(self) -> str:
        name = self.rng.choice([each.name for each in ACTIONS if each.name not in LEAVE])
        self.window.actions_by_name[name].trigger()
        return f"action {name}"

    def _tool(self) -> str:
        name = self.rng.choice(list(TOOLS))
        self.window.actions_by_name[f"{name}_tool"].trigger()
        return f"tool {name}"

    def _preset(self) -> str:
        name = self.rng.choice(list(PRESETS))
        self.window.menus.use_preset(name)
        return f"keys of {name}"

    # --- the window

    def _resize(self) -> str:
        size = self.rng.randint(900, 1900), self.rng.randint(400, 1100)
        self.window.resize(*size)
        return f"resize {size}"

    def _split(self) -> str:
        split = self.rng.choice(self.window.findChildren(QSplitter))
        split.setSizes([self.rng.randint(0, 900) for _ in range(split.count())])
        return "split"

    def _drop(self) -> str:
        path = self.rng.choice(sorted(self.folder.glob("drop*")))
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(path))])
        at = QPointF(self.rng.randrange(self.window.width()), self.rng.randrange(self.window.height()))
        event = QDropEvent(
            at,
            Qt.DropAction.CopyAction,
            data,
            Qt.MouseButton.NoButton,
            Qt.KeyboardModifier.NoModifier,
            QEvent.Type.Drop,
        )
        QApplication.sendEvent(self.window, event)
        return f"drop {path.name}"

    # --- what dialogs would ask

    def file_name(self) -> str:
        """Return what the user chooses in a file dialog: mostly nothing."""
        if self.rng.random() < 0.6:
            return ""
        self._names += 1
        return str(self.folder / f"chosen{self._names % 5}.retake")

    def answer(self) -> QMessageBox.StandardButton:
        """Return what the user answers."""
        return self.rng.choice((Answer.Cancel, Answer.Cancel, Answer.Save, Answer.Discard))


def _drag_to(widget: QWidget, at: QPoint, button: Qt.MouseButton, modifier: Qt.KeyboardModifier) -> None:
    """Send a move with a button held, which QTest cannot."""
    from PySide6.QtGui import QMouseEvent

    event = QMouseEvent(
        QEvent.Type.MouseMove, QPointF(at), QPointF(widget.mapToGlobal(at)), Qt.MouseButton.NoButton, button, modifier
    )
    QApplication.sendEvent(widget, event)


@contextmanager
def undisturbed(walk: Walk) -> Iterator[None]:
    """Answer dialogs as the walk says, and collect Qt's warnings."""

    def listen(kind: QtMsgType, _: object, text: str) -> None:
        if kind != QtMsgType.QtDebugMsg and not any(known in text for known in HARMLESS):
            walk.warnings.append(text)

    class Failures(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            walk.warnings.append(self.format(record))

    failures, jobs = Failures(logging.ERROR), logging.getLogger("app.background")  # which else only tells the user
    jobs.addHandler(failures)
    before = qInstallMessageHandler(listen)
    fakes = {
        (QFileDialog, "getOpenFileName"): lambda *_, **__: ("", ""),
        (QFileDialog, "getExistingDirectory"): lambda *_, **__: "",
        (QFileDialog, "getSaveFileName"): lambda *_, **__: (walk.file_name(), ""),
        (QMessageBox, "question"): lambda *_, **__: walk.answer(),
        (QMessageBox, "about"): lambda *_, **__: None,
        (QMessageBox, "exec"): lambda *_, **__: Answer.Cancel,
        (QMenu, "exec"): lambda *_, **__: None,
    } | {(QInputDialog, name): lambda *_, **__: ("", False) for name in ("getText", "getItem", "getDouble", "getInt")}
    patches = [mock.patch.object(owner, name, fake) for (owner, name), fake in fakes.items()]
    for patch in patches:
        patch.start()
    try:
        yield
    finally:
        for patch in patches:
            patch.stop()
        qInstallMessageHandler(before)
        jobs.removeHandler(failures)


def lay_out_files(folder: Path) -> None:
    """Write what may be dropped: takes, rubbish and nothing."""
    from engine.formats import write_take
    from engine.lab.performer import demo
    from engine.take import SHAPES, Take

    write_take(demo.performance(), folder / "drop_take.csv")
    rng = np.random.default_rng(1)
    write_take(Take(weights=rng.random((3, len(SHAPES))), fps=60.0, name="short"), folder / "drop_short.csv")
    (folder / "drop_rubbish.csv").write_bytes(b"\x00\xff,not a take\n1,2")
    (folder / "drop_nothing.retake").write_bytes(b"")
    (folder / "drop_sound.wav").write_bytes(b"RIFF")
