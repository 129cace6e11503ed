"""Two studies of the regressor that need many trainings, kept in the model card: people left out, levers left out.

Each training is a short one of the same kind as the shipped networks', so figures compare within a study and are worse
than those of the networks that ship. `retake train regress_study` runs them anew.
"""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from engine.errors import AssetError
from engine.formats.base.atomic import write_bytes
from engine.lab.corpus import NEVER_TRAINED, Piece, load_takes, person_of, pieces_of, split, whole_faces
from engine.lab.evaluate.baselines import hsk16, ridge
from engine.lab.evaluate.baselines.nearest import Nearest
from engine.lab.evaluate.baselines.parts import Areas, Material
from engine.lab.evaluate.baselines.train import WINDOW
from engine.lab.evaluate.regress import Method, figures_of, full, of_controls
from engine.lab.evaluate.regress import methods as methods_of_table
from engine.lab.evaluate.regress_edits import REQUESTS, Judge
from engine.lab.train.regress.data import cut
from engine.lab.train.regress.train import RECIPES, Settings, material_of, train_area
from engine.models.checkpoint import MODELS
from engine.regress.areas import AREAS, Area
from engine.regress.infer import Regressor

Row = dict[str, Any]
Report = Callable[[str], None]

SHORT = Settings(
    recipes={
        name: replace(recipe, epochs=(4, 4), levers=replace(recipe.levers, copies=1))
        for name, recipe in RECIPES.items()
    }
)
# The lower face alone is trained more briefly than what ships: its takes are the longest.
PEOPLE = Settings(recipes=RECIPES | {"lower": replace(RECIPES["lower"], epochs=(8, 6))})
HSK16_EPOCHS = (6, 6)
LEFT_OUT = ("S07-001", "1114_2_05")  # training takes that the study of levers measures on
LEVERS: dict[str, dict[str, Any]] = {
    "mirror": {"mirror": False},
    "gain": {"gain": 0.0},
    "warp": {"warp": 0.0},
    "mix": {"mix": 0.0},
    "recombine": {"recombine": 0.0},
}
TERMS: dict[str, dict[str, Any]] = {
    "distance loss": {"distance_share": 0.0},
    "velocity loss": {"velocity_share": 0.0},
    "loss on controls": {"held_share": 0.0},
}
ALONE = "without contacts"
USES = (ALONE, "without tempering")  # what is done when the networks are used, not when they are trained
EDITS = ("x3", "contradictory", "salt_and_pepper")
CARD = MODELS / "regress_lower.card.json"


def _networks(
    training: Sequence[Piece], validation: Sequence[Piece], settings: Settings, *, areas: Sequence[Area]
) -> dict[str, Method]:
    """Train some areas; returns the regressor and the full system."""
    networks = {}
    with tempfile.TemporaryDirectory() as folder:
        for area in areas:
            path = Path(folder) / f"{area.name}.safetensors"
            networks[area.name], _ = train_area(area, training, validation, settings, path=path, report=lambda _: None)
    made = Regressor(networks)
    unbound = Regressor({name: copy.deepcopy(network) for name, network in networks.items()})
    for network in unbound.networks.values():
        network.bound.fill_(torch.inf)
        network.usual.fill_(torch.inf)
    return {
        "regressor": lambda controls, take: made.infer(controls, full=False, kept=take.kept),
        "full": full(made),
        ALONE: lambda controls, take: made.infer(controls, kept=take.kept, original=take.controls, land=False),
        "without tempering": full(unbound),
    }


def _baselines(training: Sequence[Piece], validation: Sequence[Piece], settings: Settings) -> dict[str, Method]:
    """Train ridge regression and HSK16 as they ship, the second more briefly."""
    materials = []
    for area in AREAS:
        valid = [piece.weights for piece in (whole_faces(validation) if area.needs_whole_face else validation)]
        source = material_of(area, training, replace(settings, window=WINDOW))
        materials.append(Material(area, source, cut(valid, length=WINDOW, overlap=0.5)))
    held = hsk16.train(materials, lambda _: None, epochs=HSK16_EPOCHS)[0]
    return {
        "ridge": of_controls(Areas(ridge.train(materials, lambda _: None)[0], alignment=1).infer),
        "hsk16": of_controls(Areas(held, alignment=hsk16.POOL).infer),
        "nearest": of_controls(Nearest(training).infer),
    }


def people(data: Path, report: Report) -> list[Row]:
    """Return a row for each method and person who was left out of its training, then means and spreads.

    Of a person whom nothing is ever trained on, the rows are those of what ships.
    """
    pieces = [piece for take, whole in load_takes(data) for piece in pieces_of(take, whole_face=whole)]
    rows: list[Row] = []
    for person in dict.fromkeys(person_of(piece.source) for piece in pieces):
        rows += without(person, data, pieces)
        report(f"left out {person}: " + ", ".join(f"{row['method']} {row['mse_lower']:.4f}" for row in rows[-6:]))
    return rows + summary(rows)


def without(person: str, data: Path, pieces: Sequence[Piece]) -> list[Row]:
    """Return a row for each method, trained without a person and measured on all takes of that person."""
    training, validation, test = split(data)
    seen, valid = (
        [piece for piece in part if person_of(piece.source) != person] for part in (training + test, validation)
    )
    held = [piece for piece in pieces if person_of(piece.source) == person]
    if person in map(person_of, NEVER_TRAINED):
        shipped = methods_of_table(lambda _: None)
        methods = {name: shipped[name] for name in ("regressor", "full", "alone", "ridge", "hsk16", "nearest")}
    else:
        made = _networks(seen, valid, PEOPLE, areas=_shown(held))
        methods = {"regressor": made["regressor"], "full": made["full"], "alone": made[ALONE]}
        methods |= _baselines(seen, valid, PEOPLE)
    return [{"method": name, "person": person} | figures_of(method, held) for name, method in methods.items()]


def _shown(held: Sequence[Piece]) -> list[Area]:
    return [area for area in AREAS if whole_faces(held) or not area.needs_whole_face]


def summary(rows: Sequence[Row]) -> list[Row]:
    """Return the mean and the standard deviation over people of each method's figures."""
    made = []
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        for name, reduce in (("mean", np.mean), ("standard deviation", np.std)):
            row: Row = {"method": method, "person": name}
            for key in own[0].keys() - {"method", "person"}:
                known = [one[key] for one in own if one[key] is not None]
                row[key] = float(reduce(known)) if known else None
            made.append({key: row[key] for key in own[0]})
    return made


def levers(data: Path, report: Report) -> list[Row]:
    """Return figures of the full system, and the regressor's errors, with every lever and with each one left out.

    `times_recorded_*` is that of `regress_edits`. Measured on two training takes that these trainings do not see; the
    test split plays no part.
    """
    training, validation, _ = split(data)
    held = [piece for piece in training + validation if piece.source in LEFT_OUT]
    seen = [piece for piece in training if piece.source not in LEFT_OUT]
    variants = {"all": SHORT}
    for name, change in LEVERS.items():
        recipes = {area: replace(one, levers=replace(one.levers, **change)) for area, one in SHORT.recipes.items()}
        variants[f"without {name}"] = replace(SHORT, recipes=recipes)
    performed = {area: replace(one, synthetic_minutes=8.0) for area, one in SHORT.recipes.items()}
    variants["with synthetic performances"] = replace(SHORT, recipes=performed)
    variants |= {f"without {name}": replace(SHORT, **change) for name, change in TERMS.items()}
    judge = Judge(held, seen)
    rows: list[Row] = []
    for name, settings in variants.items():
        methods = _networks(seen, held, settings, areas=_shown(held))
        rows.append(_lever(name, methods["full"], methods["regressor"], held, judge))
        if name == "all":
            rows += [_lever(one, methods[one], methods["regressor"], held, judge) for one in USES]
        report(f"{name}: " + ", ".join(f"{key} {value:.4f}" for key, value in rows[-1].items() if "mse" in key))
    return rows


def _lever(name: str, full: Method, regressor: Method, held: Sequence[Piece], judge: Judge) -> Row:
    only = {f"regressor_{key}": value for key, value in figures_of(regressor, held).items() if "mse" in key}
    edits = {f"times_recorded_{ask}": judge.figures(full, REQUESTS[ask])["times_recorded"] for ask in EDITS}
    return {"name": name} | figures_of(full, held) | only | edits


def train(data: Path, out: Path = MODELS, report: Report = print) -> None:
    """Run both studies and write them into the card of the lower face's networks."""
    path = out / CARD.name
    for name, study in (("levers", levers), ("people", people)):
        rows = study(data, report)
        card = json.loads(path.read_text())
        card["metrics"][name] = rows
        write_bytes(path, [json.dumps(card, indent=2).encode() + b"\n"])


def stored(name: str) -> list[Row]:
    """Return a study's rows from the card; raises `AssetError` that says how to run it where it has none."""
    try:
        rows: list[Row] = json.loads(CARD.read_text())["metrics"][name]
    except (OSError, ValueError, KeyError) as error:
        raise AssetError("The model card has no such study.", "Run it: retake train regress_study.") from error
    return rows
