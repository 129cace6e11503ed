"""All tables of figures: each method against its baselines, on the test split or on any folder of takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from engine.errors import EngineError
from engine.lab.evaluate import regress, regress_edits, regress_figures, regress_levers, regress_people
from engine.lab.evaluate.clean import figures as clean_figures
from engine.lab.evaluate.clean import table as clean
from engine.lab.evaluate.controls import figures as controls_figures
from engine.lab.evaluate.controls import table as controls
from engine.lab.evaluate.edits import figures as edits_figures
from engine.lab.evaluate.edits import table as edits
from engine.lab.evaluate.flags import table as flags
from engine.lab.evaluate.inpaint import asked, bezier
from engine.lab.evaluate.inpaint import table as inpaint
from engine.lab.evaluate.manifold import figures as manifold_figures
from engine.lab.evaluate.manifold import table as manifold
from engine.lab.evaluate.spacetime import figures as spacetime_figures
from engine.lab.evaluate.spacetime import table as spacetime
from engine.lab.reporting import Report, Row


@dataclass(frozen=True)
class Table:
    """A table that can be asked for by name.

    Attributes
    ----------
    table : returns the rows; takes a folder of takes, or None for the test split, and hears of the progress
    figures : draws the table's figures into a folder, where the paper has some; returns their paths
    """

    name: str
    title: str
    table: Callable[[Path | None, Report], list[Row]]
    figures: Callable[[Path | None, Path, Report], list[Path]] | None = None

    def draw(self, data: Path | None, folder: Path, report: Report) -> list[Path]:
        """Draw the figures into a folder, which is created; raises `EngineError` where the table has none."""
        if self.figures is None:
            raise EngineError(f"The table {self.name!r} has no figures.")
        folder.mkdir(parents=True, exist_ok=True)
        return self.figures(data, folder, report)


TABLES: tuple[Table, ...] = (
    Table(
        "clean",
        "Tracker noise removed: error, closures and lag at four frame rates (BSS20b tables 1 and 2)",
        clean.table,
        clean_figures.figures,
    ),
    Table(
        "regress",
        "Control curves to weights: mean squared error, closures (BSBS19 table 1, figure 8)",
        regress.table,
        regress_figures.draw,
    ),
    Table(
        "inpaint",
        "Filling spans: error, spectra, closures and seams per length and guidance (BSS20 section 5)",
        inpaint.table,
    ),
    Table(
        "controls",
        "Weights from control curves alone, of the whole take (BSS20 table 4)",
        controls.table,
        controls_figures.figures,
    ),
    Table("asked", "Masked bilabials, blinks and smiles that come back from one pin or viseme", asked.table),
    Table("bezier", "Points that a hand edit would need, and our time (BSS20 table 3)", bezier.table),
    Table(
        "regress_edits",
        "Requests that no face fits: how like a recording the result is (BSBS19 section 5.3)",
        regress_edits.table,
    ),
    Table(
        "edits",
        "Edits that a person would make: asked and reached, what else moved, likeness, time",
        edits.table,
        edits_figures.figures,
    ),
    Table(
        "regress_people", "The regressor and its baselines on each person, trained on all others", regress_people.table
    ),
    Table("regress_levers", "What each augmentation and loss term does for the regressor", regress_levers.table),
    Table(
        "flags",
        "Three hundred faults planted into recordings: recall and precision of each kind of flag, false flags",
        flags.table,
    ),
    Table(
        "spacetime",
        "Performances carried to a second head and back (SLS12 figures 9, 11)",
        spacetime.table,
        spacetime_figures.figures,
    ),
    Table(
        "manifold",
        "Retargeting from labelled frames, driving a mesh by points: error in mm (ZLL17 figures 6 to 10)",
        manifold.table,
        manifold_figures.figures,
    ),
)


def named(name: str) -> Table:
    """Return the table of a name; raises `EngineError` where there is none."""
    for table in TABLES:
        if table.name == name:
            return table
    raise EngineError(
        f"There is no table called {name!r}.", f"Tables are: {', '.join(table.name for table in TABLES)}."
    )
