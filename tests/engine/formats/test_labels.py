from __future__ import annotations

from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.formats.labels import Labels, read, write


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    labels = Labels("heads/ict.npz", {7: {"jawOpen": 0.25, "mouthSmileLeft": -0.1}, 0: {}})
    write(labels, tmp_path / "labels.json")
    assert read(tmp_path / "labels.json") == labels


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not JSON"),
        ("[" * 100_000, "not JSON"),
        ("[]", "no list of labels"),
        ('{"labels": 3}', "no list of labels"),
        ('{"target": 3, "labels": []}', "names no file"),
        ('{"labels": [3]}', "no weights in label 1"),
        ('{"labels": [{"frame": 1.5, "weights": {}}]}', "no frame in label 1"),
        ('{"labels": [{"frame": true, "weights": {}}]}', "no frame in label 1"),
        ('{"labels": [{"frame": -1, "weights": {}}]}', "no frame in label 1"),
        ('{"labels": [{"frame": 1, "weights": {"grin": 1}}]}', "no shape with 'grin'"),
        ('{"labels": [{"frame": 1, "weights": {"jawOpen": "wide"}}]}', "no number for jawOpen"),
        ('{"labels": [{"frame": 1, "weights": {"jawOpen": NaN}}]}', "no number for jawOpen"),
        ('{"labels": [{"frame": 1, "weights": {}}, {"frame": 1, "weights": {}}]}', "frame 1 twice"),
    ],
)
def test_a_hostile_file_gets_one_sentence(text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "labels.json"
    path.write_text(text)
    with pytest.raises(FormatError, match=says):
        read(path)


def test_a_missing_file_gets_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="could not be read"):
        read(tmp_path / "none.json")
