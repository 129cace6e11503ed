from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.character import Character, bundled
from engine.framing import framed, share_seen
from engine.take import SHAPES

# Two lids 20 mm apart about the origin, a chin below and a crown above them.
LANDMARKS = {"lid_upper_left": 0, "lid_upper_right": 1, "chin": 2}
HEAD = np.array([[10.0, 0, 0], [-10, 0, 0], [0, -40, 5], [0, 60, 0], [40, 0, -60]])


def character(
    *more: tuple[float, float, float], landmarks: dict[str, int] = LANDMARKS, moving: tuple[int, ...] = (2,)
) -> Character:
    points = np.concatenate([HEAD, np.array(more).reshape(-1, 3)]).astype(np.float32)
    deltas = np.zeros((len(SHAPES), len(points), 3), np.float32)
    deltas[3, list(moving), 1] = -1.0
    return Character(points, np.array([[0, 1, 2]], np.int32), deltas, np.zeros((len(points), 3), np.uint8), landmarks)


def test_a_head_is_framed_from_a_little_under_the_chin_to_the_crown() -> None:
    low, high = framed(character())
    np.testing.assert_array_equal(low, [-10, -40, -60])
    np.testing.assert_array_equal(high, [40, 60, 5])


@pytest.mark.parametrize(
    ("point", "inside"),
    [
        ((47, 0, 0), True), ((49, 0, 0), False), ((-47, 0, 0), True), ((-49, 0, 0), False),
        ((0, 63, 0), True), ((0, 65, 0), False),
        ((0, 0, -89), True), ((0, 0, -91), False), ((0, 0, 39), True), ((0, 0, 41), False),
        ((0, -59, 0), True), ((0, -61, 0), False),
    ],
)  # fmt: skip
def test_what_is_too_far_from_the_eyes_or_below_the_chin_is_no_head(point: tuple[float, ...], inside: bool) -> None:
    plain, with_it = framed(character()), framed(character(point))
    grown = any((now != before).any() for now, before in zip(with_it, plain, strict=True))
    assert grown == inside


@pytest.mark.parametrize(("below", "fits"), [(9.0, False), (11.0, True), (79.0, True), (81.0, False)])
def test_a_chin_too_near_the_eyes_or_too_far_is_none(below: float, fits: bool) -> None:
    head = character((0, -70, 0))
    points = head.neutral.copy()
    points[2, 1] = -below
    low, _ = framed(replace(head, neutral=points))
    cut = -below - 0.2 * (60 + below)
    assert low[1] == (min(-below, -70 if cut <= -70 else 0) if fits else min(-70, -below))


def test_without_lids_or_landmarks_all_is_framed() -> None:
    far = (0.0, 500.0, 0.0)
    assert framed(character(far, landmarks={}))[1][1] == 500
    low, high = framed(character((0, -700, 0), landmarks={"chin": 2}))
    assert low[1] == -40 and high[1] == 60
    together = character(far, landmarks={"lid_upper_left": 0, "lid_upper_right": 0, "chin": 2})
    assert framed(together)[1][1] == 500


@pytest.mark.parametrize(("moving", "share"), [((2, 3), 1.0), ((0, 2), 0.4), ((), 1.0), ((0,), 0.0)])
def test_the_share_that_is_seen_is_the_moving_part_of_the_height(moving: tuple[int, ...], share: float) -> None:
    assert share_seen(character(moving=moving)) == pytest.approx(share)


@pytest.mark.parametrize(("scale", "seen"), [(0.199, False), (0.201, True), (17.9, True), (18.1, False)])
def test_a_head_is_seen_between_the_camera_s_planes(scale: float, seen: bool) -> None:
    head = character(moving=(2, 3))
    assert share_seen(replace(head, neutral=head.neutral * np.float32(scale))) == pytest.approx(float(seen))
    assert 0.5 < share_seen(bundled()) <= 1
