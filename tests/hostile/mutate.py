"""Mutations that know what they mutate: text by its numbers and lines, JSON by its values, archives by their members."""

from __future__ import annotations

import io
import json
import random
import re
import sqlite3
import struct
import zipfile
import zlib
from collections.abc import Callable
from typing import Any

Random = random.Random
Mutation = Callable[[bytes, Random], bytes]

NUMBERS = (
    *("0", "-0", "1", "-1", "0.5", "1e308", "-1e308", "1e309", "1e-320", "5e-324", "nan", "NaN", "inf", "-Infinity"),
    *(
        "2147483647",
        "-2147483648",
        "4294967296",
        "9223372036854775808",
        "1" + "0" * 400,
        "9" * 30,
        "0x10",
        "1_0",
        "1,5",
    ),
    *("", " ", "٣", "1e", "--1", "1.2.3", "1000000", "99999999", "60", "-60"),
)
TEXTS = (
    *("", " ", "\0", "a", "\x1b[31m", "<img src=x>", "\u202e", "é", "顔", "\ud7ff", "%s%n", "../../x", "/dev/zero"),
    *("file:///etc/passwd", "A" * 5_000, "[" * 5_000, '"' * 999, "\n" * 999, "jawOpen", "null", "true", "1e308"),
)
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 2**31, 2**63, 2**64, 10**400, 1e308, -1e308, 5e-324, float("nan"), float("inf")),
    *("", "x", "\0", "\x1b[31m", "A" * 5_000, [], {}, [[]], [1, 2], {"a": 1}, "1", "nan", 0.5, -0.5, 1_000_000, 65_535),
)
WORDS = (0, 1, 2, 3, 7, 255, 256, 0x7FFF, 0x8000, 0xFFFF, 0x10000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 10**6, 10**8)
_NUMBER = re.compile(rb"-?\d[\d.eE+-]*")
_LARGEST = 1 << 20  # of a mutated file: what small files do is asked here


def text(content: bytes, rng: Random) -> bytes:
    """Change a text: a number, a word, a line, a character, or where it ends."""
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        content = rng.choice(_TEXT)(content, rng)[:_LARGEST]
    return content


def _number(content: bytes, rng: Random) -> bytes:
    found = _some(_NUMBER, content, rng)
    if found is None:
        return content
    return content[: found.start()] + rng.choice(NUMBERS).encode() + content[found.end() :]


def _some(pattern: re.Pattern[bytes], content: bytes, rng: Random) -> re.Match[bytes] | None:
    """Return a match near a place by chance: looking through all of a long text would be most of the time."""
    return pattern.search(content, rng.randrange(len(content) + 1)) or pattern.search(content)


def _word(content: bytes, rng: Random) -> bytes:
    found = _some(_WORD, content, rng)
    if found is None:
        return content
    return content[: found.start()] + rng.choice(TEXTS).encode("utf-8", "surrogatepass") + content[found.end() :]


_WORD = re.compile(rb"[A-Za-z_]+")


def _line(content: bytes, rng: Random) -> bytes:
    lines = content.split(b"\n")
    at = rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines[at:at] = [lines[at]] * rng.choice((1, 2, 50, 2_000))
    elif kind == 2:
        other = rng.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        cells = re.split(rb"([,;\t])", lines[at])
        lines[at] = b"".join(cells[: rng.randrange(len(cells) + 1)] * rng.choice((1, 1, 2, 500)))
    else:
        lines = lines[: at + 1]
    return b"\n".join(lines)


def _insert(content: bytes, rng: Random) -> bytes:
    at = rng.randrange(len(content) + 1)
    piece = rng.choice(
        (*(text.encode("utf-8", "surrogatepass") for text in TEXTS), b"\xff", b"\xfe\xff", b"\r", b",", b'"')
    )
    return content[:at] + piece * rng.choice((1, 1, 1, 3, 200)) + content[at:]


def _cut(content: bytes, rng: Random) -> bytes:
    first, last = sorted((rng.randrange(len(content) + 1), rng.randrange(len(content) + 1)))
    return content[:first] + content[last:] if rng.random() < 0.5 else content[:last]


def _encoded(content: bytes, rng: Random) -> bytes:
    return content.decode("utf-8", "replace").encode(
        rng.choice(("utf-16", "utf-16-be", "utf-8-sig", "cp037")), "replace"
    )


def _doubled(content: bytes, rng: Random) -> bytes:
    return content * rng.choice((2, 3, 20))


def _flip(content: bytes, rng: Random) -> bytes:
    changed = bytearray(content)
    for _ in range(rng.choice((1, 1, 3, 30)) if changed else 0):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


_TEXT: tuple[Mutation, ...] = (
    *(_number, _number, _number, _number, _word, _word, _line, _line, _line, _insert, _cut, _flip),
    *(_encoded, _doubled),
)


def binary(content: bytes, rng: Random) -> bytes:
    """Change bytes: some of them, a whole number of 16, 32 or 64 bits, a stretch, or where they end."""
    for _ in range(rng.choice((1, 1, 2, 5))):
        content = rng.choice((_flip, _flip, _whole, _whole, _whole, _cut, _stretch))(content, rng)[:_LARGEST]
    return content


def _whole(content: bytes, rng: Random) -> bytes:
    code = rng.choice(("<H", ">H", "<I", ">I", ">I", "<I", "<Q", ">Q", "<f", ">f", "<d"))
    size = struct.calcsize(code)
    if len(content) < size:
        return content
    at = (
        rng.randrange(len(content) - size + 1)
        if rng.random() < 0.5
        else rng.randrange(min(600, len(content) - size + 1))
    )
    whole = rng.choice(WORDS)
    value: Any = (
        rng.choice((float("nan"), float("inf"), 1e30, -1e-30, 0.0)) if code[1] in "fd" else whole % (1 << 8 * size)
    )
    return content[:at] + struct.pack(code, value) + content[at + size :]


def _stretch(content: bytes, rng: Random) -> bytes:
    first, last = sorted((rng.randrange(len(content) + 1), rng.randrange(len(content) + 1)))
    last = min(last, first + 4096)
    piece = content[first:last]
    return content[:first] + rng.choice((piece * 2, bytes(len(piece)), piece[::-1], piece * 50)) + content[last:]


def document(content: bytes, rng: Random) -> bytes:
    """Change values of a JSON document; now and then its text."""
    if rng.random() < 0.25:
        return text(content, rng)
    held = json.loads(content)
    for _ in range(rng.choice((1, 1, 2, 5))):
        content = json.dumps(_changed(held, rng)).encode("utf-8", "surrogatepass")[:_LARGEST]
        if len(content) > _LARGEST // 16:  # a hundred of a hundred of a hundred
            break
        held = json.loads(content)
    return content


def _changed(held: Any, rng: Random) -> Any:
    """Return a document with one of its values changed, repeated, renamed or left out."""
    if isinstance(held, dict | list) and held and rng.random() < 0.93:
        keys = list(held) if isinstance(held, dict) else list(range(len(held)))
        key = rng.choice(keys)
        if rng.random() < 0.06:
            del held[key]
        elif rng.random() < 0.05 and isinstance(held, list):
            held[key:key] = [held[key]] * rng.choice((1, 3, 100))
        elif rng.random() < 0.04 and isinstance(held, dict):
            held[rng.choice(TEXTS[:12])] = held.pop(key)
        else:
            held[key] = _changed(held[key], rng)
        return held
    if rng.random() < 0.03:
        for _ in range(rng.choice((5, 200, 900))):
            held = [held]
        return held
    if isinstance(held, int | float) and rng.random() < 0.3:
        return rng.choice((held + 1, held - 1, -held, held * 10**6, held / 3))
    return rng.choice(VALUES)


def archive(content: bytes, rng: Random) -> bytes:
    """Change an npz: the header or the values of one of its arrays, or the bytes of the whole."""
    if rng.random() < 0.3:
        return binary(content, rng)
    with zipfile.ZipFile(io.BytesIO(content)) as file:
        members = {name: file.read(name) for name in file.namelist()}
    name = rng.choice(list(members))
    if rng.random() < 0.7:
        head, data = members[name][:10], members[name][10:]
        size = struct.unpack("<H", head[8:10])[0]
        header = text(data[:size], rng)[:60_000]
        members[name] = head[:8] + struct.pack("<H", len(header)) + header + data[size:]
    elif rng.random() < 0.8:
        head = members[name][:128]
        members[name] = head + binary(members[name][128:], rng)
    else:
        members[rng.choice(TEXTS[3:12]) or "x"] = members.pop(name)
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_STORED) as file:
        for name, data in members.items():
            file.writestr(name.replace("\0", "_"), data)
    return made.getvalue()


def bundle(content: bytes, rng: Random) -> bytes:
    """Change a zip of texts: one of them, its name, or the bytes of the whole."""
    if rng.random() < 0.4:
        return binary(content, rng)
    with zipfile.ZipFile(io.BytesIO(content)) as file:
        members = {name: file.read(name) for name in file.namelist()}
    name = rng.choice(list(members))
    if rng.random() < 0.8:
        members[name] = (document if name.endswith(".json") else text)(members[name], rng)
    else:
        members[rng.choice(TEXTS).replace("\0", "_")[:99] + name[-4:]] = members.pop(name)
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in members.items():
            file.writestr(name, data)
    return made.getvalue()


def scene(content: bytes, rng: Random) -> bytes:
    """Change a GLB: the JSON of its scene, its binary, or the bytes of the whole."""
    if rng.random() < 0.15:
        return binary(content, rng)
    size = struct.unpack("<I", content[12:16])[0]
    head, rest = content[20 : 20 + size], content[20 + size :]
    head = document(head, rng) if rng.random() < 0.85 else head
    rest = rest if rng.random() < 0.8 else rest[:8] + binary(rest[8:], rng)
    head += b" " * (-len(head) % 4)
    chunks = struct.pack("<I4s", len(head), b"JSON") + head + rest
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def tensors(content: bytes, rng: Random) -> bytes:
    """Change a safetensors file: its header, the configuration in it, or the bytes of the whole."""
    if rng.random() < 0.2:
        return binary(content, rng)
    size = struct.unpack("<Q", content[:8])[0]
    held = json.loads(content[8 : 8 + size])
    if rng.random() < 0.6:
        meta = held["__metadata__"]
        meta["config"] = document(meta["config"].encode(), rng).decode("utf-8", "replace")
    else:
        held = _changed(held, rng)
    header = json.dumps(held).encode("utf-8", "surrogatepass")
    return struct.pack("<Q", len(header)) + header + content[8 + size :]


def database(content: bytes, rng: Random) -> bytes:
    """Change a project: a value of one of its rows, rows by the thousand, or the bytes of the file."""
    if rng.random() < 0.2:
        return binary(content, rng)
    store = sqlite3.connect(":memory:", isolation_level=None)
    try:
        store.deserialize(content[:18] + b"\x01\x01" + content[20:])  # in memory there is no log beside it
        for _ in range(rng.choice((1, 1, 2))):
            _statement(store, rng)
        return store.serialize()
    except (sqlite3.Error, OverflowError, UnicodeError):
        return content
    finally:
        store.close()


def _statement(store: sqlite3.Connection, rng: Random) -> None:
    tables = [name for (name,) in store.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
    table = rng.choice(tables)
    columns = [row[1] for row in store.execute(f"PRAGMA table_info({table})")]
    column = rng.choice(columns[1:])
    if rng.random() < 0.1:
        count = rng.choice((1, 50, 3_000))
        rest = ", ".join(columns[1:])
        store.execute(f"INSERT INTO {table} SELECT {columns[0]} + 1000 + n, {rest} FROM {table}, ({_counted(count)})")
        return
    if rng.random() < 0.05:
        store.execute(f"DELETE FROM {table}")
        return
    row = store.execute(f"SELECT {column} FROM {table} LIMIT 1").fetchone()
    store.execute(f"UPDATE {table} SET {column} = ?", (_stored(row[0] if row else None, rng),))


def _counted(count: int) -> str:
    return f"WITH RECURSIVE c(n) AS (SELECT 0 UNION ALL SELECT n + 1 FROM c WHERE n < {count - 1}) SELECT n FROM c"


_BOMB = zlib.compress(bytes(50 << 20))


def _stored(value: Any, rng: Random) -> Any:
    """Return another value for a column that holds this one."""
    if isinstance(value, bytes):
        packed = (bytes(10_000), b"\xff" * 24, b"", rng.randbytes(200))
        return rng.choice((binary(value, rng), *map(zlib.compress, packed), _BOMB, b""))
    if isinstance(value, str) and value[:1] in ("{", "["):
        return document(value.encode(), rng).decode("utf-8", "replace")
    if isinstance(value, str):
        return rng.choice(TEXTS).encode("utf-8", "surrogatepass").decode("utf-8", "replace")
    return rng.choice(
        [each for each in VALUES if isinstance(each, int | float) and abs(each) < 2**63] + [2**62, 1e-320]
    )
