from __future__ import annotations

import zlib

import numpy as np
import pytest

from engine.project import blobs
from engine.project.blobs import Budget, DamagedError, pack, unpack, unpack_bytes

RNG = np.random.default_rng(0)
ARRAYS = {
    "curves": RNG.random((300, 52)),
    "still": np.zeros((5000, 52)),
    "numbers": np.arange(700),
    "marks": RNG.random(900) < 0.5,
    "nothing": np.zeros((0, 52)),
    "big-endian": RNG.random((9, 3)).astype(">f8"),
    "turned": RNG.random((52, 30)).T,
}


def whole(array: np.ndarray) -> bytes:
    return b"".join(pack(array))


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_come_back_to_the_bit(name: str) -> None:
    array = ARRAYS[name]
    kind = {"f": "<f8", "i": "<i8", "b": "u1"}[array.dtype.kind]
    found = unpack(whole(array), array.shape, kind, Budget(10**9))
    np.testing.assert_array_equal(found, array)
    assert found.shape == array.shape


def test_a_large_array_comes_in_pieces_of_its_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blobs, "PIECE_BYTES", 1000)
    pieces = pack(ARRAYS["curves"])
    assert len(pieces) == -(-300 * 52 * 8 // 1000) + 1
    assert zlib.decompress(b"".join(pieces)) == ARRAYS["curves"].tobytes()


def test_only_what_shrinks_to_half_is_compressed() -> None:
    assert len(whole(ARRAYS["curves"])) >= 300 * 52 * 8
    half = np.zeros((4000, 4))
    half[:, 0] = RNG.random(4000)
    assert len(whole(half)) < 0.5 * half.nbytes
    most = np.zeros((4000, 3))
    most[:, :2] = RNG.random((4000, 2))
    assert len(whole(most)) > most.nbytes


def test_large_arrays_are_never_packed_more_tightly_than_they_may_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blobs, "LARGE_BYTES", 100_000)
    assert len(whole(np.zeros(200_000))) > 1_000_000
    assert len(whole(np.zeros(10_000))) < 1_000


@pytest.mark.parametrize("count", [0, 1, 4096, 5001])
def test_bytes_of_another_number_are_damage(count: int) -> None:
    packed = zlib.compress(bytes(count))
    assert unpack_bytes(packed, count, Budget(0)) == bytes(count)
    for wrong in {count + 1, max(0, count - 1)} - {count}:
        with pytest.raises(DamagedError, match="another number of values"):
            unpack_bytes(packed, wrong, Budget(0))
    for broken, says in (
        (packed[:-1], "another number"),
        (packed + b"x", "another number"),
        (b"junk", r"unpacked|missing"),
    ):
        with pytest.raises(DamagedError, match=says):
            unpack_bytes(broken, count, Budget(0))
    for none in (None, "text", 5):
        with pytest.raises(DamagedError, match="values are missing"):
            unpack_bytes(none, count, Budget(0))


def test_more_than_a_stream_can_hold_is_refused_before_it_is_unpacked() -> None:
    with pytest.raises(DamagedError, match="values are missing"):
        unpack_bytes(b"1234567890", 10 * 1032 + 65, Budget(10**9))
    with pytest.raises(DamagedError, match=r"another number|cannot be unpacked"):
        unpack_bytes(b"1234567890", 10 * 1032 + 64, Budget(10**9))
    with pytest.raises(DamagedError, match="values are missing"):
        unpack(b"", (10**12, 10**12), "<f8", Budget(0))


def test_a_file_unpacks_to_no_more_than_its_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blobs, "ORDINARY_BYTES", 1000)
    for file_bytes, left in ((0, 1000), (15, 1000), (16, 1024), (100, 6400)):
        assert Budget(file_bytes).left == left
    budget = Budget(0)
    budget.take(600)
    budget.take(400)
    with pytest.raises(DamagedError, match="more than it can hold"):
        budget.take(1)
    assert budget.left == 0
