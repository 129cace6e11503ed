"""The two halves of a glTF or GLB file: what describes the scene, and the bytes that hold its numbers."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path

from engine.errors import FormatError
from engine.formats.base.budget import BUDGET
from engine.formats.base.content import content_of
from engine.formats.characters.accessors import Structure

MAX_BYTES = 1 << 30
MAX_JSON_BYTES = 64 << 20
MARKS_PER_NODE = 20  # brackets and commas that a part of a scene takes in JSON
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
EXPORT = "Export it as glTF 2.0 with morph targets and without compression."


def document_of(path: Path) -> tuple[Structure, memoryview]:
    """Return the JSON part and the binary chunk, which may be empty; raises `FormatError` for what is not glTF 2.0."""
    content = memoryview(content_of(path, at_most=MAX_BYTES))
    chunks = {JSON_CHUNK: content, BINARY_CHUNK: content[:0]}
    if content[:4] == struct.pack("<I", MAGIC):
        chunks |= dict(_chunks(content, path))
    if len(chunks[JSON_CHUNK]) > MAX_JSON_BYTES:
        raise FormatError(f"{path.name} describes its scene in more than {MAX_JSON_BYTES >> 20} MB.")
    text = bytes(chunks[JSON_CHUNK]).rstrip(b"\x00 ")
    marks = sum(text.count(mark) for mark in (b"{", b"[", b","))
    BUDGET.require(path.name, nodes=marks // MARKS_PER_NODE)
    document = json.loads(text.decode("utf-8"))
    if not isinstance(document, dict) or not str(document.get("asset", {}).get("version", "")).startswith("2"):
        raise FormatError(f"{path.name} is not a glTF 2.0 file.", EXPORT)
    _require_readable(document, path)
    return document, chunks[BINARY_CHUNK]


def _chunks(content: memoryview, path: Path) -> Iterator[tuple[int, memoryview]]:
    """Yield kind and bytes of the first JSON and binary chunk of a GLB file."""
    place, seen = 12, set()
    while place + 8 <= len(content):
        length, kind = struct.unpack_from("<II", content, place)
        if place + 8 + length > len(content):
            raise FormatError(
                f"{path.name} is cut off: a part declares {length} bytes, {len(content) - place - 8} follow."
            )
        if kind not in seen:
            seen.add(kind)
            yield kind, content[place + 8 : place + 8 + length]
        place += 8 + length
    if JSON_CHUNK not in seen:
        raise FormatError(f"{path.name} is cut off: it holds no description of a scene.")


def _require_readable(document: Structure, path: Path) -> None:
    for extension in document.get("extensionsRequired") or []:
        if extension in COMPRESSED:
            raise FormatError(f"{path.name} is compressed with {extension}, which Retake does not read.", EXPORT)
    parts = sum(len(document.get(kind) or []) for kind in ("nodes", "meshes", "accessors", "bufferViews", "skins"))
    BUDGET.require(path.name, nodes=parts)
