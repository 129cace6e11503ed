from __future__ import annotations

import os
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled, load
from engine.errors import EngineError, FormatError
from engine.formats import audio as sound
from engine.formats import cues, labels, markers, read_take
from engine.formats.base.archive import arrays_of, names_in
from engine.formats.base.content import content_of
from engine.formats.characters.opening import character_of
from engine.formats.film import open_film
from engine.formats.markers import layout as markers_layout

READERS: dict[str, Callable[[Path], object]] = {
    "take.csv": read_take,
    "project.retake": read_take,
    "said.TextGrid": cues.read_cues,
    "said.json": cues.read_cues,
    "labels.json": labels.read,
    "capture.csv": markers.read,
    "capture.trc": markers.read,
    "capture.c3d": markers.read,
    "places.csv": lambda path: markers_layout.read(path, head=bundled()),
    "head.npz": character_of,
    "head.glb": character_of,
    "head.obj": character_of,
    "sound.wav": sound.read,
    "film.mp4": open_film,
}


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def circle(path: Path) -> None:
    path.symlink_to(path)


def nothing(path: Path) -> None:
    path.write_bytes(b"")


@pytest.mark.skipif(not hasattr(os, "mkfifo") or not Path("/dev/zero").exists(), reason="needs pipes and devices")
@pytest.mark.parametrize("make", [os.mkfifo, endless, circle, nothing, Path.mkdir], ids=str)
@pytest.mark.parametrize("name", READERS)
def test_what_is_no_ordinary_file_is_one_sentence_at_once(
    tmp_path: Path, name: str, make: Callable[[Path], None]
) -> None:
    path = tmp_path / name
    make(path)
    began = time.monotonic()
    with pytest.raises(EngineError) as caught:
        READERS[name](path)
    assert time.monotonic() - began < 20.0  # a pipe would be waited for, a device read, without end
    assert path.name in caught.value.sentence or path.stem in caught.value.sentence
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["y" * 300 + ".csv", "a/" * 3000 + "b.csv", "nul\0l.csv", "gone.csv"])
def test_a_name_that_cannot_be_is_a_sentence(tmp_path: Path, name: str) -> None:
    with pytest.raises(FormatError, match="could not be read") as caught:
        content_of(tmp_path / name)
    assert len(str(caught.value)) < 200


def test_a_file_over_the_limit_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.csv"
    path.touch()
    os.truncate(path, 3 << 20)
    with pytest.raises(FormatError, match="larger than 2 MB"):
        content_of(path, at_most=2 << 20)
    assert len(content_of(path)) == 3 << 20


def test_an_archive_that_declares_more_than_it_holds_takes_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w") as archive, archive.open("vertices.npy", "w") as member:
        np.lib.format.write_array_header_1_0(
            member, {"descr": "<f4", "fortran_order": False, "shape": (2_000_000_000, 3)}
        )
    assert names_in(path) == {"vertices"}
    with pytest.raises(FormatError, match="more data than it holds"):
        arrays_of(path, ["vertices"])
    with pytest.raises(EngineError, match="damaged"):
        load(path)
