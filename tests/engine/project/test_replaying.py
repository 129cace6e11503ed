"""Replaying the edits of a project equals putting them in one after another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from engine import project
from engine.controls import ALL_CONTROLS
from engine.project import Contents


def test_replaying_equals_putting_edits_in_one_after_another(contents: Contents) -> None:
    for position in range(len(contents.edits) + 1):
        state = project.replay(replace(contents, position=position))
        take = contents.original
        asked = np.full((len(take), len(ALL_CONTROLS)), np.nan)
        for index, edit in enumerate(contents.edits):
            np.testing.assert_array_equal(state.before[index][0], take.weights[edit.start : edit.stop])
            np.testing.assert_array_equal(state.before[index][1], asked[edit.start : edit.stop])
            if index == position:
                np.testing.assert_array_equal(state.take.weights, take.weights)
                np.testing.assert_array_equal(state.asked, asked)
            take = take.with_rows(edit.start, edit.weights)
            asked[edit.start : edit.stop] = edit.asked
        if position == len(contents.edits):
            np.testing.assert_array_equal(state.take.weights, take.weights)
