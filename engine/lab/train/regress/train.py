"""Training the regressor, then the autoencoder on top of it (BSBS19 sections 4.2 and 4.3).

The last epoch is kept, not the best: the validation frames are of the people trained on, and would choose the epoch that
knows them best. Rates, epochs and augmentation of `RECIPES` come from training takes left out and from those frames.
"""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from engine.controls import CONTROLS, bundled_measurer
from engine.extended import bundled_face
from engine.lab.corpus import Piece, recorded_seconds, split, whole_faces
from engine.lab.performer.augment import Levers
from engine.lab.train.regress import partial
from engine.lab.train.regress.data import NearestFaces, Source, Windows, cut, source
from engine.lab.train.regress.losses import distance_error
from engine.lab.train.regress.requests import contradictory, exaggerated, salt_and_pepper
from engine.lab.train.regress.start import begin, without_further
from engine.models.checkpoint import MODELS, Card, commit, save_card, save_model
from engine.models.distances import Distances
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.network import AreaNetwork, network_of
from engine.regress.unet import UNet
from engine.take import SHAPES, Array

Report = Callable[[str], None]
STAGES = ("regressor", "autoencoder")
PENALTIES = (
    1e-3,
    1e-2,
    1e-1,
    0.3,
    1.0,
)  # of the linear start, of standardised controls; the best on people left out is taken


@dataclass(frozen=True)
class Recipe:
    """How one area is trained.

    Attributes
    ----------
    epochs : of the regressor, of the autoencoder
    rates : Adam's at first; they fall along half a cosine, so that the last epochs settle
    waves : how many the regressor's linear part bends by
    undo : whether the autoencoder is to make of an exaggerated face the one that it exaggerates, not the nearest real one
    unusual : share of recorded frames further out than an edit may hold a take, which itself is never too far out
    """

    widths: tuple[int, int, int] = (8, 16, 32)
    epochs: tuple[int, int] = (10, 10)
    rates: tuple[float, float] = (2e-3, 2e-3)
    levers: Levers = field(default_factory=lambda: Levers(copies=2))
    synthetic_minutes: float = 8.0
    waves: int = 0
    undo: bool = False
    unusual: float = 0.06


# Brows and lids differ more between people than the mouth does, and controls say less of them: without more people, drawn
# anew every few seconds, the network learns who was recorded.
_PEOPLE = Levers(copies=3, gain=0.4, mix=0.5, recombine=0.5, stretch=256)
# Epochs are few and rates low: on a person left out the error falls for some epochs and rises from then on, while that on
# kept frames of the people trained on goes on falling. The synthetic performer misleads in every area: without it the error
# on a person left out is less.
RECIPES = {
    "lower": Recipe((32, 64, 128), (48, 14), (1e-3, 1e-3), Levers(copies=3), 0.0),
    # Undoing exaggeration costs brows nothing; mouths and lids it would cost their widest and their closest.
    "upper": Recipe((16, 32, 64), (8, 16), (3e-4, 1e-3), _PEOPLE, 0.0, undo=True),
    "brows": Recipe((8, 16, 32), (8, 8), (1e-3, 1e-3), _PEOPLE, 0.0),
    # Lids bend: waves take a third off the error on a person left out, and where the eyes look half of the rest. Eyes that
    # stay shut are as far out as a seventh of all frames are, blinks among them.
    "eyelids": Recipe((16, 32, 64), (8, 16), (3e-4, 1e-3), _PEOPLE, 0.0, waves=200, unusual=0.15),
}


@dataclass(frozen=True)
class Settings:
    """What a training run depends on; the paper's values unless its place says otherwise."""

    seed: int = 0
    window: int = 128  # the paper's 64 show a network of this reach little but the zeros beyond their ends
    batch: int = 16
    recipes: dict[str, Recipe] = field(default_factory=lambda: dict(RECIPES))
    weight_penalty: float = 1e-6
    salt_and_pepper: float = 0.2
    noisy_share: float = 0.2  # an autoencoder that only ever sees noise forgets closures
    misfit_share: float = 0.25  # windows with a request no face fits; their target is the nearest real face
    distance_share: float = 0.002  # per mm^2, so that 1 mm of lips weighs like 0.045 of a weight
    closure_gain: float = 4.0
    velocity_share: float = 1.0
    held_share: float = 1.0

    def recipe(self, area: Area) -> Recipe:
        """Return how an area is trained; the extended ones, which say almost all of their shapes, in the plainest way."""
        return self.recipes.get(area.name, Recipe())


@dataclass(frozen=True)
class _Batch:
    """What a network sees and what it should make of it; `true` marks windows whose target was recorded."""

    seen: Tensor
    target: Tensor
    weights: Tensor
    asked: Tensor
    true: Tensor


class AreaTrainer:
    """Both stages for one area; every epoch depends on the settings and its number alone, so a run can be resumed."""

    def __init__(self, area: Area, material: Source, validation: Sequence[Array], settings: Settings) -> None:
        torch.manual_seed(settings.seed)
        self._area, self._settings, self._recipe, self._source = area, settings, settings.recipe(area), material
        self._valid = cut(validation, length=settings.window, overlap=0.5)
        self._columns, self._controls = torch.tensor(area.shape_columns), torch.tensor(area.control_columns)
        self._inputs = torch.tensor(area.every_column)
        self._distances = Distances(bundled_measurer())
        self.network = network_of(area, widths=self._recipe.widths, waves=self._recipe.waves)
        people = list(material.recorded.values())
        self.left_out = begin(self.network, area, material.first, people, PENALTIES)
        rest = bundled_face().measure(np.zeros((1, len(SHAPES))))
        self._rest = torch.tensor(rest[0, area.every_column], dtype=torch.float32)[None, :, None]
        # What a face can do is what was recorded, not what augmentation made of it.
        recorded = Windows(*(torch.cat([getattr(one, name) for one in people]) for name in ("controls", "weights")))
        self._nearest = NearestFaces(recorded, self._controls, self._columns, settings.seed)
        self.network.learn_bounds(recorded.controls[:, self._inputs], self._recipe.unusual)

    def run(self, path: Path, report: Report) -> dict[str, float]:
        """Train what is not yet trained, leaving a checkpoint at `path` after each epoch; returns validation terms."""
        run = self._identity()
        resumed = partial.load(path, run=run)
        standing, saved = resumed or (partial.Standing(), None)
        if saved is not None:
            self.network.load_state_dict(saved["network"])
            report(f"{self._area.name}: going on after {standing.epoch} epochs of stage {standing.stage + 1} of 2")
        for stage in range(standing.stage, len(STAGES)):
            if stage != standing.stage:
                standing, saved = partial.Standing(stage, figures=standing.figures), None
            self._stage(standing, saved, path, run, report)
            standing.figures |= {f"{STAGES[stage]}_{name}": value for name, value in standing.terms.items()}
        return standing.figures

    def _identity(self) -> dict[str, Any]:
        digest = hashlib.sha256()
        for windows in (self._source.first, self._valid):
            digest.update(windows.controls.numpy().tobytes())
        settings: dict[str, Any] = json.loads(json.dumps(asdict(self._settings)))
        return {"settings": settings, "data": digest.hexdigest()}

    def _stage(
        self,
        standing: partial.Standing,
        saved: dict[str, dict[str, Tensor]] | None,
        path: Path,
        run: dict[str, Any],
        report: Report,
    ) -> None:
        part: UNet = getattr(self.network, STAGES[standing.stage])
        self.network.requires_grad_(False)
        part.requires_grad_(True)
        parameters = list(part.parameters())
        if self.network.constraint is not None:
            self.network.constraint.requires_grad_(True)
            parameters += self.network.constraint.parameters()
        rate = self._recipe.rates[standing.stage]
        optimizer = torch.optim.Adam(parameters, lr=rate, weight_decay=self._settings.weight_penalty)
        if saved is not None:
            partial.restore_optimizer(optimizer, saved["optimizer"])
        epochs = self._recipe.epochs[standing.stage]
        for epoch in range(standing.epoch, epochs):
            began = time.monotonic()
            optimizer.param_groups[0]["lr"] = rate * 0.5 * (1 + math.cos(math.pi * epoch / epochs))
            self._epoch(standing.stage, epoch, optimizer)
            terms = self._validate(standing.stage)
            standing.epoch, standing.terms = epoch + 1, terms
            partial.save(path, standing, run=run, network=self.network, optimizer=optimizer)
            shown = ", ".join(f"{name} {value:.5f}" for name, value in terms.items())
            took = time.monotonic() - began
            report(f"{self._area.name} {STAGES[standing.stage]} {epoch + 1}/{epochs}: {shown} ({took:.1f} s)")

    def _epoch(self, stage: int, epoch: int, optimizer: torch.optim.Optimizer) -> None:
        self.network.train()
        windows = self._source.epoch(1 + stage, epoch)
        rng = torch.Generator().manual_seed(self._settings.seed * 100_003 + stage * 1009 + epoch)
        for index in torch.split(torch.randperm(len(windows.weights), generator=rng), self._settings.batch):
            batch = self._batch(Windows(windows.controls[index], windows.weights[index]), stage, rng)
            loss = torch.stack(list(self._losses(batch, stage).values())).sum()
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()

    def _batch(self, windows: Windows, stage: int, rng: torch.Generator) -> _Batch:
        """Return windows as they are for the regressor; for the autoencoder, some with a request that no face fits."""
        asked = windows.controls[:, self._inputs]
        target = windows.weights[:, self._columns]
        true = torch.ones(len(asked), dtype=torch.bool)
        own = len(self._controls)
        alone = torch.rand(len(asked), 1, 1, generator=rng) < 0.5
        if stage == 0:
            seen = torch.where(alone, without_further(asked, own), asked)
            return _Batch(seen, target, windows.weights, asked, true)
        lot = torch.rand(len(asked), 1, 1, generator=rng)
        noisy = lot < self._settings.noisy_share
        misfit = (lot >= self._settings.noisy_share) & (lot < self._settings.noisy_share + self._settings.misfit_share)
        settings, network = self._settings, self.network
        seen = torch.where(
            noisy, salt_and_pepper(asked, network.low, network.high, settings.salt_and_pepper, rng), asked
        )
        factor = 1 + 2 * torch.rand(len(asked), 1, 1, generator=rng)
        larger = torch.rand(len(asked), 1, 1, generator=rng) < 0.5
        unfit = torch.where(larger, exaggerated(asked, self._rest, factor), contradictory(asked, rng))
        chosen = misfit[:, 0, 0]
        if chosen.any():
            bounded = torch.minimum(torch.maximum(unfit[chosen], network.low), network.high)[:, :own]
            seen, target = seen.clone(), target.clone()
            undone = larger[chosen] & self._recipe.undo
            seen[chosen] = unfit[chosen]
            target[chosen] = torch.where(undone, target[chosen], self._nearest.weights(bounded))
        seen = torch.where(alone, without_further(seen, own), seen)
        return _Batch(seen, target, windows.weights, asked, ~chosen)

    def _losses(self, batch: _Batch, stage: int) -> dict[str, Tensor]:
        """Return every term by name: weights, these on their controls, distances (equation 1) and velocity.

        The last two where there is truth, and of the weights before they are brought onto their controls.
        """
        settings, true, full = self._settings, batch.true, stage == 1
        made = self.network(batch.seen, full=full)
        terms = {"mse": (made - batch.target).square().mean()}
        if self.network.constraint is not None:
            held = self.network.constrained(made, batch.seen, batch.weights, full=full)
            terms["held"] = settings.held_share * (held - batch.target).square().mean()
        near = self._controls < len(CONTROLS)  # angles and brows are left to the error of the weights
        if near.any() and true.any():
            whole = batch.weights[true].index_copy(1, self._columns, made[true])
            reached = self._distances(whole.mT).mT[:, self._controls[near]]
            distance = distance_error(reached, batch.asked[true][:, : len(near)][:, near], settings.closure_gain)
            terms["distance"] = settings.distance_share * distance
        if true.any():
            velocity = (made[true].diff(dim=2) - batch.target[true].diff(dim=2)).square().mean()
            terms["velocity"] = settings.velocity_share * velocity
        return terms

    def _validate(self, stage: int) -> dict[str, float]:
        """Return the loss terms on the validation windows; the autoencoder's are those of mixed requests, always alike."""
        self.network.eval()
        batches = [self._batch(self._valid, 0, torch.Generator().manual_seed(0))]
        if stage == 1:
            batches.append(self._batch(self._valid, 1, torch.Generator().manual_seed(1)))
        with torch.inference_mode():
            terms = [self._losses(batch, stage) for batch in batches]
        named = {name: [term[name] for term in terms if name in term] for name in terms[0] | terms[-1]}
        return {name: float(torch.stack(values).mean()) for name, values in named.items()}


def material_of(area: Area, training: Sequence[Piece], settings: Settings) -> Source:
    """Return what an area is trained on."""
    recipe = settings.recipe(area)
    minutes, seed, window = recipe.synthetic_minutes, settings.seed, settings.window
    return source(area, training, recipe.levers, minutes=minutes, seed=seed, window=window)


def train_area(
    area: Area,
    training: Sequence[Piece],
    validation: Sequence[Piece],
    settings: Settings,
    *,
    path: Path,
    report: Report,
) -> tuple[AreaNetwork, dict[str, float]]:
    """Train one area's networks, resuming from `path`; returns them and their validation terms."""
    material = material_of(area, training, settings)
    valid = [piece.weights for piece in (whole_faces(validation) if area.needs_whole_face else validation)]
    trainer = AreaTrainer(area, material, valid, settings)
    figures = trainer.run(path, report)
    return trainer.network.eval(), figures


def train(
    data: Path,
    out: Path = MODELS,
    settings: Settings | None = None,
    report: Report = print,
    *,
    areas: Sequence[Area] = (*AREAS, *EXTENDED_AREAS),
) -> dict[str, Any]:
    """Train areas on the training split; writes one model and one card each, returns the validation figures.

    Stopped at any time, it goes on from the last finished epoch when called again with the same settings and data.
    """
    settings = settings or Settings()
    training, validation, _ = split(data)
    partials = {area.name: out / f"regress_{area.name}.partial.safetensors" for area in areas}
    figures: dict[str, Any] = {}
    for area in areas:
        network, figures[area.name] = train_area(
            area, training, validation, settings, path=partials[area.name], report=report
        )
        path = out / f"regress_{area.name}.safetensors"
        save_model(path, network.state_dict(), kind="regress", config=network.config())
        save_card(path, _card(training, settings, figures[area.name]))
    for path in partials.values():
        path.unlink(missing_ok=True)
    return figures


def _card(training: Sequence[Piece], settings: Settings, metrics: dict[str, float]) -> Card:
    return Card(
        kind="regress",
        data={"recorded_seconds": recorded_seconds(training)},
        split="train; watched on the last 15 % of each training take; test takes never seen",
        seed=settings.seed,
        commit=commit(),
        settings=asdict(settings),
        metrics={"validation": metrics},
    )


__all__ = ["AreaTrainer", "Settings", "train", "train_area"]
