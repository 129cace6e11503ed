"""Which module imports which, read from the code itself: imports within functions count as those at the top."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
Graph = dict[str, set[str]]


def modules(root: Path, packages: tuple[str, ...]) -> dict[str, Path]:
    """Return every module below some packages by its dotted name."""
    found = {}
    for path in (path for package in packages for path in (root / package).rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def running(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes but those that only a type checker looks at."""
    yield tree
    for child in ast.iter_child_nodes(tree):
        if not (isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)):
            yield from running(child)


def imported(source: str, known: set[str]) -> set[str]:
    """Return the known modules that a module imports, wherever in it."""
    found = set()
    for node in running(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            each = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= each & known or {node.module}
            if each - known:
                found.add(node.module)
    return found & known


def circles(graph: Graph) -> list[set[str]]:
    """Return the strongly connected components of more than one module (Tarjan 1972)."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found = []

    def visit(node: str) -> None:
        order[node] = low[node] = len(order)
        stack.append(node)
        for other in graph[node]:
            if other not in order:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == order[node]:
            at = stack.index(node)
            found.append(set(stack[at:]))
            del stack[at:]

    for node in graph:
        if node not in order:
            visit(node)
    return [component for component in found if len(component) > 1]


@pytest.mark.parametrize("package", ["engine", "app"])
def test_no_module_imports_itself_by_way_of_others(package: str) -> None:
    every = modules(ROOT, ("engine", "app"))
    graph = {name: imported(path.read_text(), set(every)) - {name} for name, path in every.items()}
    assert sum(map(len, graph.values())) > 1000
    assert [sorted(circle) for circle in circles(graph) if any(name.split(".")[0] == package for name in circle)] == []


@pytest.mark.parametrize(
    ("sources", "expected"),
    [
        ({"a": "import b", "b": "def f():\n    from a import g"}, [{"a", "b"}]),
        ({"a": "import b", "b": "import c", "c": "import b"}, [{"b", "c"}]),
        ({"a": "import b, c", "b": "import c", "c": ""}, []),
        ({"a": "import b", "b": "if TYPE_CHECKING:\n    import a"}, []),
        ({"p": "from p.q import x", "p.q": "from p import r", "p.r": ""}, []),
        ({"p": "from p import q", "p.q": "from p import x", "p.r": ""}, [{"p", "p.q"}]),
    ],
)
def test_a_circle_is_found_however_it_is_written(sources: dict[str, str], expected: list[set[str]]) -> None:
    graph = {name: imported(source, set(sources)) - {name} for name, source in sources.items()}
    assert circles(graph) == expected
