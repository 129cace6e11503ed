from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest

from engine.errors import FormatError
from engine.formats.characters import gltf
from engine.formats.characters.gltf_document import document_of
from tests.engine.formats.characters.scenes import document, glb


@pytest.mark.parametrize("keep", [0, 3, 12, 20, 300])
def test_a_cut_off_file_is_refused(keep: int, tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", *document())
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(FormatError):
        gltf.read(path)


def test_both_halves_of_a_glb_and_the_whole_of_a_gltf_are_found(tmp_path: Path) -> None:
    scene, binary = document()
    found, chunk = document_of(glb(tmp_path / "a.glb", scene, binary))
    assert found == scene and bytes(chunk)[: len(binary)] == binary
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    found, chunk = document_of(tmp_path / "a.gltf")
    assert found == scene and bytes(chunk) == b""


def chunked(path: Path, *chunks: tuple[int, bytes]) -> Path:
    body = b"".join(struct.pack("<II", len(data), kind) + data for kind, data in chunks)
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body)
    return path


SCENE = b'{"asset": {"version": "2.1"}}'


def test_of_several_parts_of_a_kind_the_first_counts_and_others_are_passed_over(tmp_path: Path) -> None:
    path = chunked(tmp_path / "a.glb", (7, b"????"), (0x4E4F534A, SCENE), (0x004E4942, b"one"), (0x004E4942, b"two"))
    found, chunk = document_of(path)
    assert found == {"asset": {"version": "2.1"}} and bytes(chunk) == b"one"
    path.write_bytes(path.read_bytes() + b"\0" * 7)  # too short for another part
    assert bytes(document_of(path)[1]) == b"one"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (struct.pack("<III", 0x46546C67, 2, 12), "holds no description"),
        (struct.pack("<IIIII", 0x46546C67, 2, 20, 5, 0x4E4F534A) + b"{}", "declares 5 bytes, 2 follow"),
        (b'{"asset": {"version": "1.2"}}', "not a glTF 2.0"),
        (b'{"asset": {}}', "not a glTF 2.0"),
        (b"[]", "not a glTF 2.0"),
        (b'{"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_meshopt_compression"]}', "compressed with EXT"),
        (b'{"asset": {"version": "2.0"}, "a": [' + b"0," * 2_100_000 + b"0]}", "asks for"),
        (b'{"asset": {"version": "2.0"}, "skins": [' + b"0," * 100_000 + b"0]}", "asks for 100,001 parts"),
    ],
)
def test_what_is_no_scene_is_a_sentence(tmp_path: Path, content: bytes, says: str) -> None:
    (tmp_path / "a.glb").write_bytes(content)
    with pytest.raises(FormatError, match=says):
        document_of(tmp_path / "a.glb")


def test_extensions_that_are_only_used_or_not_known_are_no_reason_to_refuse(tmp_path: Path) -> None:
    (tmp_path / "a.gltf").write_text(
        '{"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_draco_mesh_compression"], "extensionsRequired": ["VRM"]}'
    )
    assert document_of(tmp_path / "a.gltf")[0]["extensionsRequired"] == ["VRM"]
