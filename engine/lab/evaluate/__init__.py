"""Tables of figures: each method against its baselines, on the test split or on any folder of takes."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from engine.errors import EngineError

Row = dict[str, Any]  # "method" or "name", then the metrics as plain numbers
Report = Callable[[str], None]

# Each is a module of this package with `table(data, report)` and, where the paper draws it, `figures(data, folder, report)`.
TABLES: dict[str, str] = {
    "clean": "Tracker noise removed: error, closures and lag at four frame rates (BSS20b tables 1 and 2)",
    "regress": "Control curves to weights: mean squared error, closures (BSBS19 table 1, figure 8)",
    "inpaint": "Filling spans: error, spectra, closures and seams per length and guidance (BSS20 section 5)",
    "controls": "Weights from control curves alone, of the whole take (BSS20 table 4)",
    "asked": "Masked bilabials, blinks and smiles that come back from one pin or viseme",
    "bezier": "Points that a hand edit would need, and our time (BSS20 table 3)",
    "regress_edits": "Requests that no face fits: how like a recording the result is (BSBS19 section 5.3)",
    "edits": "Edits that a person would make: asked and reached, what else moved, likeness, time",
    "regress_people": "The regressor and its baselines on each person, trained on all others",
    "regress_levers": "What each augmentation and loss term does for the regressor",
    "flags": "Three hundred faults planted into recordings: recall and precision of each kind of flag, false flags",
    "spacetime": "Performances carried to a second head and back (SLS12 figures 9, 11)",
    "manifold": "Retargeting from labelled frames, driving a mesh by points: error in mm (ZLL17 figures 6 to 10)",
}


def table(name: str, data: Path | None, report: Report) -> list[Row]:
    """Return the rows of a table; `data` None is the test split. Raises `EngineError` for a name that is not in TABLES."""
    rows: list[Row] = _module(name).table(data, report)
    return rows


def figures(name: str, data: Path | None, folder: Path, report: Report) -> list[Path]:
    """Draw a table's figures into a folder and return their paths; raises `EngineError` where it has none."""
    module = _module(name)
    if not hasattr(module, "figures"):
        raise EngineError(f"The table {name!r} has no figures.")
    folder.mkdir(parents=True, exist_ok=True)
    paths: list[Path] = module.figures(data, folder, report)
    return paths


def _module(name: str) -> Any:
    if name not in TABLES:
        raise EngineError(f"There is no table called {name!r}.", f"Tables are: {', '.join(TABLES)}.")
    return importlib.import_module(f"engine.lab.evaluate.{name}")
