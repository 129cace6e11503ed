from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QFileDialog, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.retarget.actions import RetargetActions
from app.session import Session
from engine.character import Character, bundled, load, save
from engine.formats import read_take
from engine.lab.performer import demo
from engine.take import Take


@pytest.fixture(scope="session")
def other_head(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A broader head, with shapes that reach less far."""
    path = tmp_path_factory.mktemp("heads") / "broad.npz"
    head = bundled()
    stretch = np.array([1.25, 0.95, 1.1], np.float32)
    save(replace(head, neutral=head.neutral * stretch, deltas=0.8 * head.deltas * stretch), path)
    return path


@pytest.fixture(scope="session")
def other_character(other_head: Path) -> Character:
    return load(other_head)


@pytest.fixture
def short_take() -> Take:
    """Two seconds of the demo take."""
    take = read_take(demo.BUNDLED)
    return Take(take.weights[60:120], take.fps, name="short.csv")


@pytest.fixture
def retarget(qtbot: QtBot, short_take: Take) -> Iterator[RetargetActions]:
    """The panel on a short take, its sections on screen, the tool at work."""
    session, box = Session(short_take), QWidget()
    actions = RetargetActions(session, box)
    column = QVBoxLayout(box)
    for section in actions.sections:
        column.addWidget(section)
    actions.retargeting.choosing.capture_opened.connect(lambda take: session.open(take, None))
    qtbot.addWidget(box)
    box.show()
    actions.retarget_tool()
    yield actions
    actions.retargeting.close()


@pytest.fixture
def choose_file(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Files that the next dialogs come back with."""
    files: list[Path] = []

    def answer(*_: object) -> tuple[str, str]:
        return str(files.pop(0)), ""

    monkeypatch.setattr(QFileDialog, "getOpenFileName", answer)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", answer)
    return files
