"""A short random walk; the long one is a command: python -m tests.journeys.random_walk"""

from __future__ import annotations

from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.window.main_window import MainWindow
from tests.journeys.walking import Walk, lay_out_files, undisturbed

EVENTS, CHECK_EVERY = 250, 25


@pytest.mark.parametrize("seed", [101, 102])
def test_no_random_event_warns_raises_or_loses_an_edit(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, seed: int
) -> None:
    lay_out_files(tmp_path)
    walk = Walk(window, seed, tmp_path)
    with undisturbed(walk):
        for index in range(EVENTS):  # what a slot raises fails the test by itself
            walk.step()
            if index % CHECK_EVERY == 0:
                walk.check()
        walk.end()
