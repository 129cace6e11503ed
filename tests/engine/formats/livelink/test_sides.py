from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import EditError
from engine.formats import livelink, read_take, write_take
from engine.formats.base.reading import Reading
from engine.formats.livelink.sides import exchange
from engine.take import SHAPE_INDEX, SHAPES, Take
from tests.conftest import DATA

CASES = DATA.parent / "cases"


def sideways(*, frames: int = 240, strength: float = 0.4, noise: float = 0.01) -> Take:
    """Return a mouth that goes to one side and the other, pulled by that side."""
    rng = np.random.default_rng(5)
    way = strength * np.sin(np.linspace(0, 17, frames))
    weights = 0.3 + noise * rng.standard_normal((frames, len(SHAPES)))
    for side, sign in (("Left", 1), ("Right", -1)):
        for shape in ("mouth", "jaw"):
            weights[:, SHAPE_INDEX[f"{shape}{side}"]] = np.maximum(sign * way, 0)
        for shape in ("mouthDimple", "mouthStretch", "cheekSquint", "mouthUpperUp"):
            weights[:, SHAPE_INDEX[f"{shape}{side}"]] += 0.3 * sign * way
    return Take(weights, 60.0, name="sideways")


@pytest.mark.parametrize("sides", ["recorded", "named"])
@pytest.mark.parametrize("strength", [0.05, 0.4])
def test_the_motion_tells_how_a_file_names_its_sides(tmp_path: Path, sides: str, strength: float) -> None:
    take = sideways(strength=strength, noise=0.004)
    write_take(take, tmp_path / "take.csv", sides)
    again = read_take(tmp_path / "take.csv")
    np.testing.assert_allclose(again.weights, take.weights, atol=1e-9)
    judged = livelink.judged(again.origin)
    assert (judged.recorded, judged.confidence) == (sides == "recorded", "sure")
    assert any("as named" in notice for notice in again.notices) == (sides == "named")


@pytest.mark.parametrize("sides", ["recorded", "named"])
def test_what_is_asked_for_is_done_whatever_the_motion_tells(tmp_path: Path, sides: str) -> None:
    take = sideways()
    write_take(take, tmp_path / "take.csv", sides)
    for asked in ("recorded", "named"):
        read = read_take(tmp_path / "take.csv", reading=Reading(sides=asked))
        np.testing.assert_allclose(read.weights, take.weights if asked == sides else exchange(take.weights), atol=1e-9)
        assert not any("taken as" in notice for notice in read.notices)


@pytest.mark.parametrize("seed", range(40))
def test_motion_at_random_is_taken_as_the_apps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    steps = rng.standard_normal((200, len(SHAPES)))
    kernel = np.hanning(15) / np.hanning(15).sum()
    weights = 0.5 + np.apply_along_axis(np.convolve, 0, steps, kernel, "same")
    curves = {name: weights[:, index] for name, index in SHAPE_INDEX.items()}
    from engine.formats.livelink.sides import judge

    assert judge(curves, np.ones(200, bool)).recorded


@pytest.mark.parametrize("still", [0.0, 0.5])
def test_a_still_mouth_tells_nothing(tmp_path: Path, still: float) -> None:
    write_take(Take(np.full((60, len(SHAPES)), still), 30.0), tmp_path / "still.csv")
    take = read_take(tmp_path / "still.csv")
    assert livelink.judged(take.origin).agreement is None and take.notices == ()


@pytest.mark.parametrize("newline", [b"\n", b"\r\n"])
@pytest.mark.parametrize("last", ["mouthRight", "headYaw"])
def test_writing_by_the_other_names_exchanges_the_texts_and_nothing_else(
    tmp_path: Path, newline: bytes, last: str
) -> None:
    """Whatever the order of the columns, twice is the file that it was, to the byte."""
    write_take(sideways(frames=50), tmp_path / "given.csv")
    rows = [line.split(b",") for line in (tmp_path / "given.csv").read_bytes().splitlines()]
    place = [cell.lower() for cell in rows[0]].index(last.lower().encode())
    content = b"".join(b",".join([*row[:place], *row[place + 1 :], row[place]]) + newline for row in rows)
    (tmp_path / "given.csv").write_bytes(content)
    write_take(read_take(tmp_path / "given.csv"), tmp_path / "named.csv", "named")
    named = read_take(tmp_path / "named.csv", reading=Reading(sides="named"))
    np.testing.assert_array_equal(named.weights, read_take(tmp_path / "given.csv").weights)
    assert (tmp_path / "named.csv").read_bytes() != content
    write_take(named, tmp_path / "back.csv", "recorded")
    assert (tmp_path / "back.csv").read_bytes() == content


def test_another_reading_keeps_the_edits_and_goes_back_exactly(tmp_path: Path) -> None:
    write_take(sideways(), tmp_path / "take.csv", "named")
    take = read_take(tmp_path / "take.csv")
    edited = take.with_rows(20, np.full((5, len(SHAPES)), 0.25) + np.arange(len(SHAPES)) / 100)
    other = livelink.reread(edited, Reading(fps=30.0, sides="recorded"))
    np.testing.assert_array_equal(other.weights, exchange(edited.weights))
    assert other.fps == 30.0
    back = livelink.reread(other, Reading())
    np.testing.assert_array_equal(back.weights, edited.weights)
    assert back.fps == take.fps and back.origin.swapped == take.origin.swapped


@pytest.mark.parametrize("bad", [0.0, -30.0, float("nan"), float("inf"), 1e9])
def test_a_rate_that_cannot_be_is_a_sentence(bad: float) -> None:
    with pytest.raises(EditError, match="not a rate"):
        Reading(fps=bad)
    with pytest.raises(EditError, match="choice of sides"):
        Reading(sides="upside down")  # type: ignore[arg-type]


def test_a_real_stream_by_name_reads_as_it_says() -> None:
    path = CASES / "09-leftright-by-name" / "dao_by_name.csv"
    if not path.exists():
        pytest.skip("needs the cases of other programs' files")
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    column = header.index("MouthLeft")
    said = np.array([float(row[column]) for row in rows])
    for reading in (Reading(), Reading(sides="named")):
        np.testing.assert_allclose(read_take(path, reading=reading).curve("mouthLeft"), said)
    assert said.max() > 0.7


def test_recordings_of_the_app_are_known_as_such(real_take_path: Path) -> None:
    for path in sorted(real_take_path.parent.glob("*.csv")):
        judged = livelink.judged(read_take(path).origin)
        assert judged.recorded and judged.agreement is not None and judged.agreement < -0.3
