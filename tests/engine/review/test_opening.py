from __future__ import annotations

import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine import project
from engine.errors import EditError, EngineError
from engine.formats import livelink
from engine.lab.performer import demo
from engine.project import Contents, Edit, Marks, Media
from engine.project.media import attach
from engine.quality import FlagSettings
from engine.review.opening import opened
from engine.take import SHAPES, Take


@pytest.fixture
def edits(random_take: Take) -> tuple[Edit, Edit]:
    rng = np.random.default_rng(0)
    asked = np.full((5, 16), np.nan)
    asked[2, 3] = 12.0
    first = Edit("drag", "first", 4, rng.random((5, len(SHAPES))), asked, {})
    return first, replace(first, title="second", start=20)


def stored(contents: Contents, folder: Path) -> Path:
    path = folder / "a.retake"
    project.create(path, contents).close()
    return path


def sound(path: Path, seconds: float) -> Path:
    with wave.open(str(path), "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(8000)
        out.writeframes(np.zeros(round(8000 * seconds), "<i2").tobytes())
    return path


def test_a_take_is_alone_and_does_not_tell_what_it_was_made_from() -> None:
    found = opened(demo.BUNDLED)
    np.testing.assert_array_equal(found.take.weights, livelink.read(demo.BUNDLED).weights)
    assert found.original is None and found.asked is None and found.edits == () and found.marks == Marks()
    with pytest.raises(EditError, match=f"{demo.BUNDLED.name} does not hold what it was made from"):
        found.require_original()


def test_a_project_is_what_its_edits_in_effect_come_to(
    random_take: Take, edits: tuple[Edit, Edit], tmp_path: Path
) -> None:
    for position in (0, 1, 2):
        (tmp_path / str(position)).mkdir()
        found = opened(stored(Contents(random_take, edits, position), tmp_path / str(position)))
        weights = random_take.weights.copy()
        for edit in edits[:position]:
            weights[edit.start : edit.stop] = edit.weights
        np.testing.assert_array_equal(found.take.weights, weights)
        np.testing.assert_array_equal(found.require_original().weights, random_take.weights)
        assert [(edit.title, edit.start, edit.stop) for edit in found.edits] == [("first", 4, 9), ("second", 20, 25)][
            :position
        ]
        if position:
            assert found.asked is not None and found.asked[6, 3] == 12.0


def test_a_project_that_was_read_can_be_opened_by_another(random_take: Take, tmp_path: Path) -> None:
    path = stored(Contents(random_take), tmp_path)
    opened(path)
    project.Project.open(path).close()


def test_flags_are_those_that_the_project_counts_and_what_is_asked_for_besides(
    random_take: Take, tmp_path: Path
) -> None:
    lost = np.zeros(len(random_take), bool)
    lost[5:9] = True
    settings = FlagSettings(counts={"lost": False})
    found = opened(stored(Contents(replace(random_take, lost=lost), marks=Marks(flags=settings)), tmp_path))
    assert "lost" not in {flag.kind for flag in found.flags()}
    assert [(flag.start, flag.stop) for flag in found.flags(["lost"]) if flag.kind == "lost"] == [(5, 9)]


@pytest.mark.parametrize("offset_s", [0.0, 0.5, -0.5])
def test_the_sound_of_a_project_is_the_attached_recording_at_its_time(
    random_take: Take, tmp_path: Path, offset_s: float
) -> None:
    medium = attach(sound(tmp_path / "b.wav", 3.0), tmp_path, kind="audio", offset_s=offset_s)
    found = opened(stored(Contents(random_take, marks=Marks(media=(medium,))), tmp_path))
    assert found.sound_file() == (tmp_path / "b.wav", -offset_s)
    heard = found.with_sound().sound
    assert heard is not None and heard.duration_s == 3.0 and heard.offset_s == -offset_s
    assert len(heard.loudness) == 90 and found.sound is None


def test_the_sound_of_a_take_lies_beside_it_and_a_project_s_that_is_gone_is_none(
    random_take: Take, tmp_path: Path
) -> None:
    take = tmp_path / "a.csv"
    take.write_bytes(demo.BUNDLED.read_bytes())
    assert opened(take).sound_file() is None and opened(take).with_sound().sound is None
    beside = sound(tmp_path / "a.wav", 1.0)
    assert opened(take).sound_file() == (beside, 0.0)
    gone = Media("audio", "gone.wav", "ab" * 32, 0.25)
    found = opened(stored(Contents(random_take, marks=Marks(media=(gone,))), tmp_path))
    assert found.sound_file() is None and found.with_sound() is found


def test_what_cannot_be_read_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.retake").write_bytes(b"not a project")
    for path in (tmp_path / "a.retake", tmp_path / "none.csv"):
        with pytest.raises(EngineError):
            opened(path)
