from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from engine.errors import FormatError
from engine.formats import audio, film, read_take, write_take
from engine.formats.base.reading import Reading
from engine.formats.livelink import folder as livelink_folder
from engine.take import SHAPES, Take

CALIBRATED, RAW, NEUTRAL = 0.2, 0.4, 0.6  # what jawOpen is in each file
BODIES = {"_cal": CALIBRATED, "_raw": RAW, "_neutral": NEUTRAL}


def handed_over(
    folder: Path, name: str = "MySlate_1_iPhone", kinds: str = "cal raw neutral", fps: float = 60.0
) -> Path:
    """Make the folder of a take as the app hands it over."""
    folder.mkdir(exist_ok=True)
    for kind in kinds.split():
        write_take(Take(np.full((30, len(SHAPES)), BODIES[f"_{kind}"]), fps), folder / f"{name}_{kind}.csv")
    (folder / f"{name}.mov").write_bytes(b"a film")
    card = {"version": 2, "slate": "MySlate", "take": 1, "videoTargetFrameRate": 60, "calibrated": True, "frames": 30}
    (folder / "take.json").write_text(json.dumps(card))
    return folder


def zipped(folder: Path, target: Path, prefix: str = "MySlate_1/") -> Path:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.iterdir()):
            archive.write(path, prefix + path.name)
        archive.writestr(f"__MACOSX/{prefix}._MySlate_1_iPhone_cal.csv", b"\0\5\26\7")
    return target


def opened(take: Take) -> float:
    return float(take.weights[0, 17])


@pytest.mark.parametrize("file", ["", "take.json", "MySlate_1_iPhone.mov", "MySlate_1_iPhone_neutral.csv"])
def test_any_part_opens_the_calibrated_take(tmp_path: Path, file: str) -> None:
    folder = handed_over(tmp_path / "MySlate_1")
    take = read_take(folder / file if file else folder)
    assert opened(take) == CALIBRATED
    assert any("calibrated" in notice for notice in take.notices)
    assert livelink_folder.table_of(folder / file).name == "MySlate_1_iPhone_cal.csv"


def test_a_folder_in_a_folder_as_unzipping_leaves_it_is_opened(tmp_path: Path) -> None:
    (tmp_path / "MySlate_1" / "__MACOSX").mkdir(parents=True)
    handed_over(tmp_path / "MySlate_1" / "MySlate_1")
    take = read_take(tmp_path / "MySlate_1")
    assert opened(take) == CALIBRATED
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "link").symlink_to(tmp_path / "MySlate_1" / "MySlate_1")
    with pytest.raises(FormatError, match="no take"):
        read_take(tmp_path / "out")


@pytest.mark.parametrize("prefix", ["", "MySlate_1/", "a/b/"])
def test_a_zip_is_the_same_take(tmp_path: Path, prefix: str) -> None:
    path = zipped(handed_over(tmp_path / "MySlate_1"), tmp_path / "take.zip", prefix)
    take = read_take(path)
    assert opened(take) == CALIBRATED and take.name == "MySlate_1_iPhone_cal.csv"
    assert any("calibrated" in notice for notice in take.notices)
    copied = livelink_folder.copy_film(path, tmp_path / "films")
    assert copied is not None and copied.read_bytes() == b"a film" and copied.parent == tmp_path / "films"
    assert livelink_folder.copy_film(path, tmp_path / "films") == copied


def test_the_raw_file_opens_where_it_is_chosen_or_alone(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "both")
    raw = read_take(folder / "MySlate_1_iPhone_raw.csv")
    assert opened(raw) == RAW and any("_cal.csv is the calibrated one" in notice for notice in raw.notices)
    calibrated = read_take(folder / "MySlate_1_iPhone_cal.csv")
    assert opened(calibrated) == CALIBRATED and any("was opened" in notice for notice in calibrated.notices)
    alone = handed_over(tmp_path / "alone", kinds="raw neutral")
    take = read_take(alone)
    assert opened(take) == RAW and any("raw" in notice for notice in take.notices)


def test_a_zip_without_a_film_has_none(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "take")
    (folder / "MySlate_1_iPhone.mov").unlink()
    path = zipped(folder, tmp_path / "take.zip")
    assert opened(read_take(path)) == CALIBRATED
    assert livelink_folder.copy_film(path, tmp_path / "films") is None and not (tmp_path / "films").exists()


def test_mouth_cues_of_the_card_s_name_are_no_card(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "take")
    (folder / "take.json").write_text(json.dumps({"metadata": {}, "mouthCues": []}))
    assert not livelink_folder.is_one(folder / "take.json") and livelink_folder.is_one(folder)


def test_a_face_at_rest_alone_is_no_take(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "take", kinds="neutral")
    with pytest.raises(FormatError, match="at rest"):
        read_take(folder)


def test_several_takes_in_a_folder_are_asked_about(tmp_path: Path) -> None:
    folder = handed_over(handed_over(tmp_path / "takes"), name="MySlate_2_iPhone")
    with pytest.raises(FormatError, match="holds 2 takes"):
        read_take(folder)
    assert opened(read_take(folder / "MySlate_2_iPhone.mov")) == CALIBRATED


def test_tables_of_other_things_beside_it_are_no_takes(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "take")
    (folder / "frame_log.csv").write_text("V,0,1\n")
    assert opened(read_take(folder)) == CALIBRATED


@pytest.mark.parametrize(("fps", "card", "said"), [(60.0, 60, ""), (59.94, 60, ""), (30.0, 60, "says 60 fps")])
def test_the_rate_of_the_card_is_compared_with_the_clock(tmp_path: Path, fps: float, card: int, said: str) -> None:
    folder = handed_over(tmp_path / "take", fps=fps)
    take = read_take(folder)
    assert take.fps == pytest.approx(fps, rel=2e-3)
    assert any("take.json" in notice for notice in take.notices) == bool(said)
    assert said in " ".join(take.notices)
    assert read_take(folder, reading=Reading(fps=25.0)).fps == 25.0


def test_the_card_tells_the_rate_where_no_clock_does(tmp_path: Path) -> None:
    folder = handed_over(tmp_path / "take")
    table = folder / "MySlate_1_iPhone_cal.csv"
    header, *rows = table.read_text().splitlines()
    table.write_text("\n".join([header, *("x" + row[row.index(",") :] for row in rows)]))
    take = read_take(folder)
    assert take.fps == 60.0 and any("from take.json" in notice for notice in take.notices)


@pytest.mark.parametrize(
    "card", [b"", b"[]", b"{", b"[" * 100_000, b'{"videoTargetFrameRate": "x"}', b"\xff\xfe", b"1"]
)
def test_a_card_that_says_nothing_is_no_matter(tmp_path: Path, card: bytes) -> None:
    folder = handed_over(tmp_path / "take")
    (folder / "take.json").write_bytes(card)
    assert read_take(folder).fps == 60.0


@pytest.mark.parametrize(
    ("table", "film_name"),
    [
        ("X_cal.csv", "X.mov"),
        ("X_raw.csv", "X.mov"),
        ("X_cal.csv", "X_iPhone.mov"),
        ("X_iPhone_cal.csv", "X_iPhone.MOV"),
        ("X.csv", "X.mp4"),
        ("x_CAL.csv", "X.mov"),
    ],
)
def test_a_table_finds_its_film_and_its_sound(tmp_path: Path, table: str, film_name: str) -> None:
    (tmp_path / film_name).touch()
    (tmp_path / "other.mov").touch()
    sound = (tmp_path / film_name).with_suffix(".wav")
    sound.touch()
    assert film.beside(tmp_path / table) == tmp_path / film_name
    assert audio.beside(tmp_path / table) == sound


# --- what is no take, and what means harm


def bomb(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("x_cal.csv", "w") as member:
        for _ in range(80):
            member.write(b"0" * (1 << 20))


def lying(path: Path) -> None:
    """Declare fewer bytes than there are."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x_cal.csv", b"0," * 100_000)
    content = bytearray(path.read_bytes())
    at = content.rfind(b"PK\x01\x02")
    content[at + 24 : at + 28] = (10).to_bytes(4, "little")
    path.write_bytes(content)


def nothing(path: Path) -> None:
    with zipfile.ZipFile(path, "w"):
        pass


def cut(path: Path) -> None:
    path.write_bytes(zipped(handed_over(path.parent / "t"), path).read_bytes()[:-300])


def broken(path: Path) -> None:
    content = bytearray(zipped(handed_over(path.parent / "t"), path).read_bytes())
    content[200:400] = b"\xaa" * 200
    path.write_bytes(content)


def locked(path: Path) -> None:
    content = bytearray(zipped(handed_over(path.parent / "t"), path).read_bytes())
    at = 0
    while (at := content.find(b"PK\x01\x02", at)) >= 0:
        content[at + 8] |= 1
        at += 4
    path.write_bytes(content)


def unusual(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("x_cal.csv", b"Timecode")


def crowded(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(60_000):
            archive.writestr(f"{number:0150d}", b"")


def no_zip(path: Path) -> None:
    path.write_bytes(b"PK\x05\x06" + b"\xff" * 40)


@pytest.mark.parametrize("make", [bomb, lying, nothing, cut, broken, locked, unusual, no_zip, crowded, Path.mkdir])
def test_a_bad_zip_is_one_sentence(tmp_path: Path, make: Callable[[Path], None]) -> None:
    path = tmp_path / "bad.zip"
    make(path)
    with pytest.raises(FormatError) as caught:
        read_take(path)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 200


@pytest.mark.parametrize("name", ["../../x_cal.csv", "/etc/x_cal.csv", "C:\\x_cal.csv", "..\\x_cal.csv"])
def test_names_in_a_zip_lead_nowhere(tmp_path: Path, name: str) -> None:
    folder = handed_over(tmp_path / "take")
    path = tmp_path / "inner" / "take.zip"
    path.parent.mkdir()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(zipfile.ZipInfo(name), (folder / "MySlate_1_iPhone_cal.csv").read_bytes())
        archive.writestr(zipfile.ZipInfo(name.replace("_cal.csv", ".mov")), b"a film")
    before = set(tmp_path.rglob("*"))
    assert opened(read_take(path)) == CALIBRATED
    copied = livelink_folder.copy_film(path, tmp_path / "films")
    assert copied is not None and copied.read_bytes() == b"a film"
    assert set(tmp_path.rglob("*")) - before == {tmp_path / "films", copied}


@pytest.mark.parametrize("name", ["gone_cal.csv", "gone_raw.csv", "y" * 300 + ".csv", "y" * 300, "nul\0l.zip"])
def test_a_file_that_is_not_there_is_one_sentence(tmp_path: Path, name: str) -> None:
    with pytest.raises(FormatError):
        read_take(tmp_path / name)


def test_a_folder_without_a_take_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="holds no take"):
        read_take(tmp_path)
    with pytest.raises(FormatError, match="not there"):
        read_take(tmp_path / "gone.zip")
    if os.geteuid() != 0:
        tmp_path.chmod(0)
        with pytest.raises(FormatError, match="could not be read"):
            read_take(tmp_path)
        tmp_path.chmod(0o700)
