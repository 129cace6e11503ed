from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.errors import EditError
from engine.speech.lane import (
    GROUP_OF,
    GROUPS,
    INSTANT_S,
    LEAST_S,
    VisemeLane,
    attached,
    renamed,
    restored,
    shifted,
    with_boundary,
)
from engine.speech.visemes import NAMES, Cue, class_of, classes_over

LABELS = st.sampled_from(["M", "AA1", "sil", "fv", "T", "", "ɔ"])
CUES = st.lists(
    st.builds(lambda at, lasts, label: Cue(at, at + lasts, label), st.floats(0, 9), st.floats(0, 2), LABELS)
)
LANE = attached([Cue(0.0, 0.5, "M"), Cue(0.5, 0.9, "AA1"), Cue(1.2, 1.5, "F"), Cue(1.5, 1.505, "T")], "a.TextGrid")


def orderly(lane: VisemeLane) -> bool:
    times = lane.times_s
    return bool((times[:, 0] < times[:, 1]).all() and (times[:-1, 1] <= times[1:, 0]).all())


@given(CUES)
def test_whatever_a_file_holds_becomes_cues_in_order(cues: list[Cue]) -> None:
    if not any(cue.stop_s - cue.start_s > INSTANT_S for cue in cues):
        with pytest.raises(EditError, match="no cue"):
            attached(cues, "a")
        return
    lane = attached(cues, "a")
    assert orderly(lane) and lane.cues == lane.originals
    said = [cue for cue in cues if cue.stop_s - cue.start_s > INSTANT_S]
    assert {cue.label for cue in lane.cues} <= {cue.label for cue in said}
    assert lane.times_s[-1, 1] <= max(cue.stop_s for cue in said)


@given(CUES, st.floats(-1, 12), st.floats(-1, 12), st.floats(-3, 3))
def test_a_boundary_goes_where_it_is_dragged_as_far_as_its_neighbours_allow(
    cues: list[Cue], at_s: float, to_s: float, offset_s: float
) -> None:
    cues = [cue for cue in cues if cue.stop_s - cue.start_s > 3 * LEAST_S] or [Cue(0, 1, "M")]
    lane = shifted(attached(cues, "a"), offset_s)
    edge = lane.edge_near(at_s, within_s=1.0)
    nearest = np.abs(lane.times_s.reshape(-1) - at_s).min()
    assert (edge is None) == (nearest > 1.0)
    if edge is None:
        return
    moved = with_boundary(lane, *edge, to_s)
    assert orderly(moved) and len(moved.cues) == len(lane.cues) and moved.originals is lane.originals
    touched = [index for index in edge if index is not None]
    others = [index for index in range(len(lane.cues)) if index not in touched]
    assert all(moved.cues[index] is lane.cues[index] for index in others)
    begin, end = moved.times_s[touched[0], 0], moved.times_s[touched[-1], 1]
    if len(touched) == 2 and begin + LEAST_S < to_s < end - LEAST_S:
        assert moved.times_s[touched[0], 1] == pytest.approx(to_s)


def test_a_shared_boundary_moves_both_and_one_beside_a_pause_moves_one() -> None:
    assert LANE.edge_near(0.51, 0.05) == (0, 1) and LANE.edge_near(0.88, 0.05) == (1, None)
    assert LANE.edge_near(1.19, 0.05) == (None, 2) and LANE.edge_near(1.05, 0.05) is None
    assert with_boundary(LANE, 0, 1, 0.7).cues[:2] == (Cue(0.0, 0.7, "M"), Cue(0.7, 0.9, "AA1"))
    assert with_boundary(LANE, 1, None, 9.0).cues[1].stop_s == 1.2
    assert with_boundary(LANE, None, 2, 0.0).cues[2].start_s == 0.9
    assert with_boundary(LANE, 0, 1, 9.0).cues[1].start_s == pytest.approx(0.9 - LEAST_S)


def test_a_lane_finds_what_is_said_when() -> None:
    late = shifted(LANE, 2.0)
    assert [late.at(time_s) for time_s in (1.9, 2.0, 2.49, 2.5, 3.0, 3.3, 9.0)] == [None, 0, 0, 1, None, 2, None]
    assert late.over(2.5, 3.2) == (Cue(2.5, 2.9, "AA1"),)
    assert late.over(0, 100) == tuple(Cue(c.start_s + 2.0, c.stop_s + 2.0, c.label) for c in LANE.cues)


def test_frames_of_a_cue_are_those_that_a_fill_gives_it() -> None:
    late = shifted(LANE, 0.123)
    classes = classes_over(late.over(-1, 9), frames=60, fps=30.0)
    for index in range(3):
        start, stop = late.frames_of(index, 30.0)
        assert (classes[start:stop] == class_of(LANE.cues[index].label)).all()
    assert late.frames_of(3, 30.0)[1] - late.frames_of(3, 30.0)[0] == 1


def test_names_are_checked_and_the_originals_come_back() -> None:
    said = renamed(LANE, 1, " uw ")
    assert said.cues[1].label == "uw" and restored(said).cues == LANE.cues
    with pytest.raises(EditError, match="no viseme"):
        renamed(LANE, 1, "quux")
    with pytest.raises(EditError):
        attached([Cue(0, 1, "quux")], "a")
    with pytest.raises(EditError):
        shifted(LANE, float("nan"))


def test_each_class_has_one_colour() -> None:
    assert sorted(name for names in GROUPS.values() for name in names) == sorted(NAMES)
    assert [list(GROUPS.values())[group].count(name) for group, name in zip(GROUP_OF, NAMES, strict=True)] == [1] * 18
