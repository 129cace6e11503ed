from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from engine.errors import EngineError, FormatError
from engine.formats import labels
from engine.take import SHAPES

KNOWN = labels.LabelFile({3: {"jawOpen": 0.25}, 12: {"mouthSmileLeft": 1.0, "tongueOut": 0.0}}, Path("anna.npz"))


def test_what_is_written_reads_back(tmp_path: Path) -> None:
    labels.write(KNOWN, tmp_path / "poses.json")
    found = labels.read(tmp_path / "poses.json")
    assert found.labels == KNOWN.labels and found.target == tmp_path / "anna.npz"


def test_a_table_says_the_same(tmp_path: Path) -> None:
    path = tmp_path / "poses.csv"
    path.write_text("frame,jawOpen,mouthSmileLeft,tongueOut\n3,0.25,,\n12,,1,0\n")
    assert labels.read(path) == labels.LabelFile(KNOWN.labels)


def one(**label: object) -> str:
    return '{"labels": [' + ", ".join(f'"{key}": {value}' for key, value in label.items()).join("{}") + "]}"


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.json", "", "not a list of labelled frames"),
        ("a.json", "[1]", "not a list of labelled frames"),
        ("a.json", "[" * 100_000, "not a list of labelled frames"),
        ("a.json", '{"labels": []}', "labels no frame"),
        ("a.json", '{"labels": [3]}', "not a list of labelled frames"),
        ("a.json", '{"target": 3, "labels": []}', "names a target"),
        ("a.json", '{"target": "\\u0000", "labels": []}', "names a target"),
        ("a.json", one(frame=-1, weights="{}"), "no frame number in label 1"),
        ("a.json", one(frame="true", weights="{}"), "no frame number in label 1"),
        ("a.json", one(frame=1.5, weights="{}"), "no frame number in label 1"),
        ("a.json", one(frame="1" + "0" * 400, weights="{}"), "no frame number in label 1"),
        ("a.json", one(frame="1" + "0" * 9000, weights="{}"), "not a list of labelled frames"),
        ("a.json", one(frame=1, weights="[]"), "no weights in label 1"),
        ("a.json", one(frame=1, weights='{"grin": 1}'), "'grin' at frame 1, which is no shape"),
        ("a.json", one(frame=1, weights='{"jawOpen": NaN}'), "jawOpen no usable weight"),
        ("a.json", one(frame=1, weights='{"jawOpen": 1e999}'), "jawOpen no usable weight"),
        ("a.json", one(frame=1, weights='{"jawOpen": "1"}'), "jawOpen no usable weight"),
        (
            "a.json",
            '{"labels": [{"frame": 1, "weights": {}}, {"frame": 1, "weights": {}}]}',
            "labels frame 1 twice",
        ),
        ("a.csv", "time,jawOpen\n", "does not begin"),
        ("a.csv", "frame,jawOpen,jawOpen\n", "does not begin"),
        ("a.csv", "frame,jawOpen\n", "labels no frame"),
        ("a.csv", "frame,jawOpen\n1\n", "1 cells in row 2"),
        ("a.csv", "frame,jawOpen\n-1,0\n", "no frame number in label 1"),
        ("a.csv", "frame,jawOpen\n1,x\n", "jawOpen no usable weight"),
    ],
)
def test_what_is_wrong_is_one_sentence(name: str, text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(FormatError, match=says) as caught:
        labels.read(tmp_path / name)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 300


LIKELY = '{}[]":,0123456789.-eframweightslbNn\n'
CONTENT = st.binary(max_size=200) | st.text(LIKELY, max_size=200).map(str.encode)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=CONTENT, ending=st.sampled_from([".json", ".csv"]))
def test_any_content_gives_labels_or_a_sentence(content: bytes, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"any{ending}"
    path.write_bytes(content)
    try:
        found = labels.read(path)
    except EngineError as error:
        assert "\n" not in str(error)
    else:
        assert all(shape in SHAPES for weights in found.labels.values() for shape in weights)


@pytest.mark.parametrize(
    "target", ["/etc/a.npz", "../a.npz", "b/../../a.npz", "C:\\a.npz", "..\\a.npz", "\\\\host\\a.npz", "link/a.npz"]
)
def test_a_target_outside_the_folder_of_its_labels_is_never_opened(tmp_path: Path, target: str) -> None:
    (tmp_path / "labels").mkdir()
    (tmp_path / "a.npz").touch()
    (tmp_path / "labels" / "link").symlink_to(tmp_path)
    path = tmp_path / "labels" / "a.json"
    path.write_text(json.dumps({"target": target, "labels": [{"frame": 1, "weights": {"jawOpen": 0.5}}]}))
    found = labels.read(path)
    assert found.target is None and found.elsewhere == target and found.labels == {1: {"jawOpen": 0.5}}


def test_a_target_below_the_folder_of_its_labels_is_found(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"target": "heads/a.npz", "labels": [{"frame": 1, "weights": {"jawOpen": 0.5}}]}))
    assert labels.read(path).target == tmp_path / "heads" / "a.npz"
