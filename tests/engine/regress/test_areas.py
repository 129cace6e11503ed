from __future__ import annotations

import numpy as np

from engine.controls import ALL_CONTROLS
from engine.regress.areas import AREAS, EXTENDED_AREAS
from engine.take import SHAPES


def test_areas_share_no_shape_and_leave_gaze_to_its_own_controls() -> None:
    columns = np.concatenate([area.shape_columns for area in AREAS])
    assert len(set(columns.tolist())) == len(columns)
    assert {SHAPES[at] for at in range(52)} - {SHAPES[at] for at in columns} == {
        n for n in SHAPES if n.startswith("eyeLook")
    }
    gaze = next(area for area in EXTENDED_AREAS if area.name == "gaze")
    assert {SHAPES[at] for at in gaze.shape_columns} == {n for n in SHAPES if n.startswith("eyeLook")}
    assert [area.needs_whole_face for area in AREAS] == [False, True, True]


def test_columns_of_controls_are_those_of_their_names() -> None:
    for area in (*AREAS, *EXTENDED_AREAS):
        assert [ALL_CONTROLS[column].name for column in area.control_columns] == list(area.controls)
        assert len(area.shape_columns) and all(SHAPES[at].startswith(area.prefixes) for at in area.shape_columns)
