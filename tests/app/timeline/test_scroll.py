from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.timeline.scroll import TimeScroll
from engine.take import SHAPES, Take


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    return Session(Take(np.zeros((300, len(SHAPES))), 10.0))


@pytest.fixture
def scroll(qtbot: QtBot, session: Session) -> TimeScroll:
    bar = TimeScroll(session)
    qtbot.addWidget(bar)
    return bar


def test_the_bar_is_where_the_view_is(session: Session, scroll: TimeScroll) -> None:
    session.view.set_range(30.4, 130.9)
    assert (scroll.minimum(), scroll.maximum(), scroll.value()) == (0, 299 - 100, 30)
    assert (scroll.pageStep(), scroll.singleStep()) == (100, 5)
    assert session.view.range == (30.4, 130.9)  # the bar's whole frames do not come back


def test_the_view_goes_where_the_bar_is_and_stays_as_wide(session: Session, scroll: TimeScroll) -> None:
    session.view.set_range(30.4, 130.9)
    scroll.setValue(50)
    assert session.view.range == (50.0, pytest.approx(150.5))
    scroll.setValue(scroll.maximum())
    assert session.view.range[1] == pytest.approx(299)


def test_another_take_has_another_length(session: Session, scroll: TimeScroll) -> None:
    session.open(Take(np.zeros((20, len(SHAPES))), 10.0), None)
    assert (scroll.maximum(), scroll.value(), scroll.singleStep()) == (0, 0, 1)
