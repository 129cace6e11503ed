"""No sentence says "1 frames": a number before a noun goes through `counted`, or through `plural` where it stands apart."""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
NOUNS = (
    "accessors|buffers|controls|corners|curves|dots|edits|faces|fills|findings|files|flags|frames|labels|landmarks|lanes|"
    "markers|meshes|movies|names|nodes|notes|others|packets|phones|pieces|pins|points|rows|samples|shapes|spans|steps|"
    "takes|tracks|triangles|values|variants|vertices|views|visemes|weights|words"
)
# "{count} frames" and "{count} lost frames"; ranges such as frames 3:9 begin otherwise
FOLLOWED = re.compile(rf"^ (?:[a-z]+ ){{0,2}}(?:{NOUNS})\b")
# What is shown to those who train networks and measure them, never to who edits a take.
MEASURES = ("engine/lab", "app/bench")
NAMES = ("name", "control", "undo", "fill", "frame", "text")
SURELY_MANY = (
    "at most",
    "MAX_FILES",
    "frames a second",
    "says it has",
    "of the file",
    "more than can be held",
    "per second",
    "len(SHAPES)} ",
)


def naive(path: Path) -> list[str]:
    """Return the places of a module that put a noun in the plural behind any number."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.JoinedStr) or any(words in ast.unparse(node) for words in SURELY_MANY):
            continue
        for value, after in zip(node.values, node.values[1:], strict=False):
            told = isinstance(after, ast.Constant) and FOLLOWED.match(str(after.value))
            if isinstance(value, ast.FormattedValue) and told and not _is_a_name(value.value):
                found.append(f"{path.name}:{node.lineno}: {{{ast.unparse(value.value)}}}{after.value}")
    return found


def _is_a_name(value: ast.expr) -> bool:
    """Return whether a value is no number, by what it is called: "take.csv names a column twice"."""
    return ast.unparse(value).endswith(NAMES) or ast.unparse(value).startswith(("plain(", "counted("))


def test_numbers_agree_with_their_nouns() -> None:
    modules = [path for folder in ("app", "engine") for path in sorted((ROOT / folder).rglob("*.py"))]
    shown = [path for path in modules if not str(path.relative_to(ROOT)).startswith(MEASURES)]
    found = [place for path in shown if "train" not in path.name for place in naive(path)]
    assert len(shown) > 150 and found == []


def test_the_search_finds_what_it_is_for(tmp_path: Path) -> None:
    lines = (
        'f"{n} frames"',
        'f"{n:,} of {m} lost frames"',
        'f"{path.name} names no shape"',
        "f\"{counted(n, 'frame')}.\"",
    )
    (tmp_path / "example.py").write_text("\n".join(lines))
    assert [place.split(":")[1] for place in naive(tmp_path / "example.py")] == ["1", "2"]
