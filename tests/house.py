"""The house in figures and in one picture: `python -m tests.house` prints figures, `--write` puts the picture into ARCHITECTURE.md.

The picture is drawn from the imports themselves (those within functions too). An arrow from A to B says that A imports
B; arrows that follow from others are left out.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from tests.test_imports import Graph, imported, modules

ROOT = Path(__file__).parents[1]
LONG_FUNCTION, LONG_FILE = 50, 350
METHODS = ("regress", "inpaint", "clean", "spacetime", "manifold", "models")
BEGIN, END = "<!-- house: begin -->\n", "<!-- house: end -->\n"
# A room of the picture and the modules in it, by the beginning of their names; the first that fits.
ROOMS = {
    "lab": ("engine.lab",),
    "editing": ("engine.editing", "engine.patch", "engine.retouch"),
    "methods": tuple(f"engine.{name}" for name in METHODS),
    "review": ("engine.review", "engine.quality"),
    "project": ("engine.project",),
    "live": ("engine.live",),
    "speech": ("engine.speech",),
    "formats": ("engine.formats",),
    "take": ("engine",),
    "cli": ("app.cli", "app.__main__", "app.main_job"),
    "bench": ("app.bench",),
    "window": ("app.window",),
    "actions": ("app.actions",),
    "session": ("app.session", "app.background", "app.printing", "app.settings", "app.theme"),
    "panels": ("app",),
}
TITLES = {
    "take": "take, character, controls, anatomy, errors",
    "methods": "regress · inpaint · clean · spacetime · manifold · models",
    "editing": "editing: one function per verb",
    "lab": "lab: trains, measures, builds",
    "session": "session: document, view, edits, keeper",
    "panels": "panels: curves, timeline, preview, spans, review, …",
}


def room_of(module: str) -> str:
    """Return the room that a module is in."""
    return next(room for room, begins in ROOMS.items() if any(f"{module}.".startswith(f"{begin}.") for begin in begins))


def rooms(root: Path = ROOT) -> Graph:
    """Return which room imports which, directly."""
    paths = modules(root, ("app", "engine"))
    graph: Graph = {room: set() for room in ROOMS}
    for module, path in paths.items():
        if module in ("app", "engine"):
            continue
        here = room_of(module)
        graph[here] |= {
            room_of(each) for each in imported(path.read_text(), set(paths)) if each not in ("app", "engine")
        }
    return {room: others - {room} for room, others in graph.items()}


def reduced(graph: Graph) -> Graph:
    """Return a graph without the arrows that follow from others; of rooms that import each other every arrow stays."""
    reach = {room: reached(graph, room) for room in graph}

    def follows(room: str, other: str) -> bool:
        """Return whether an arrow follows from two others, neither of which runs within a circle."""
        between = graph[room] - {other}
        return any(other in reach[each] and each not in reach[other] and room not in reach[each] for each in between)

    return {room: {other for other in others if not follows(room, other)} for room, others in graph.items()}


def reached(graph: Graph, start: str) -> frozenset[str]:
    """Return all rooms that one leads to."""
    seen: frozenset[str] = frozenset()
    ahead = set(graph[start])
    while ahead:
        room = ahead.pop()
        seen |= {room}
        ahead |= graph[room] - seen
    return seen


def picture(graph: Graph) -> str:
    """Return a graph of rooms as a Mermaid flow chart."""
    lines = ["```mermaid", "flowchart TD"]
    for house in ("app", "engine"):
        lines.append(f"  subgraph {house}")
        inside = [room for room, begins in ROOMS.items() if begins[0].split(".")[0] == house]
        lines += [f'    {room}["{TITLES.get(room, room)}"]' for room in inside]
        lines.append("  end")
    lines += [f"  {room} --> {other}" for room in graph for other in sorted(graph[room])]
    return "\n".join([*lines, "```"]) + "\n"


def functions(path: Path) -> Iterator[tuple[str, int]]:
    """Yield the functions of a file with their numbers of lines."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.end_lineno is not None
            yield node.name, node.end_lineno - node.lineno + 1


def without_mirror(paths: Iterable[Path], root: Path = ROOT) -> list[Path]:
    """Return the files that no test file mirrors: tests/a/test_b.py, or test_b_*.py, for a/b.py."""
    return [
        path
        for path in paths
        if not list((root / "tests" / path.relative_to(root).parent).glob(f"test_{path.stem}.py"))
        and not list((root / "tests" / path.relative_to(root).parent).glob(f"test_{path.stem}_*.py"))
    ]


def figures(root: Path = ROOT) -> str:
    """Return lines per folder and what is too long, too near or untested, as text."""
    paths = modules(root, ("app", "engine"))
    by_folder: dict[str, int] = {}
    for path in paths.values():
        folder = "/".join(path.relative_to(root).parts[:2])
        by_folder[folder] = by_folder.get(folder, 0) + path.read_text().count("\n")
    long_files = [path for path in paths.values() if path.read_text().count("\n") > LONG_FILE]
    long_functions = [name for path in paths.values() for name, lines in functions(path) if lines > LONG_FUNCTION]
    methods = {f"engine.{name}" for name in METHODS}
    near = [
        f"{module} -> {other}"
        for module, path in paths.items()
        if module.startswith("app.")
        for other in imported(path.read_text(), set(paths))
        if ".".join(other.split(".")[:2]) in methods
    ]
    engine = [p for m, p in paths.items() if m.startswith("engine.") and "lab" not in m and p.name != "__init__.py"]
    untested = without_mirror(engine, root)
    rows = [f"{lines:7,} lines  {folder}" for folder, lines in sorted(by_folder.items())]
    rows += [
        f"files over {LONG_FILE} lines: {len(long_files)} {[p.name for p in long_files]}",
        f"functions over {LONG_FUNCTION} lines: {len(long_functions)} {long_functions}",
        f"imports of methods in app: {len(near)} {near}",
        f"engine modules without a mirror test: {len(untested)} of {len(engine)} {[p.stem for p in untested]}",
    ]
    return "\n".join(rows)


def write(page: Path = ROOT / "ARCHITECTURE.md") -> None:
    """Put the picture into the page."""
    text = page.read_text()
    before, after = text[: text.index(BEGIN) + len(BEGIN)], text[text.index(END) :]
    page.write_text(before + picture(reduced(rooms())) + after)


if __name__ == "__main__":
    if "--write" in sys.argv:
        write()
    print(figures())
