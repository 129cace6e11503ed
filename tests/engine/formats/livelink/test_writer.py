"""What is edited is what is written, and what nobody edited is the text it came as."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from engine import retouch
from engine.clean.takes import clean
from engine.editing import ControlRequest, Patch, set_control
from engine.errors import EditError
from engine.formats import livelink
from engine.formats.base.reading import Reading, Sides
from engine.formats.livelink.origin import GAP_S, Origin
from engine.formats.livelink.writer import UNSEEN, encode
from engine.inpaint.fill import fill, fill_lost
from engine.lab.performer import demo
from engine.manifold.retarget import retarget_weights
from engine.spacetime.pin import pin
from engine.take import SHAPE_INDEX, SHAPES, Take, runs
from tests.engine.formats.livelink.files import File, Writer, content_of, files

CLOSE = 1e-9  # ten decimals are written
JAW, TONGUE = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["tongueOut"]  # the last of all
Frames = tuple[int, int]


def read(content: bytes, folder: Path, sides: Sides = "recorded") -> Take:
    path = folder / "take.csv"
    path.write_bytes(content)
    return livelink.read(path, reading=Reading(sides=sides))  # random motion would tell of either


def written(take: Take) -> bytes:
    return b"".join(encode(take))


def lines_of(take: Take) -> dict[int, bytes]:
    origin = take.origin
    assert isinstance(origin, Origin)
    return {int(frame): origin.text(row, row + 1) for row, frame in enumerate(origin.rows)}


def holds(take: Take, edited: Take, folder: Path) -> Take:
    """Check that a file holds an edited take, and the lines of the take it came from wherever nothing was edited."""
    again = read(written(edited), folder)
    assert len(again) == len(edited) and again.fps == pytest.approx(edited.fps, rel=1e-6)
    assert again.start_s == edited.start_s
    np.testing.assert_array_equal(again.lost, edited.lost)
    lacks = "TongueOut" not in again.origin.header
    np.testing.assert_allclose(again.weights[:, :TONGUE], edited.weights[:, :TONGUE], atol=CLOSE)
    np.testing.assert_allclose(again.weights[:, TONGUE], edited.weights[:, TONGUE], atol=UNSEEN if lacks else CLOSE)
    np.testing.assert_allclose(again.rotations, edited.rotations, atol=CLOSE)
    if len(again.origin.header) > len(take.origin.header):
        return again  # every row has another cell
    before, after = lines_of(take), lines_of(again)
    same = (edited.weights == take.weights).all(axis=1) & (edited.lost == take.lost)
    still = edited.lost & take.lost
    for frame, line in before.items():
        if same[frame] or still[frame]:
            assert after[frame] == line
    return again


def _paste(take: Take, frames: Frames, seed: int) -> Take:
    rows = np.random.default_rng(seed).random((frames[1] - frames[0], len(SHAPES)))
    return retouch.paste(take, frames[0], rows).apply(take)


def _one_weight(take: Take, frames: Frames, seed: int) -> Take:
    curve = np.random.default_rng(seed).random(frames[1] - frames[0])
    return retouch.replace_weight(take, seed % 51, frames[0], curve).apply(take)


def _bridge(take: Take, frames: Frames, seed: int) -> Take:
    region = ("face", "lower", "eyes")[seed % 3]
    return fill(take, frames, region=region, style="bridge")[0].take


def _pin(take: Take, frames: Frames, seed: int) -> Take:
    frame = frames[0] + seed % (frames[1] - frames[0])
    return pin(take, {frame: {"jawOpen": 0.6}}, frames, whole=bool(seed % 2))


QUICK: dict[str, Callable[[Take, Frames, int], Take]] = {
    "nothing": lambda take, frames, seed: take,
    "paste": _paste,
    "one weight": _one_weight,
    "smooth": lambda take, frames, seed: retouch.smooth(take, frames, 4.0).apply(take),
    "bridge": _bridge,
    "bridge what is lost": lambda take, frames, seed: _bridged(take),
    "labels": lambda take, frames, seed: retarget_weights(take, {frames[0]: {"jawOpen": 0.5}}),
}
SLOW: dict[str, Callable[[Take, Frames, int], Take]] = {
    "edit": lambda take, frames, seed: set_control(take, ControlRequest("lips_vertical", frames, "add", 3.0)).apply(
        take
    ),
    "fill": lambda take, frames, seed: fill(take, frames, style="perform", seed=seed)[0].take,
    "fill what is lost": lambda take, frames, seed: fill_lost(take, seed=seed),
    "pin": _pin,
    "clean": lambda take, frames, seed: clean(take, frames=frames).take,
}


def _bridged(take: Take) -> Take:
    for start, stop in runs(take.lost):
        if stop - start > 1:
            take = fill(take, (start, stop), style="bridge")[0].take
    return take


def _try(verb: Callable[[Take, Frames, int], Take], take: Take, data: st.DataObject) -> Take:
    edited = take
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(take) - 2))
        stop = data.draw(st.integers(start + 2, min(len(take), start + 40)))
        try:
            edited = verb(edited, (start, stop), data.draw(st.integers(0, 99)))
        except EditError:
            assume(False)
    return edited


GIVEN = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.parametrize("name", list(QUICK))
@settings(GIVEN, max_examples=25)
@given(file=files, data=st.data())
def test_what_is_edited_is_what_is_written(tmp_path: Path, name: str, file: File, data: st.DataObject) -> None:
    take = read(file.content, tmp_path)
    edited = _try(QUICK[name], take, data)
    again = holds(take, edited, tmp_path)
    assert written(again) == written(edited)
    if name == "nothing":
        assert written(edited) == file.content


@pytest.mark.parametrize("name", list(SLOW))
@settings(GIVEN, max_examples=4)
@given(file=files, data=st.data())
def test_what_the_networks_make_is_what_is_written(tmp_path: Path, name: str, file: File, data: st.DataObject) -> None:
    take = read(file.content, tmp_path)
    holds(take, _try(SLOW[name], take, data), tmp_path)


@settings(GIVEN, max_examples=40)
@given(file=files, data=st.data())
def test_any_motion_in_any_frames_is_written(tmp_path: Path, file: File, data: st.DataObject) -> None:
    """Whatever a verb may leave behind: some frames moved, some found where they are, some lost again, heads turned."""
    take = read(file.content, tmp_path)
    rng = np.random.default_rng(data.draw(st.integers(0, 999)))
    share = data.draw(st.sampled_from([0.02, 0.3, 0.9]))
    rows = np.where(rng.random((len(take), 1)) < share, rng.random((len(take), len(SHAPES))), take.weights)
    if "TongueOut" not in take.origin.header:
        rows[:, SHAPE_INDEX["tongueOut"]] = 0.0
    edited = take.with_rows(0, rows, found=rng.random(len(take)) < 0.05)
    holds(take, edited, tmp_path)


# --- the kinds of file that lost work


def gap(writer: Writer, start: int, stop: int, frames: int = 120) -> bytes:
    absent = np.zeros(frames, bool)
    absent[start:stop] = True
    return content_of(writer, np.zeros(frames, bool), absent, 7)


def test_a_gap_of_absent_rows_is_lost_and_filled_rows_stand_in_it(tmp_path: Path) -> None:
    content = gap(Writer(), 40, 85)
    take = read(content, tmp_path)
    assert runs(take.lost) == [(40, 85)]
    filled = fill(take, (40, 85), seed=3)[0].take
    again = holds(take, filled, tmp_path)
    assert not again.lost.any() and len(again.origin.rows) == len(take)
    seconds = [line.split(b",")[0] for line in written(filled).splitlines()[1:]]
    assert seconds == sorted(seconds) and len(set(seconds)) == len(take)
    assert {line.split(b",")[1] for line in written(filled).splitlines()[1:]} == {b"61"}


def test_of_a_gap_filled_in_part_the_rest_is_lost_rows(tmp_path: Path) -> None:
    take = read(gap(Writer(), 40, 85), tmp_path)
    filled = fill(take, (40, 83), seed=3)[0].take
    assert runs(holds(take, filled, tmp_path).lost) == [(83, 85)]


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0, 120.0])
def test_single_missed_frames_are_interpolated_and_no_row_is_made_for_them(tmp_path: Path, fps: float) -> None:
    content = gap(Writer(fps=fps), 40, 41)
    take = read(content, tmp_path)
    assert not take.lost.any() and written(take) == content
    elsewhere = take.with_rows(80, take.weights[80:90] * 0.5)
    assert written(elsewhere).count(b"\n") == content.count(b"\n")
    here = take.with_rows(40, take.weights[40:41] * 0.5)
    assert written(holds(take, here, tmp_path)).count(b"\n") == content.count(b"\n") + 1


@pytest.mark.parametrize("fps", [25.0, 30.0, 60.0, 120.0])
def test_gaps_are_lost_by_how_long_they_last(tmp_path: Path, fps: float) -> None:
    longest = max(1, int(np.floor(GAP_S * fps + 1e-9)))
    assert not read(gap(Writer(fps=fps), 40, 40 + longest), tmp_path).lost.any()
    assert read(gap(Writer(fps=fps), 40, 41 + longest), tmp_path).lost.sum() == 1 + longest


def test_head_and_eyes_go_on_through_filled_frames() -> None:
    take = livelink.read(demo.BUNDLED)
    cells = [line.split(b",") for line in written(fill_lost(take)).splitlines()]
    turned = np.array([[float(cell) for cell in row[54:]] for row in cells[1:]])
    np.testing.assert_allclose(turned, take.rotations, atol=CLOSE)


def test_a_pinned_lost_frame_has_a_row_even_where_the_pin_moves_nothing(tmp_path: Path) -> None:
    take = livelink.read(demo.BUNDLED)
    frame = runs(take.lost)[0][0] + 3
    pose = dict(zip(SHAPES, take.weights[frame].tolist(), strict=True))
    pinned = pin(take, {frame: pose}, (frame - 5, frame + 5))
    assert not pinned.lost[frame] and not holds(take, pinned, tmp_path).lost[frame]


def test_rows_keep_their_decimals_whatever_the_first_row_looks_like(tmp_path: Path) -> None:
    lost = np.zeros(60, bool)
    content = content_of(Writer(fps=60.0, numbers="repr", at_rest_first=True), lost, lost, 2)
    take = read(content, tmp_path)
    edited = retouch.replace_weight(take, JAW, 30, np.linspace(0, 1, 10)).apply(take)
    before, after = content.splitlines(), written(edited).splitlines()
    assert [index for index, (one, two) in enumerate(zip(before, after, strict=True)) if one != two] == [*range(31, 41)]
    changed = [one == two for one, two in zip(before[35].split(b","), after[35].split(b","), strict=True)]
    assert changed.count(False) == 1


@pytest.mark.parametrize("lost_rows", ["two cells", "empty cells", "zeros", "short of cells"])
def test_a_count_of_nought_is_a_lost_frame_however_many_cells_follow(tmp_path: Path, lost_rows: str) -> None:
    lost = np.zeros(60, bool)
    lost[20:30] = True
    content = content_of(Writer(lost_rows=lost_rows), lost, np.zeros(60, bool), 2)
    take = read(content, tmp_path)
    np.testing.assert_array_equal(take.lost, lost)
    assert written(take) == content
    assert not holds(take, fill_lost(take), tmp_path).lost.any()


def test_a_shape_that_the_file_has_no_column_for_gets_one_once_it_moves(tmp_path: Path) -> None:
    lost = np.zeros(60, bool)
    lost[20:25] = True
    take = read(content_of(Writer(fewer=("TongueOut",)), lost, np.zeros(60, bool), 2), tmp_path)
    assert written(take).splitlines()[1].split(b",")[1] == b"60"
    edited = retouch.replace_weight(take, SHAPE_INDEX["tongueOut"], 30, np.full(10, 0.5)).apply(take)
    again = read(written(edited), tmp_path)
    np.testing.assert_allclose(again.weights, edited.weights, atol=CLOSE)
    assert written(edited).splitlines()[1].split(b",")[1] == b"61"


def test_undoing_a_fill_brings_the_lost_frames_back_to_the_byte() -> None:
    take = livelink.read(demo.BUNDLED)
    (start, stop), *_ = runs(take.lost)
    patch = Patch.between(take, fill(take, (start, stop))[0].take, (start, stop))
    filled = patch.apply(take)
    rows = slice(patch.start, patch.stop)
    assert not filled.lost.any()
    undone = filled.with_exact_rows(patch.start, take.weights[rows], take.lost[rows])
    assert written(undone) == demo.BUNDLED.read_bytes()
