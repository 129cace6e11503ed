"""Training the baselines that ship, on the data and with the augmentation of our own networks."""

from __future__ import annotations

import importlib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from engine.lab.corpus import split, whole_faces
from engine.lab.evaluate.baselines import NAMES
from engine.lab.evaluate.baselines.parts import Material, Report, save
from engine.lab.train.regress.data import cut
from engine.lab.train.regress.train import Settings, material_of
from engine.models.checkpoint import MODELS, Card, commit, save_card
from engine.regress.areas import AREAS

WINDOW = 64  # the paper's; the baselines are trained as they were published


def train(data: Path, out: Path = MODELS, report: Report = print) -> dict[str, Any]:
    """Train every baseline that ships and write it below `out`; returns their validation figures."""
    settings = Settings(window=WINDOW)
    training, validation, _ = split(data)
    known = []
    for area in AREAS:
        valid = [piece.weights for piece in (whole_faces(validation) if area.needs_whole_face else validation)]
        material = material_of(area, training, settings)
        known.append(Material(area, material, cut(valid, length=WINDOW, overlap=0.5)))
    found: dict[str, Any] = {}
    for name in NAMES:
        materials = [replace(material, every=name.endswith("_16")) for material in known]
        module = importlib.import_module(f"engine.lab.evaluate.baselines.{name.removesuffix('_16')}")
        modules, figures = module.train(materials, report)
        path = save(name, modules, figures, out / "baselines")
        card = Card(
            kind=name,
            data={"recordings": sorted({piece.source for piece in training})},
            split="train; selected on the last 15 % of each training take; test takes never seen",
            seed=settings.seed,
            commit=commit(),
            settings={"window": WINDOW, "levers": {area.name: asdict(settings.recipe(area).levers) for area in AREAS}},
            metrics={"validation": figures},
        )
        save_card(path, card)
        found[name] = figures
    return found
