"""Heads and captures as other programs write them, made of the bundled head."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from engine.character import bundled
from engine.formats.markers.capture import Markers
from engine.spacetime.layout import standard
from engine.take import SHAPE_INDEX

# Names that another studio gives its markers, by the landmark they sit on.
FOREIGN = {
    "forehead": "ForeHead_M", "forehead_left": "ForeHead_L", "forehead_right": "ForeHead_R",
    "brow_inner_left": "Leyebrow_Inside", "brow_inner_right": "Reyebrow_Inside",
    "brow_outer_left": "Leyebrow_Outside", "brow_outer_right": "Reyebrow_Outside",
    "nose_bridge": "NoseTop", "nose_tip": "NoseHead", "lid_upper_left": "Leye_Up", "lid_lower_left": "Leye_Down",
    "lid_upper_right": "Reye_Up", "lid_lower_right": "Reye_Down", "eye_outer_left": "Leye_Outside",
    "eye_outer_right": "Reye_Outside", "cheek_left": "Lcheek", "cheek_right": "Rcheek", "lip_upper": "Mouth_Up",
    "lip_lower": "Mouth_Down", "mouth_left": "Mouth_Lend", "mouth_right": "Mouth_Rend", "chin": "Chin_M",
    "chin_left": "Chin_L1", "chin_right": "Chin_R1",
}  # fmt: skip


def write_glb(path: Path, shapes: Mapping[str, str], *, per_mm: float = 0.001) -> Path:
    """Write the bundled head with some of its shapes, the name in the file by the shape that is under it."""
    head = bundled()
    arrays = [head.neutral, *(head.deltas[SHAPE_INDEX[shape]] for shape in shapes.values())]
    parts = [(array * per_mm).astype(np.float32).tobytes() for array in arrays] + [head.triangles.tobytes()]
    starts = np.cumsum([0, *map(len, parts)]).tolist()
    count = len(head.neutral)
    accessors = [{"bufferView": n, "componentType": 5126, "count": count, "type": "VEC3"} for n in range(len(arrays))]
    accessors.append({"bufferView": len(arrays), "componentType": 5125, "count": head.triangles.size, "type": "SCALAR"})
    primitive = {
        "attributes": {"POSITION": 0},
        "indices": len(arrays),
        "targets": [{"POSITION": n + 1} for n in range(len(shapes))],
    }
    scene = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": starts[-1]}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(part)}
            for start, part in zip(starts, parts, strict=False)
        ],
        "accessors": accessors,
        "meshes": [{"primitives": [primitive], "extras": {"targetNames": list(shapes)}}],
        "nodes": [{"mesh": 0}],
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def capture(
    weights: np.ndarray,
    names: Mapping[str, str] = FOREIGN,
    *,
    turn: np.ndarray | None = None,
    heads: Sequence[np.ndarray] = (),
) -> Markers:
    """Return markers of the bundled head that plays weights, (frames, 52), by names of their own.

    `turn`, (3, 3), is from our axes to the capture's; `heads`, (3, 3) each frame, turn the head about its own axes.
    """
    head = bundled()
    layout = standard(head).pick(list(names))
    places = layout.rest(head) + np.einsum("fs,snx->fnx", weights, layout.deltas(head))
    for frame, rotation in enumerate(heads):
        places[frame] = places[frame] @ rotation.T
    return Markers(places @ (np.eye(3) if turn is None else turn) + 300.0, tuple(names.values()), 60.0, "studio")
