"""Variants of a fill: shown, kept as one step, and made again to the bit from what a project keeps."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.session import Session
from app.spans.filling import VARIANTS, Filling
from engine.editing import Editor, FillRequest, SmoothRequest, restored
from engine.project import Pin, Span
from engine.take import SHAPES, Take


@pytest.fixture
def session(qtbot: QtBot) -> Session:
    rng = np.random.default_rng(4)
    weights = np.clip(0.2 + np.cumsum(rng.normal(0, 0.01, (150, len(SHAPES))), axis=0), 0, 1)
    return Session(Take(weights, 30.0, name="slow"))


@pytest.fixture
def filling(session: Session) -> Iterator[Filling]:
    made = Filling(session)
    yield made
    made.close()


def made(qtbot: QtBot, filling: Filling) -> None:
    qtbot.waitUntil(lambda: bool(filling.variants) and not filling.busy, timeout=60_000)


def test_a_kept_variant_is_made_again_to_the_bit_from_its_step(
    qtbot: QtBot, session: Session, filling: Filling
) -> None:
    before = session.document.take
    filling.start(Span(40, 70))
    assert filling.busy and not filling.variants
    made(qtbot, filling)
    assert len(filling.variants) == VARIANTS and session.document.draft is filling.variants[0]
    filling.choose(2)
    assert filling.title == "Variant 3 · seed 2" and (filling.first, filling.chosen_seed) == (1, 2)
    filling.accept()
    edit = session.document.contents().edits[-1]
    assert (edit.kind, edit.title, filling.variants, filling.busy) == ("fill", "fill 30 frames", [], False)
    kept = json.loads(json.dumps(dict(edit.inputs)))
    request = restored(kept["request"], kept)
    assert isinstance(request, FillRequest) and request.seed == 2
    again = Editor(before).variants(request, kept["variants"])[0]
    np.testing.assert_array_equal(again.weights, edit.weights)


def test_a_template_gives_the_style_and_the_session_the_rest(qtbot: QtBot, session: Session, filling: Filling) -> None:
    marks, span = session.document.marks, Span(40, 70, region="lower")
    pins = (Pin(50, {"jawOpen": 0.5}, 45, 55), Pin(90, {"jawOpen": 0.5}, 85, 95))
    session.document.set_marks(type(marks)(spans=(Span(20, 30), span), pins=pins))
    filling.start(span, FillRequest((0, 0), style="bridge"))
    made(qtbot, filling)
    assert len(filling.variants) == 1 and filling.title == "A smooth bridge: there is only one"
    filling.accept()
    kept = FillRequest.restored(session.document.contents().edits[-1].inputs)
    assert (kept.frames, kept.region, kept.style, dict(kept.pins)) == (
        (40, 70),
        "lower",
        "bridge",
        {50: {"jawOpen": 0.5}},
    )
    assert kept.besides == kept.unmade == ((20, 30),)


def test_an_edit_that_overtakes_a_fill_ends_it(qtbot: QtBot, session: Session, filling: Filling) -> None:
    filling.start(Span(40, 70))
    patch = Editor(session.document.take).patch(SmoothRequest((80, 90), 4.0))
    rows = slice(patch.start, patch.stop)
    old = session.document
    old.replace_rows(patch.start, patch.weights, old.controls[rows], old.asked[rows], old.take.lost[rows])
    assert not filling.busy
    qtbot.waitUntil(lambda: filling.idle, timeout=60_000)
    assert not filling.variants and session.document.draft is None


def test_discarding_keeps_no_variant(qtbot: QtBot, session: Session, filling: Filling) -> None:
    filling.start(Span(40, 70))
    made(qtbot, filling)
    filling.drop()
    filling.accept()
    assert session.document.draft is None and session.document.undo.count() == 0
