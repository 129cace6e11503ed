"""Numbers out of a glTF file's buffers: nothing is read beyond a buffer, nothing is fetched, no path leaves the folder."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt
import pygltflib

from engine.errors import FormatError
from engine.formats.characters.raw import MAX_VERTICES
from engine.take import Array
from engine.words import counted

TYPES: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC3": 3}
MAX_INDICES = 6 * MAX_VERTICES
MAX_FILE_BYTES = 1 << 30


class Accessors:
    """The accessors of one file.

    Parameters
    ----------
    scene : the file's structure
    binary : its binary chunk, empty where it has none
    path : of the file; buffers beside it are found in its folder
    """

    def __init__(self, scene: pygltflib.GLTF2, binary: bytes, path: Path) -> None:
        self._scene, self._binary, self._path = scene, binary, path
        self._buffers: dict[int, bytes] = {}

    def vectors(self, index: int, *, wanted: int | None = None, what: str = "mesh") -> Array:
        """Return (count, 3) float64; raises `FormatError` where there are not as many as wanted."""
        accessor = self._accessor(index, "VEC3")
        if wanted is not None and accessor.count != wanted:
            raise self._fault(
                f"has {counted(accessor.count, 'vertex', 'vertices')} in its shape {what!r}, {wanted} in its mesh"
            )
        if accessor.count > MAX_VERTICES:
            raise self._fault(f"declares {accessor.count} vertices; a character has at most {MAX_VERTICES}")
        values = self._values(accessor, 3).astype(np.float64)
        if accessor.normalized:
            values = np.maximum(values / np.iinfo(self._type(accessor.componentType)).max, -1.0)
        if not np.isfinite(values).all():
            raise self._fault(f"has a value that is not a finite number in its {what}")
        return values

    def indices(self, index: int) -> npt.NDArray[np.int64]:
        """Return (count,) vertex numbers."""
        accessor = self._accessor(index, "SCALAR")
        if accessor.count > MAX_INDICES or self._type(accessor.componentType).kind != "u":
            raise self._fault(f"declares {counted(accessor.count, 'corner')} of faces in a form that cannot be read")
        return self._values(accessor, 1)[:, 0].astype(np.int64)

    def _fault(self, what: str) -> FormatError:
        return FormatError(f"{self._path.name} {what}.")

    def _accessor(self, index: int, kind: str) -> pygltflib.Accessor:
        accessors = self._scene.accessors or []
        if not isinstance(index, int) or not 0 <= index < len(accessors):
            raise self._fault(f"names accessor {index}; it has {len(accessors)}")
        accessor = accessors[index]
        if accessor.type != kind or not isinstance(accessor.count, int) or accessor.count < 0:
            raise self._fault(f"has an accessor of the wrong kind: number {index}")
        return accessor

    def _type(self, component: int) -> np.dtype[Any]:
        if component not in TYPES:
            raise self._fault(f"has numbers of an unknown kind: {component}")
        return TYPES[component]

    def _values(self, accessor: pygltflib.Accessor, width: int) -> npt.NDArray[Any]:
        """Return (count, width) in the file's type, sparse corrections applied."""
        dtype = self._type(accessor.componentType)
        if accessor.bufferView is not None:
            values = self._strided(accessor.bufferView, accessor.byteOffset or 0, accessor.count, width, dtype)
        else:
            values = np.zeros((accessor.count, width), dtype)  # the count is limited before
        if accessor.sparse is not None:
            values = self._corrected(values, accessor.sparse, dtype)
        return values

    def _corrected(self, values: npt.NDArray[Any], sparse: Any, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        count, indices, replaced = sparse.count, sparse.indices, sparse.values
        kind = self._type(indices.componentType)
        if not isinstance(count, int) or not 0 <= count <= len(values) or kind.kind != "u":
            raise self._fault(f"corrects {counted(count, 'value')} of {len(values)}")
        where = self._strided(indices.bufferView, indices.byteOffset or 0, count, 1, kind)[:, 0]
        if len(where) and where.max() >= len(values):
            raise self._fault(f"corrects value {where.max()} of {len(values)}")
        result = values.copy()
        result[where] = self._strided(replaced.bufferView, replaced.byteOffset or 0, count, values.shape[1], dtype)
        return result

    def _strided(self, view_index: int, offset: int, count: int, width: int, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        """Return (count, width) out of a buffer view; every product is taken in Python's whole numbers."""
        views = self._scene.bufferViews or []
        if not isinstance(view_index, int) or not 0 <= view_index < len(views):
            raise self._fault(f"names buffer view {view_index}; it has {len(views)}")
        view = views[view_index]
        start, length = view.byteOffset or 0, view.byteLength
        item = width * dtype.itemsize
        stride = view.byteStride or item
        if not all(isinstance(number, int) for number in (start, length, stride, offset)):
            raise self._fault(f"has a size that is not a whole number in buffer view {view_index}")
        if min(start, length, offset) < 0 or stride < item:
            raise self._fault(f"has an impossible size in buffer view {view_index}")
        buffer = self._buffer(view.buffer)
        if start + length > len(buffer):
            raise self._fault(f"has a buffer view that ends at byte {start + length} of a buffer of {len(buffer)}")
        needed = offset + (stride * (count - 1) + item if count else 0)
        if needed > length:
            raise self._fault(f"declares {needed} bytes of numbers in a buffer view of {length}")
        return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))

    def _buffer(self, index: int) -> bytes:
        buffers = self._scene.buffers or []
        if not isinstance(index, int) or not 0 <= index < len(buffers):
            raise self._fault(f"names buffer {index}; it has {len(buffers)}")
        if index not in self._buffers:
            content = self._content(buffers[index].uri)
            declared = buffers[index].byteLength
            if not isinstance(declared, int) or declared > len(content):
                raise self._fault(f"declares a buffer of {declared} bytes and holds {len(content)}")
            self._buffers[index] = content
        return self._buffers[index]

    def _content(self, uri: str | None) -> bytes:
        if uri is None:
            return self._binary
        if uri.startswith("data:"):
            header, _, body = uri.partition(",")
            try:
                return base64.b64decode(body, validate=True) if header.endswith(";base64") else b""
            except (binascii.Error, ValueError):
                raise self._fault("holds a buffer that is not valid base64") from None
        return self._beside(unquote(uri))

    def _beside(self, name: str) -> bytes:
        """Return a file of the same folder; whatever the name says, nothing else is opened."""
        shown = name[:60]
        if "://" in name or ":" in name.split("/", maxsplit=1)[0]:
            raise self._fault(f"refers to {shown!r}: Retake opens no addresses")
        folder = self._path.resolve().parent
        try:
            target = (folder / name).resolve()
            if not target.is_relative_to(folder):
                raise self._fault(f"refers to {shown!r}, which is outside its folder")
            if not target.is_file() or target.stat().st_size > MAX_FILE_BYTES:
                raise self._fault(f"refers to {shown!r}, which is not there or too large")
            return target.read_bytes()
        except (OSError, ValueError) as error:
            raise self._fault(f"refers to {shown!r}, which could not be read") from error
