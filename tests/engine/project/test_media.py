"""Sound and video are found beside the project, and nowhere that a path must not lead."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from engine import project
from engine.errors import FormatError
from engine.project import Media


def test_media_are_found_in_their_place_beside_the_project_and_elsewhere(tmp_path: Path) -> None:
    folder, sound, other = tmp_path / "show", tmp_path / "show" / "sound", tmp_path / "other"
    for made in (sound, other):
        made.mkdir(parents=True)
    (sound / "take.wav").write_bytes(b"RIFF")
    media = project.attach(sound / "take.wav", folder, kind="audio", offset_s=0.5)
    assert (media.path, media.offset_s) == ("sound/take.wav", 0.5)
    assert project.find(media, folder).path == sound / "take.wav"
    for place in (folder / "take.wav", other / "take.wav"):
        found = next(tmp_path.rglob("take.wav"))
        found.rename(place)
        assert project.find(media, folder, [other]).path == place
    assert project.find(media, folder).sentence == "take.wav is missing."
    (folder / "take.wav").write_bytes(b"another")
    found_changed = project.find(media, folder)
    assert found_changed.path is None and found_changed.changed == folder / "take.wav"
    assert found_changed.sentence == "take.wav is not the file it was."
    assert project.attach(other / "take.wav", folder, kind="audio").path == "take.wav"
    with pytest.raises(FormatError, match=r"gone\.wav could not be read"):
        project.attach(folder / "gone.wav", folder, kind="audio")


@pytest.mark.parametrize(
    "place", ["../secret.wav", "link/secret.wav", "{outside}", "..\\secret.wav", "C:\\secret.wav", "a/../../secret.wav"]
)
def test_media_paths_never_lead_out_of_the_folder(tmp_path: Path, place: str) -> None:
    folder = tmp_path / "show"
    folder.mkdir()
    secret = tmp_path / "secret.wav"
    secret.write_bytes(b"RIFF")
    (folder / "link").symlink_to(tmp_path, target_is_directory=True)
    known = project.attach(secret, tmp_path, kind="audio")
    found = project.find(replace(known, path=place.format(outside=secret)), folder)
    assert found.path is None and found.changed is None and found.sentence == "secret.wav is missing."


@pytest.mark.parametrize("place", ["", ".", "..", "/", "a\x00b", "x" * 5000, "link/../..", "con:"])
def test_media_paths_that_are_no_paths_are_missing(tmp_path: Path, place: str) -> None:
    os.mkfifo(tmp_path / "pipe.wav")
    for path in (place, "pipe.wav"):
        assert project.find(Media("audio", path, "00"), tmp_path).path is None


def locks_held() -> int:
    """Return how many locks on files this process holds, as the system tells."""
    return Path("/proc/locks").read_text().count(f" {os.getpid()} ")


@pytest.mark.skipif(not Path("/proc/locks").exists(), reason="the system does not tell its locks")
def test_a_project_named_as_sound_is_refused_and_keeps_its_locks(tmp_path: Path, random_take) -> None:
    opened = project.create(tmp_path / "a.retake", project.Contents(random_take))
    os.link(opened.path, tmp_path / "a.wav")
    before = locks_held()
    assert before > 0
    for name in ("a.retake", "a.wav"):
        with pytest.raises(FormatError, match="is a project"):
            project.attach(tmp_path / name, tmp_path, kind="audio")
        assert project.find(Media("audio", name, "00"), tmp_path).path is None
    assert locks_held() == before
    opened.close()
    with pytest.raises(FormatError):
        project.attach(tmp_path / "a.retake", tmp_path, kind="audio")
    assert project.attach(tmp_path / "a.wav", tmp_path, kind="audio").path == "a.wav"  # nobody has it open any more
