from __future__ import annotations

import numpy as np

from app.session.curve_table import CURVES, FIRST_WEIGHT, weights_under
from engine.controls import ALL_CONTROLS
from engine.extended import bundled_face
from engine.take import SHAPES


def test_lanes_are_the_controls_then_the_weights() -> None:
    assert [curve.title for curve in CURVES] == [*(control.title for control in ALL_CONTROLS), *SHAPES]
    assert [curve.column for curve in CURVES] == [*range(len(ALL_CONTROLS)), *range(len(SHAPES))]
    assert [curve.is_weight for curve in CURVES] == [lane >= FIRST_WEIGHT for lane in range(len(CURVES))]


def test_distances_are_no_less_than_nothing_signed_ones_any_way_and_weights_up_to_one() -> None:
    for curve in CURVES[:FIRST_WEIGHT]:
        assert curve.lowest == (-1000.0 if ALL_CONTROLS[curve.column].signed else 0.0) and curve.highest == np.inf
        assert curve.shown(1.25) == f"1.2 {curve.unit}"
    for curve in CURVES[FIRST_WEIGHT:]:
        assert (curve.lowest, curve.highest, curve.shown(0.256)) == (0.0, 1.0, "0.26")


def test_under_a_control_stand_the_weights_that_move_it_those_that_move_it_most_first() -> None:
    rest = np.zeros((1, len(SHAPES)))
    rest[0, SHAPES.index("jawOpen")] = 0.2
    for control in range(len(ALL_CONTROLS)):
        under = [lane - FIRST_WEIGHT for lane in weights_under(control)]
        slopes = []
        for shape in range(len(SHAPES)):
            moved = rest.copy()
            moved[0, shape] += 1e-4
            slopes.append(abs((bundled_face().measure(moved) - bundled_face().measure(rest))[0, control]) / 1e-4)
        for shape, slope in enumerate(slopes):
            if abs(slope - 0.75) > 0.1:
                assert (shape in under) == (slope > 0.75), (ALL_CONTROLS[control].name, SHAPES[shape])
        found = np.array([slopes[shape] for shape in under])
        assert (np.diff(found) < 0.1).all()
