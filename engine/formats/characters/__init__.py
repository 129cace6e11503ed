"""Characters from other programs: glTF and VRM with morph targets, folders of OBJ files, PLY, STL, ICT-FaceKit; our own."""

from __future__ import annotations

import os
from pathlib import Path

from engine.errors import FormatError
from engine.formats.base.content import require_file
from engine.formats.characters.raw import RawCharacter

KNOWN = "Retake imports glTF, GLB and VRM, folders of OBJ files, PLY, STL and ICT-FaceKit."


def read(path: Path) -> RawCharacter:
    """Read a character's mesh and shapes from any supported file or folder, its vertices welded; raises `FormatError`."""
    from engine.formats.characters.weld import welded

    return welded(_read(path))


def _read(path: Path) -> RawCharacter:
    from engine.formats.characters import gltf, ict, obj, scans

    if os.path.isdir(path):  # which raises for no name, as pathlib does
        return obj.read(path)
    if not os.path.exists(path):
        raise FormatError(f"{path.name[:80]} is not there.", KNOWN)
    require_file(path)
    ending = path.suffix.lower()
    if ending in (".gltf", ".glb", ".vrm"):
        return gltf.read(path)
    if ending == ".obj":
        return obj.read_mesh(path)
    if ending in scans.ENDINGS:
        return scans.read(path)
    if ending == ".npz" and ict.is_ict(path):
        return ict.read(path)
    raise FormatError(f"{path.name} is not a kind of file that a character can be in.", KNOWN)
