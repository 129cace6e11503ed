from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine.character import bundled
from engine.errors import EditError
from engine.formats.markers.capture import Markers
from engine.jaw import drawable
from engine.spacetime.closure import GAPS, Gaps
from engine.spacetime.layout import standard
from engine.spacetime.source import MARKER_GAPS, Source, bridge, from_markers, from_take, with_gaps
from engine.take import SHAPE_INDEX, Take
from tests.engine.spacetime.captures import apart, captured


def test_head_motion_is_taken_out_and_given_back(played: Source) -> None:
    turned, still = from_markers(captured(played)), from_markers(captured(played, turned=False))
    assert turned.head is not None
    again = turned.head.apply(turned.neutral + turned.displacements)
    assert apart(again, captured(played).positions) < 0.2  # the capture's jitter is smoothed, its motion is not
    assert apart(turned.displacements, still.displacements) < 1e-6
    assert np.abs(turned.take.rotations[:, 0]).max() == pytest.approx(0.3, abs=0.05)


def test_steps_into_a_gap_count_less_the_longer_it_is() -> None:
    motion = np.arange(10.0)[:, None, None] * np.ones((10, 3, 3))
    motion[4, 0] = motion[3:7, 1] = motion[:2, 2] = motion[8:, 2] = np.nan
    filled, confidence = bridge(motion)
    np.testing.assert_allclose(filled[:, :2], np.arange(10.0)[:, None, None] * np.ones((1, 2, 3)))
    np.testing.assert_allclose(confidence[:, 0], [1, 1, 1, 0.25, 0.25, 1, 1, 1, 1])
    np.testing.assert_allclose(confidence[:, 1], [1, 1, 0.04, 0.04, 0.04, 0.04, 0.04, 1, 1])
    np.testing.assert_allclose(confidence[:, 2], [0, 0, 1, 1, 1, 1, 1, 0, 0])


def test_a_neutral_frame_outside_the_capture_is_refused(played: Source) -> None:
    with pytest.raises(EditError, match="Frame 500 is not within the capture"):
        from_markers(captured(played), neutral_frame=500)


def test_a_take_is_what_the_head_s_markers_do_as_it_is_shown(take: Take) -> None:
    wild = replace(take, weights=take.weights * 1.6 - 0.2)
    found, head = from_take(wild, bundled()), bundled()
    for frame in (0, 40, 149):
        posed = head.vertices(wild.weights[frame])
        np.testing.assert_allclose(
            found.neutral + found.displacements[frame], posed[standard(head).vertices], atol=1e-3
        )
    np.testing.assert_array_equal(found.gaps, Gaps(head).sizes(drawable(wild.weights)))
    assert not found.is_capture and len(found) == 150 and found.take is wild
    limited = drawable(wild.weights)
    close, jaw = SHAPE_INDEX["mouthClose"], SHAPE_INDEX["jawOpen"]
    assert limited.min() == 0 and limited.max() == 1 and (limited[:, close] <= limited[:, jaw]).all()


def test_a_part_has_the_frames_of_the_whole(played: Source) -> None:
    capture = from_markers(captured(played))
    for whole in (played, capture):
        part = whole.part(20, 60)
        np.testing.assert_array_equal(part.displacements, whole.displacements[20:60])
        np.testing.assert_array_equal(part.gaps, whole.gaps[20:60])
        np.testing.assert_array_equal(part.take.weights, whole.take.weights[20:60])
        np.testing.assert_array_equal(part.take.rotations, whole.take.rotations[20:60])
        np.testing.assert_array_equal(part.take.lost, whole.take.lost[20:60])
        assert part.take.origin is None and part.is_capture == whole.is_capture == (whole is capture)
    assert capture.head is not None and capture.part(20, 60).head is not None
    np.testing.assert_array_equal(capture.part(20, 60).head.rotations, capture.head.rotations[20:60])


def test_lips_of_a_capture_are_apart_by_more_than_at_rest_and_lids_in_shares_of_it(played: Source) -> None:
    capture = from_markers(captured(played, turned=False))
    names = [gap.name for gap in GAPS]
    columns = {name: at for at, name in enumerate(capture.names)}
    places = capture.neutral + capture.displacements
    for gap, (upper, lower) in MARKER_GAPS.items():
        apart_mm = np.linalg.norm(places[:, columns[upper]] - places[:, columns[lower]], axis=1)
        rest = np.linalg.norm(capture.neutral[columns[upper]] - capture.neutral[columns[lower]])
        expected = np.maximum(apart_mm - rest, 0) if gap == "lips" else 10.0 * apart_mm / rest
        np.testing.assert_allclose(capture.gaps[:, names.index(gap)], expected, atol=1e-9)
    assert np.isnan(capture.gaps[:, [names.index("lips_left"), names.index("lips_right")]]).all()
    renamed = replace(capture, names=tuple(f"m {name}" for name in capture.names))
    assert np.isnan(with_gaps(renamed, {}).gaps).all()
    found = with_gaps(renamed, {f"m {name}": name for name in capture.names})
    np.testing.assert_array_equal(found.gaps, capture.gaps)


def test_angles_of_a_turned_capture_are_about_the_head_s_own_axes(played: Source) -> None:
    markers, turn = captured(played), Rotation.from_euler("y", 90, degrees=True).as_matrix()
    plain = from_markers(markers).take.rotations
    turned = from_markers(replace(markers, positions=markers.positions @ turn.T), turn=turn).take.rotations
    np.testing.assert_allclose(turned[:, :3], plain[:, :3], atol=1e-6)
    assert not plain[:, 3:].any() and plain[:, :3].any()


def test_a_marker_that_was_never_seen_is_held_at_rest_and_not_believed() -> None:
    motion = np.random.default_rng(0).normal(size=(6, 2, 3))
    motion[:, 1] = np.nan
    filled, confidence = bridge(motion)
    np.testing.assert_array_equal(filled[:, 0], motion[:, 0])
    assert not filled[:, 1].any() and not confidence[:, 1].any() and (confidence[:, 0] == 1).all()
    with pytest.raises(EditError, match="Frame -1"):
        from_markers(Markers(np.zeros((3, 2, 3)), ("a", "b"), 30.0), neutral_frame=-1)
