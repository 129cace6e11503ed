from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.controls import ALL_INDEX
from engine.extended import bundled_face
from engine.lab.corpus import Piece, data_folder, split
from engine.lab.evaluate.edits import table as edits
from engine.lab.evaluate.edits.catalogue import KINDS, PLACES, ROOM, SPEAKS_OF, Scripted, scripted
from engine.lab.performer.corpus import synthetic_performances


@pytest.fixture(scope="module")
def pieces() -> list[Piece]:
    return [Piece(weights, True, "someone") for weights in synthetic_performances(0.5, seed=1)]


@pytest.fixture(scope="module")
def catalogue(pieces: list[Piece]) -> list[Scripted]:
    return scripted(pieces)


def test_there_are_places_for_every_edit_on_the_test_takes(real_take_path: Path) -> None:
    assert len(KINDS) * PLACES == 150
    assert len(scripted(split(data_folder())[2])) == 150


def test_every_edit_asks_for_a_change_where_it_says_and_nowhere_else(catalogue: list[Scripted]) -> None:
    assert len({kind.name for kind in KINDS}) == len(KINDS)
    for edit in catalogue:
        start, stop = edit.frames
        assert start >= ROOM and stop <= len(edit.asked) - ROOM
        columns = [ALL_INDEX[name] for name in edit.kind.wanted]
        asked = ~np.isnan(edit.asked)
        assert asked[start:stop][:, columns].all()
        assert not np.delete(asked, columns, axis=1).any() and not asked[: start - ROOM].any()
        assert np.abs(edit.asked - bundled_face().measure(edit.piece.weights))[start:stop][:, columns].max() > 0.2


def test_the_same_takes_give_the_same_edits(pieces: list[Piece], catalogue: list[Scripted]) -> None:
    again = scripted(pieces)
    assert [(edit.kind.name, edit.frames) for edit in again] == [(edit.kind.name, edit.frames) for edit in catalogue]


def test_an_edit_that_did_nothing_reached_nothing_and_moved_nothing(catalogue: list[Scripted]) -> None:
    edit = catalogue[0]
    figures = edits._figures(edits.Made(edit, edit.piece.weights, (1.0,)), {})
    assert figures["reached"] == pytest.approx(0.0, abs=1e-9)
    assert figures["beside_weight"] == figures["beside_mm"] == figures["impossible"] == 0.0
    assert figures["step_mm"] == figures["step_before_mm"]


def test_what_moves_beside_an_edit_is_counted(catalogue: list[Scripted]) -> None:
    edit = catalogue[0]
    weights = np.array(edit.piece.weights)
    weights[:, ~SPEAKS_OF[edit.kind.part]] += 0.1
    figures = edits._figures(edits.Made(edit, weights, (1.0,)), {})
    assert figures["beside_weight"] == pytest.approx(0.1) and figures["beside_mm"] > 0.1


def test_an_edit_made_in_every_way_is_near_what_was_asked_where_that_is_exact(catalogue: list[Scripted]) -> None:
    edit = next(edit for edit in catalogue if edit.kind.name == "smile while speaking")
    missed = {name: edits._reached(edits.make(edit, mode))["missed_mm"] for name, mode in edits.MODES.items()}
    assert missed["exact"] <= missed["default"] <= missed["as recorded"] and missed["exact"] < 0.1
