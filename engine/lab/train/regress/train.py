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

from engine.anatomy import mirrored
from engine.controls import CONTROLS, bundled_measurer
from engine.extended import bundled_face
from engine.lab.corpus import Piece, recorded_seconds, split, whole_faces
from engine.lab.performer.augment import Levers
from engine.lab.train.regress import partial
from engine.lab.train.regress.data import NearestFaces, Source, Windows, cut, source
from engine.lab.train.regress.losses import distance_error
from engine.lab.train.regress.requests import contradictory, exaggerated, salt_and_pepper
from engine.models.checkpoint import MODELS, Card, commit, save_card, save_model
from engine.models.distances import Distances
from engine.regress.areas import AREAS, EXTENDED_AREAS, Area
from engine.regress.network import AreaNetwork, UNet, UNetConfig
from engine.take import SHAPES, Array

Report = Callable[[str], None]
STAGES = ("regressor", "autoencoder")
PENALTIES = (1e-4, 1e-3, 1e-2, 3e-2, 1e-1)  # of standardised controls


@dataclass(frozen=True)
class Recipe:
    """How one area is trained.

    Attributes
    ----------
    epochs : of the regressor, of the autoencoder
    rates : Adam's at first; they fall along half a cosine, so that the last epochs settle
    waves : how many the regressor's linear part bends by
    penalties : of the linear start, in units of standardised controls; that which validates best is taken
    undo : whether the autoencoder is to make of an exaggerated face the one that it exaggerates, not the nearest real one
    unusual : share of recorded frames further out than an edit may hold a take, which itself is never too far out
    """

    widths: tuple[int, int, int] = (8, 16, 32)
    epochs: tuple[int, int] = (10, 10)
    rates: tuple[float, float] = (2e-3, 2e-3)
    levers: Levers = field(default_factory=lambda: Levers(copies=2))
    synthetic_minutes: float = 8.0
    waves: int = 0
    penalties: tuple[float, ...] = PENALTIES
    undo: bool = False
    unusual: float = 0.06


# Brows and lids differ more between people than the mouth does, and controls say less of them: without more people, drawn
# anew every few seconds, the network learns who was recorded.
_PEOPLE = Levers(copies=3, gain=0.4, mix=0.5, recombine=0.5, stretch=256)
RECIPES = {
    "lower": Recipe((32, 64, 128), (40, 16), (1e-3, 1.5e-3), Levers(copies=3)),
    # The synthetic performer's brows and lids mislead: without them the error on a person left out is less by a tenth and
    # by a third. Undoing exaggeration costs brows nothing; mouths and lids it would cost their widest and their closest.
    # Waves bring the error at other moments of the same people down by a seventh and leave that on a person left out; a
    # lesser penalty, which the people trained on would choose, costs the latter.
    "upper": Recipe((16, 32, 64), (8, 16), (1e-3, 2e-3), _PEOPLE, 0.0, waves=200, penalties=(0.1,), undo=True),
    # Eyes that stay shut are as far out as a seventh of all frames are, blinks among them.
    "eyelids": Recipe((16, 32, 64), (24, 16), (2e-3, 2e-3), _PEOPLE, synthetic_minutes=0.0, unusual=0.15),
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
    noisy_share: float = 0.25  # an autoencoder that only ever sees noise forgets closures
    misfit_share: float = 0.35  # windows with a request no face fits; their target is the nearest real face
    distance_share: float = 0.002  # per mm^2, so that 1 mm of lips weighs like 0.045 of a weight
    closure_gain: float = 4.0
    velocity_share: float = 1.0

    def recipe(self, area: Area) -> Recipe:
        """Return how an area is trained; the extended ones, which say almost all of their shapes, in the plainest way."""
        return self.recipes.get(area.name, Recipe())


def _standardise(network: AreaNetwork, controls: Tensor, weights: Tensor) -> None:
    """Take means and scales of both U-Nets' inputs from training windows."""
    for unet, curves in ((network.regressor, controls), (network.autoencoder, weights)):
        unet.mean.copy_(curves.mean(dim=(0, 2))[None, :, None])
        unet.scale.copy_(curves.std(dim=(0, 2))[None, :, None].clamp(min=0.02))


def _start(network: AreaNetwork, controls: Tensor, weights: Tensor, penalty: float) -> None:
    """Start the regressor as ridge regression and the autoencoder as identity."""
    regressor, autoencoder = network.regressor, network.autoencoder
    x = regressor.bent((controls - regressor.mean) / regressor.scale).mT.flatten(0, 1).double()
    y = weights.mT.flatten(0, 1).double()
    ahead, centre = x.mean(dim=0), y.mean(dim=0)
    gram = (x - ahead).T @ (x - ahead) / len(x) + penalty * torch.eye(x.shape[1], dtype=x.dtype)
    slope = torch.linalg.solve(gram, (x - ahead).T @ (y - centre) / len(x))
    with torch.no_grad():
        regressor.linear.weight.copy_(slope.T[:, :, None])
        regressor.linear.bias.copy_(centre - ahead @ slope)  # type: ignore[union-attr]
        autoencoder.linear.weight.copy_(torch.diag(autoencoder.scale[0, :, 0])[:, :, None])
        autoencoder.linear.bias.copy_(autoencoder.mean[0, :, 0])  # type: ignore[union-attr]


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
        self._distances = Distances(bundled_measurer())
        inputs, outputs, widths = len(self._controls), len(self._columns), self._recipe.widths
        regressor = UNetConfig(inputs, outputs, widths, self._recipe.waves)
        self.network = AreaNetwork(regressor, UNetConfig(outputs, outputs, widths))
        self._begin(material.first)
        neutral = np.zeros((1, len(SHAPES)))
        rest = bundled_face().measure(neutral)
        self._rest = torch.tensor(rest[0, area.control_columns], dtype=torch.float32)[None, :, None]
        # What a face can do is what was recorded, not what augmentation made of it.
        recorded = cut([*material.pieces, *map(mirrored, material.pieces)], length=settings.window, overlap=0.0)
        self._nearest = NearestFaces(recorded, self._controls, self._columns, settings.seed)
        self.network.learn_bounds(recorded.controls[:, self._controls], self._recipe.unusual)

    def _begin(self, first: Windows) -> None:
        """Standardise, and take the ridge penalty that validates best: the two lids, say, are all but one control."""
        controls, weights = first.controls[:, self._controls], first.weights[:, self._columns]
        _standardise(self.network, controls, weights)
        errors = {}
        for penalty in self._recipe.penalties:
            _start(self.network, controls, weights, penalty)
            errors[penalty] = self._validate(0)["mse"]
        _start(self.network, controls, weights, min(errors, key=errors.__getitem__))

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
        rate = self._recipe.rates[standing.stage]
        optimizer = torch.optim.Adam(part.parameters(), lr=rate, weight_decay=self._settings.weight_penalty)
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
            made = self.network(batch.seen, full=stage == 1)
            loss = torch.stack(list(self._losses(made, batch).values())).sum()
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()

    def _batch(self, windows: Windows, stage: int, rng: torch.Generator) -> _Batch:
        """Return windows as they are for the regressor; for the autoencoder, some with a request that no face fits."""
        asked = windows.controls[:, self._controls]
        target = windows.weights[:, self._columns]
        true = torch.ones(len(asked), dtype=torch.bool)
        if stage == 0:
            return _Batch(asked, target, windows.weights, asked, true)
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
            bounded = torch.minimum(torch.maximum(unfit[chosen], network.low), network.high)
            seen, target = seen.clone(), target.clone()
            undone = larger[chosen] & self._recipe.undo
            seen[chosen] = unfit[chosen]
            target[chosen] = torch.where(undone, target[chosen], self._nearest.weights(bounded))
        return _Batch(seen, target, windows.weights, asked, ~chosen)

    def _losses(self, made: Tensor, batch: _Batch) -> dict[str, Tensor]:
        """Return every term by name: weights, distances (equation 1) and velocity, the last two where there is truth."""
        settings, true = self._settings, batch.true
        terms = {"mse": (made - batch.target).square().mean()}
        near = self._controls < len(CONTROLS)  # angles and brows are left to the error of the weights
        if near.any() and true.any():
            whole = batch.weights[true].index_copy(1, self._columns, made[true])
            reached = self._distances(whole.mT).mT[:, self._controls[near]]
            distance = distance_error(reached, batch.asked[true][:, near], settings.closure_gain)
            terms["distance"] = settings.distance_share * distance
        if true.any():
            velocity = (made[true].diff(dim=2) - batch.target[true].diff(dim=2)).square().mean()
            terms["velocity"] = settings.velocity_share * velocity
        return terms

    def _validate(self, stage: int) -> dict[str, float]:
        """Return the loss terms on the validation windows; the autoencoder's are those of mixed requests, always alike."""
        self.network.eval()
        batches = [self._batch(self._valid, 0, torch.Generator())]
        if stage == 1:
            batches.append(self._batch(self._valid, 1, torch.Generator().manual_seed(1)))
        with torch.inference_mode():
            terms = [self._losses(self.network(batch.seen, full=stage == 1), batch) for batch in batches]
        return {name: float(torch.stack([term[name] for term in terms]).mean()) for name in terms[0]}


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


def train(data: Path, out: Path = MODELS, settings: Settings | None = None, report: Report = print) -> dict[str, Any]:
    """Train all areas on the training split; writes one model and one card each, returns the validation figures.

    Stopped at any time, it goes on from the last finished epoch when called again with the same settings and data.
    """
    settings = settings or Settings()
    training, validation, _ = split(data)
    partials = {area.name: out / f"regress_{area.name}.partial.safetensors" for area in (*AREAS, *EXTENDED_AREAS)}
    figures: dict[str, Any] = {}
    for area in (*AREAS, *EXTENDED_AREAS):
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
