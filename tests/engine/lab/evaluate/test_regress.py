from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from engine.controls import measure
from engine.lab.corpus import Piece
from engine.lab.evaluate import regress, regress_figures
from engine.lab.performer import demo
from engine.lab.performer.corpus import synthetic_performances
from engine.regress.areas import AREAS
from engine.take import SHAPES, Array


@pytest.fixture
def piece() -> Piece:
    return Piece(synthetic_performances(0.2, seed=1)[0], True, "someone")


def test_the_truth_makes_no_error(piece: Piece) -> None:
    figures = regress.figures_of(lambda controls, kept: piece.weights, [piece])
    assert {figures[f"mse_{area.name}"] for area in AREAS} == {0.0}
    assert figures["closure_tpr_mouth"] == figures["closure_tpr_eyes"] == 1.0
    assert figures["closure_fpr_mouth"] == figures["closure_fpr_eyes"] == 0.0


def test_gaze_is_that_of_the_take_and_weights_are_in_range(piece: Piece) -> None:
    made = regress.played(lambda controls, kept: np.full((len(controls), len(SHAPES)), 7.0), piece)
    spoken = np.concatenate([area.shape_columns for area in AREAS])
    others = np.setdiff1d(np.arange(len(SHAPES)), spoken)
    np.testing.assert_array_equal(made[:, others], piece.weights[:, others])
    assert (made[:, spoken] == 1.0).all()


def test_a_take_of_the_mouth_alone_is_measured_on_the_mouth_alone(piece: Piece) -> None:
    mouth = Piece(piece.weights, False, "someone")
    figures = regress.figures_of(lambda controls, kept: np.zeros((len(controls), len(SHAPES))), [mouth])
    assert figures["mse_lower"] > 0
    assert figures["mse_upper"] is figures["mse_eyelids"] is figures["closure_tpr_eyes"] is None


def test_any_folder_of_takes_can_be_measured(tmp_path: Path) -> None:
    shutil.copy(demo.BUNDLED, tmp_path / "someone.csv")
    rows = regress.table(tmp_path, lambda line: None)
    assert {"regressor", "full", "hsk16", "ridge"} <= {row["method"] for row in rows}
    for row in rows:
        assert 0 <= row["mse_lower"] < 0.1 and 0 <= row["closure_tpr_mouth"] <= 1


def test_figures_are_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    shutil.copy(demo.BUNDLED, tmp_path / "someone.csv")
    drawn = regress_figures.draw(tmp_path, tmp_path, lambda line: None)
    assert len(drawn) == 3 and all(path.stat().st_size > 10_000 for path in drawn)


def test_the_full_system_is_told_what_was_recorded_and_never_what_was_meant(piece: Piece) -> None:
    from engine.lab.evaluate.regress_edits import REQUESTS, requested

    known = []

    def method(controls: Array, take: regress.Known) -> Array:
        known.append(take.controls)
        return np.asarray(piece.weights)

    asked, _ = requested(method, REQUESTS["x3"], piece)
    np.testing.assert_array_equal(known[0], measure(piece.weights))
    assert np.abs(asked - known[0]).max() > 1.0


def test_requests_that_fit_no_face_differ_from_what_was_measured(piece: Piece) -> None:
    from engine.lab.evaluate.regress_edits import REQUESTS

    controls = measure(piece.weights)
    for name, ask in REQUESTS.items():
        asked = ask(controls)
        assert asked.shape == controls.shape and (asked >= 0).all()
        assert (np.abs(asked - controls).max() > 1.0) == (name != "none")
