"""What the window looks like in its states, beside pictures that a person has looked at.

Renew them after a wanted change, and look at each: RETAKE_RENEW_PICTURES=1 python -m pytest tests/pictures tests/journeys
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.session.commands import VisemesCommand
from app.window.main_window import MainWindow
from engine.project import Media
from engine.speech.lane import attached
from engine.speech.visemes import Cue
from tests.journeys.conftest import no_dialog, settled, window
from tests.pictures.compare import SIZE, looks_as_it_did

__all__ = ["no_dialog", "window"]  # fixtures


def first_minute(opened: MainWindow) -> None:
    opened.session.view.move_playhead(175)


def weights_shown(opened: MainWindow) -> None:
    opened.session.view.expand(0)
    opened.edits.scale_tool()
    opened.session.view.select((60, 100))


def pinning_in_light(opened: MainWindow) -> None:
    opened.actions_by_name["light_theme"].trigger()
    opened.edits.pin_tool()
    opened.session.view.move_playhead(175)


def told_off(opened: MainWindow) -> None:
    opened.notices.tell("take.csv is not a Live Link Face file.", "Export it from the app as CSV.")


def sound_missing(opened: MainWindow) -> None:
    record = Media("audio", "sound/slate.wav", "0" * 64, -0.25)
    opened.session.document.set_marks(opened.session.document.marks.with_medium("audio", record))


def lanes_shown(opened: MainWindow) -> None:
    said = ("sil", "P", "AA1", "F", "AO1", "M", "EH1", "N", "S", "sil", "W", "IY1", "B", "AH0", "K", "sil")
    cues = [Cue(1.0 + 0.22 * index, 1.22 + 0.22 * index, label) for index, label in enumerate(said)]
    opened.session.document.undo.push(
        VisemesCommand.of(opened.session.document, attached(cues, "demo.TextGrid"), "attach demo.TextGrid")
    )
    opened.session.view.set_range(25, 115)
    opened.session.view.move_playhead(88)


def retargeting(opened: MainWindow) -> None:
    opened.retarget.retarget_tool()
    opened.session.view.move_playhead(175)


STATES: tuple[Callable[[MainWindow], None], ...] = (
    first_minute,
    weights_shown,
    pinning_in_light,
    told_off,
    sound_missing,
    lanes_shown,
    retargeting,
)


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.__name__)
def test_a_state_looks_as_it_did(
    qtbot: QtBot, window: MainWindow, state: Callable[[MainWindow], None], tmp_path: Path
) -> None:
    window.resize(*SIZE)
    state(window)
    settled(qtbot, window)
    qtbot.waitUntil(lambda: window.media.reading.idle, timeout=10_000)
    settled(qtbot, window)
    assert looks_as_it_did(window, state.__name__, tmp_path)
