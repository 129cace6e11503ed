"""Asks whether the tests would notice: python -m tests.mutants --seed 0 --count 200 [PATHS].

Each mutant changes one comparison, sign, constant, `and` or `or` of one module and is run against the module's own
mirror tests: of `engine/x/y.py` those are `tests/engine/x/test_y.py` and `tests/engine/x/test_y_*.py`. All of this
happens in a copy outside the working tree, so that a kill leaves nothing behind in it. A mutant that no test notices
survives: it is printed with its place and its change. Some survivors change nothing that could be seen.
"""

from __future__ import annotations

import ast
import importlib
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from scipy.stats import binomtest

ROOT = Path(__file__).parents[1]
LIVES = (Path("engine"), Path("app/session"), Path("app/curves"), Path("app/timeline"))
APART = Path("engine/lab")
COPIED = ("app", "engine", "tests")
SHORTEST_LIMIT_S, LIMIT_RATIO = 20.0, 6.0  # time of a mutant: so much, or so many times what its tests take without it
FORK = multiprocessing.get_context("fork")
OPPOSITES: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.USub: (ast.UAdd,),
}
SHORT = (ast.expr, ast.keyword, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Return)  # what a change is shown in
TYPES = ("annotation", "returns", "decorator_list")  # fields of a node whose content does not run as it is written


@dataclass(frozen=True)
class Mutant:
    """A change to one module.

    Attributes
    ----------
    module : path of the module below the root
    line : of the change
    before, after : the smallest expression around it
    source : the whole module with the change
    """

    module: Path
    line: int
    before: str
    after: str
    source: str


@dataclass(frozen=True)
class Site:
    """A place in a module where something can be changed: the `number`-th of its nodes, in the `choice`-th way."""

    module: Path
    number: int
    choice: int


def modules_of(paths: Iterable[Path], root: Path = ROOT) -> list[Path]:
    """Return the modules at or below paths of a project, without those that train, measure and build."""
    found: set[Path] = set()
    for path in paths:
        files = [path] if path.suffix == ".py" else (root / path).rglob("*.py")
        found |= {(root / file).relative_to(root) for file in files}
    return sorted(module for module in found if APART not in module.parents)


def sites_of(module: Path, root: Path = ROOT) -> list[Site]:
    """Return the places of a module that can be changed, one for each way to change it."""
    nodes = _nodes(ast.parse((root / module).read_text(encoding="utf-8")))
    return [
        Site(module, number, choice) for number, (node, _) in enumerate(nodes) for choice in range(len(_changes(node)))
    ]


def mutant_at(site: Site, root: Path = ROOT) -> Mutant:
    """Return the module with the change at a site."""
    tree = ast.parse((root / site.module).read_text(encoding="utf-8"))
    node, around = _nodes(tree)[site.number]
    before = ast.unparse(around)
    name, index, changed = _changes(node)[site.choice]
    if index is None:
        setattr(node, name, changed)
    else:
        getattr(node, name)[index] = changed
    return Mutant(site.module, getattr(around, "lineno", 0), before, ast.unparse(around), ast.unparse(tree))


def _nodes(tree: ast.AST) -> list[tuple[ast.AST, ast.AST]]:
    """Return the nodes that run, each with the smallest expression around it that says something."""

    def below(node: ast.AST, around: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
        yield node, around if isinstance(node, ast.Constant) and isinstance(around, SHORT) else node
        for name, field in ast.iter_fields(node):
            for child in field if isinstance(field, list) else [field]:
                if isinstance(child, ast.AST) and name not in TYPES:
                    yield from below(child, around if isinstance(node, ast.Tuple | ast.Slice) else node)

    return list(below(tree, tree))


def _changes(node: ast.AST) -> list[tuple[str, int | None, object]]:
    """Return the ways to change a node: field, place in it where it is a list, and what to put there."""
    match node:
        case ast.Compare():
            pairs = [(at, other()) for at, op in enumerate(node.ops) for other in OPPOSITES[type(op)]]
            return [("ops", at, other) for at, other in pairs]
        case ast.BoolOp() | ast.BinOp() | ast.AugAssign() | ast.UnaryOp():
            return [("op", None, other()) for other in OPPOSITES.get(type(node.op), ())]
        case ast.Constant(value=bool()):
            return [("value", None, not node.value)]
        case ast.Constant(value=int() | float()):
            return [("value", None, node.value + 1 if isinstance(node.value, int) else 2 * node.value or 1.0)]
    return []


def tests_of(module: Path, root: Path = ROOT) -> list[Path]:
    """Return the tests that mirror a module; those of `y_z.py` are not those of `y.py`.

    A package is mirrored by the tests of its name, within its folder of tests or beside it.
    """
    folder, name, beside = root / "tests" / module.parent, module.stem, root / module.parent
    folders = [folder]
    if name == "__init__":
        folders, name, beside = [folder, folder.parent], module.parent.name, beside.parent
    longer = [f"test_{file.stem}" for file in beside.iterdir() if file.stem.startswith(f"{name}_")]
    found = [file for place in folders for file in (place / f"test_{name}.py", *place.glob(f"test_{name}_*.py"))]
    kept = [file for file in found if not any(file.stem == long or file.stem.startswith(f"{long}_") for long in longer)]
    return sorted(file.relative_to(root) for file in kept if file.exists())


class Copy:
    """A copy of the project in which modules are changed and their tests run, each time in a process of its own."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "project"
        self.root.mkdir()
        leave = shutil.ignore_patterns("__pycache__", "_assets")
        for entry in ROOT.iterdir():
            if entry.name in COPIED:
                shutil.copytree(entry, self.root / entry.name, ignore=leave)
            elif not entry.name.startswith("."):
                (self.root / entry.name).symlink_to(entry)
        self._takes_s: dict[tuple[Path, ...], float] = {}

    def notices(self, mutant: Mutant, tests: Sequence[Path]) -> bool | None:
        """Return whether a mutant fails its tests or makes them take too long; None where they fail without it."""
        takes_s = self._takes_s[tuple(tests)] if tuple(tests) in self._takes_s else self._measured(tests)
        if not takes_s:
            return None
        file = self.root / mutant.module
        original = file.read_bytes()
        file.write_text(mutant.source, encoding="utf-8")
        try:
            return self._run(tests, limit_s=max(SHORTEST_LIMIT_S, LIMIT_RATIO * takes_s)) != 0
        finally:
            file.write_bytes(original)

    def _measured(self, tests: Sequence[Path]) -> float:
        began = time.monotonic()
        passed = self._run(tests, limit_s=600.0) == 0
        self._takes_s[tuple(tests)] = time.monotonic() - began if passed else 0.0
        return self._takes_s[tuple(tests)]

    def _run(self, tests: Sequence[Path], *, limit_s: float) -> int | None:
        """Return pytest's exit code, negative for a signal, None where the time was over."""
        process = FORK.Process(target=_tested, args=(self.root, tests))
        process.start()
        process.join(limit_s)
        code = process.exitcode
        with suppress(ProcessLookupError):
            os.killpg(process.pid or 0, signal.SIGKILL)  # whatever the tests started goes with them
        process.join()
        return code


def _tested(root: Path, tests: Sequence[Path]) -> NoReturn:
    """Run pytest in a copy of the project, in this process, and end with its exit code."""
    os.setsid()
    os.chdir(root)
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    sys.dont_write_bytecode = True  # two mutants within a second may look alike to the cache
    for name in [name for name in sys.modules if name.split(".")[0] in COPIED]:
        del sys.modules[name]
    sys.path.insert(0, str(root))
    os.environ["PYTHONPATH"] = str(root)
    import pytest

    os._exit(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", *map(str, tests)]))


def _prepare() -> None:
    """Set what all runs share and import the heavy libraries once, so that each run begins with them."""
    os.nice(10)
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    os.environ.setdefault("RETAKE_DATA", str(ROOT.parent / "shared" / "data"))
    for library in ("hypothesis.strategies", "pytestqt.plugin", "scipy.optimize", "scipy.sparse.linalg", "torch"):
        importlib.import_module(library)


def main(
    paths: Annotated[list[Path] | None, typer.Argument(help="modules or folders; all by default")] = None,
    seed: Annotated[int, typer.Option(help="of the drawing of mutants")] = 0,
    count: Annotated[int, typer.Option(help="how many mutants")] = 200,
) -> None:
    """Draw mutants at random, run their tests, and print who survived and what share was noticed."""
    _prepare()
    with tempfile.TemporaryDirectory(prefix="mutants") as folder:
        copy = Copy(Path(folder))
        sites = [site for module in modules_of(paths or LIVES, copy.root) for site in sites_of(module, copy.root)]
        drawn = random.Random(seed).sample(
            sites, min(count, len(sites))
        )  # in no order: what has run so far is a sample
        noticed = judged = 0
        for site in drawn:
            mutant, tests = mutant_at(site, copy.root), tests_of(site.module, copy.root)
            found = copy.notices(mutant, tests) if tests else False
            judged, noticed = judged + (found is not None), noticed + bool(found)
            if not found:
                why = "" if tests else "   (no mirror test)"
                why = "   (its tests fail without it: not counted)" if found is None else why
                print(f"{mutant.module}:{mutant.line}: {mutant.before}  ->  {mutant.after}{why}", flush=True)
            print(f"{noticed} of {judged}", end="\r", file=sys.stderr, flush=True)
    share = binomtest(noticed, max(1, judged)).proportion_ci(method="wilson")
    print(f"{noticed} of {judged} noticed: {noticed / max(1, judged):.1%}, 95 % {share.low:.1%} to {share.high:.1%}")


if __name__ == "__main__":
    typer.run(main)
