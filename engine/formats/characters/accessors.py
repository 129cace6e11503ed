"""Numbers out of a glTF file's buffers: nothing is read beyond a buffer, nothing is fetched, no path leaves the folder."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

from engine.errors import FormatError
from engine.formats.characters.raw import MAX_VERTICES

TYPES: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
Structure = dict[str, Any]  # the file's JSON, or an object in it
MAX_INDICES = 6 * MAX_VERTICES
MAX_FILE_BYTES = 1 << 30


class Accessors:
    """The accessors of one file.

    Parameters
    ----------
    scene : the file's JSON
    binary : its binary chunk, empty where it has none
    path : of the file; buffers beside it are found in its folder
    """

    def __init__(self, scene: Structure, binary: memoryview, path: Path) -> None:
        self._scene, self._binary, self._path = scene, binary, path
        self._buffers: dict[int, memoryview] = {}

    def count(self, index: Any) -> int:
        """Return how many entries an accessor declares: what to ask the budget for before reading it."""
        return int(self._accessor(index)["count"])

    def stored(self, index: Any) -> bool:
        """Return whether an accessor's values are in a buffer; others are zero, a tiny file can declare any number."""
        return self._accessor(index).get("bufferView") is not None

    def name(self, index: Any) -> str:
        """Return what the file calls an accessor, empty where it says nothing."""
        return str(self._accessor(index).get("name") or "")

    def vectors(self, index: Any, *, wanted: int | None = None, what: str = "mesh") -> npt.NDArray[np.float32]:
        """Return (count, 3); raises `FormatError` where there are not as many as wanted."""
        count = self.count(index)
        if wanted is not None and count != wanted:
            raise self._fault(f"has {count} vertices in its shape {what!r}, {wanted} in its mesh")
        if count > MAX_VERTICES:
            raise self._fault(f"declares {count} vertices; a character has at most {MAX_VERTICES}")
        return self.floats(index, "VEC3", what=what)

    def floats(self, index: Any, kind: str, *, what: str) -> npt.NDArray[np.float32]:
        """Return (count, width of the kind), whole numbers that stand for 0..1 or -1..1 divided down."""
        accessor = self._accessor(index, kind)
        values = self._values(accessor, WIDTHS[kind])
        with np.errstate(over="ignore"):
            result = values.astype(np.float32)
        if accessor.get("normalized") and values.dtype.kind in "iu":
            result = np.maximum(result / np.float32(np.iinfo(values.dtype).max), np.float32(-1.0))
        if not np.isfinite(result).all():
            raise self._fault(f"has a value that is not a finite number in its {what}")
        return result

    def indices(self, index: Any) -> npt.NDArray[np.int64]:
        """Return (count,) vertex numbers."""
        accessor = self._accessor(index, "SCALAR")
        if accessor["count"] > MAX_INDICES or self._type(accessor.get("componentType")).kind != "u":
            raise self._fault(f"declares {accessor['count']} corners of faces in a form that cannot be read")
        return self._values(accessor, 1)[:, 0].astype(np.int64)

    def joints(self, index: Any) -> npt.NDArray[np.int64]:
        """Return (count, 4) numbers of joints."""
        accessor = self._accessor(index, "VEC4")
        if accessor["count"] > MAX_VERTICES or self._type(accessor.get("componentType")).kind != "u":
            raise self._fault("names the joints of its skin in a form that cannot be read")
        return self._values(accessor, 4).astype(np.int64)

    def _fault(self, what: str) -> FormatError:
        return FormatError(f"{self._path.name} {what}.")

    def _accessor(self, index: Any, kind: str | None = None) -> Structure:
        accessors = self._scene.get("accessors") or []
        if type(index) is not int or not 0 <= index < len(accessors):
            raise self._fault(f"names accessor {str(index)[:20]}; it has {len(accessors)}")
        accessor: Structure = accessors[index]
        count = accessor.get("count")
        if (kind is not None and accessor.get("type") != kind) or type(count) is not int or count < 0:
            raise self._fault(f"has an accessor of the wrong kind: number {index}")
        return accessor

    def _type(self, component: Any) -> np.dtype[Any]:
        if type(component) is not int or component not in TYPES:
            raise self._fault(f"has numbers of an unknown kind: {str(component)[:20]}")
        return TYPES[component]

    def _values(self, accessor: Structure, width: int) -> npt.NDArray[Any]:
        """Return (count, width) in the file's type, sparse corrections applied."""
        dtype = self._type(accessor.get("componentType"))
        if accessor.get("bufferView") is not None:
            values = self._strided(accessor, accessor["count"], width, dtype)
        else:
            values = np.zeros((accessor["count"], width), dtype)  # the count is limited before
        if accessor.get("sparse") is not None:
            values = self._corrected(values, accessor["sparse"], dtype)
        return values

    def _corrected(self, values: npt.NDArray[Any], sparse: Structure, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        count, indices, replaced = sparse.get("count"), sparse["indices"], sparse["values"]
        kind = self._type(indices.get("componentType"))
        if type(count) is not int or not 0 <= count <= len(values) or kind.kind != "u":
            raise self._fault(f"corrects {str(count)[:20]} values of {len(values)}")
        where = self._strided(indices, count, 1, kind)[:, 0]
        if len(where) and where.max() >= len(values):
            raise self._fault(f"corrects value {where.max()} of {len(values)}")
        result = values.copy()
        result[where] = self._strided(replaced, count, values.shape[1], dtype)
        return result

    def _strided(self, placed: Structure, count: int, width: int, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        """Return (count, width) out of the buffer view that `placed` names; products are Python's whole numbers."""
        number, offset = placed.get("bufferView"), placed.get("byteOffset") or 0
        views = self._scene.get("bufferViews") or []
        if type(number) is not int or not 0 <= number < len(views):
            raise self._fault(f"names buffer view {str(number)[:20]}; it has {len(views)}")
        view = views[number]
        start, length = view.get("byteOffset") or 0, view.get("byteLength")
        item = width * dtype.itemsize
        stride = view.get("byteStride") or item
        if not all(type(size) is int for size in (start, length, stride, offset)):
            raise self._fault(f"has a size that is not a whole number in buffer view {number}")
        if min(start, length, offset) < 0 or stride < item:
            raise self._fault(f"has an impossible size in buffer view {number}")
        buffer = self._buffer(view.get("buffer"))
        if start + length > len(buffer):
            raise self._fault(f"has a buffer view that ends at byte {start + length} of a buffer of {len(buffer)}")
        needed = offset + (stride * (count - 1) + item if count else 0)
        if needed > length:
            raise self._fault(f"declares {needed} bytes of numbers in a buffer view of {length}")
        return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))

    def _buffer(self, index: Any) -> memoryview:
        buffers = self._scene.get("buffers") or []
        if type(index) is not int or not 0 <= index < len(buffers):
            raise self._fault(f"names buffer {str(index)[:20]}; it has {len(buffers)}")
        if index not in self._buffers:
            content = self._content(buffers[index].get("uri"))
            declared = buffers[index].get("byteLength")
            if type(declared) is not int or declared > len(content):
                raise self._fault(f"declares a buffer of {str(declared)[:20]} bytes and holds {len(content)}")
            self._buffers[index] = memoryview(content)
        return self._buffers[index]

    def _content(self, uri: Any) -> bytes | memoryview:
        if uri is None:
            return self._binary
        if not isinstance(uri, str):
            raise self._fault("has a buffer whose place is no text")
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
