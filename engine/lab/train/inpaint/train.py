"""Training the filling network (BSS20 section 3.3): first without, then with an adversary; and its twin, without to the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from engine.inpaint import retrieval
from engine.inpaint.base import base_of
from engine.inpaint.infer import Filler, save_filler
from engine.inpaint.network import Discriminator, Generator, GeneratorConfig, discriminator_inputs, noise_curves
from engine.inpaint.statistics import Statistics, statistics_of
from engine.lab.corpus import Piece, recorded_seconds, split
from engine.lab.reporting import Report
from engine.lab.train import loop
from engine.lab.train.inpaint.losses import Batch, Shares, fill_losses, scatter, spectrum_gap
from engine.lab.train.inpaint.material import Help, Performance, draw, listened, performances, random_gap
from engine.lab.train.inpaint.validate import validation_figures
from engine.lab.train.loop import Parts, Schedule, State, identity
from engine.models.checkpoint import MODELS, Card, commit, save_card
from engine.models.distances import six_distances
from engine.models.threads import one_thread

EVERY = 100  # steps from one checkpoint to the next
SHARED = "inpaint_shared.partial.safetensors"  # where both ways part


@dataclass(frozen=True)
class Settings:
    """What a training run depends on; the paper's values unless its place says otherwise."""

    seed: int = 0
    frames: int = 200
    hidden: int = 128
    batch: int = 16
    rate: float = 1e-3  # of the discriminator, and of the generator at the parting of the ways; twice that before
    shared_steps: int = 1400  # before the ways part: no adversary yet
    parted_steps: int = 1300
    filter_pace: float = 0.1  # of the filter's rate to the rest's: it has many inputs
    shares: Shares = field(default_factory=Shares)
    judge_steps: int = 1  # of the discriminator for one of the generator
    average: float = 0.995  # of the generator's weights over steps: the network that is kept
    help: Help = field(default_factory=Help)


def make_batches(
    material: Sequence[Performance],
    statistics: Statistics,
    settings: Settings,
    rng: np.random.Generator,
    *,
    size: int,
    ranks: Sequence[int | None] = (None,),
) -> list[Batch]:
    """Draw windows, tear holes and prepare the generator's input, once per rank of retrieval; None retrieves nothing."""
    truths = [draw(material, settings.frames, rng) for _ in range(size)]
    gaps = [random_gap(truth, settings.help, rng) for truth in truths]
    batches = []
    for rank in ranks:
        rows = []
        for truth, gap in zip(truths, gaps, strict=True):
            base = base_of(gap if rank is not None else replace(gap, rest=()), statistics, rank or 0)
            hole = np.isnan(gap.known)
            rows.append((truth.weights, base.base, base.blend, base.features, hole, base.certainty[:, None]))
        batches.append(Batch(*(torch.tensor(np.stack(part), dtype=torch.float32) for part in zip(*rows, strict=True))))
    return batches


class Trainer:
    """One way of training, with or without an adversary; a unit of the loop is a step of the generator."""

    def __init__(self, material: Sequence[Performance], settings: Settings, *, adversary: bool) -> None:
        torch.manual_seed(settings.seed)
        self._material, self.settings, self._adversary = material, settings, adversary
        self.statistics = statistics_of(np.concatenate([performance.weights for performance in material]))
        self._distances = six_distances()
        self.generator = Generator(GeneratorConfig(hidden=settings.hidden))
        self.generator.scale.copy_(torch.tensor(self.statistics.scale))
        self.kept = torch.optim.swa_utils.AveragedModel(
            self.generator,
            multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(settings.average),  # type: ignore[no-untyped-call]
        )
        self.discriminator = Discriminator(settings.frames)
        self.discriminator.scale.copy_(self._face_scale())
        rest = [value for name, value in self.generator.named_parameters() if not name.startswith("filter")]
        groups: list[dict[str, Any]] = [{"params": rest}, {"params": self.generator.filter.parameters()}]
        self._make = torch.optim.Adam(groups, lr=settings.rate)
        self._judge = torch.optim.Adam(self.discriminator.parameters(), lr=settings.rate, betas=(0.5, 0.9))

    def _face_scale(self) -> Tensor:
        sample = torch.tensor(
            np.concatenate([performance.weights for performance in self._material[::5]]), dtype=torch.float32
        )
        return discriminator_inputs(sample[None], self._distances)[0].std(dim=0).clamp(min=0.005)

    def _seen(self, weights: Tensor) -> Tensor:
        """Return what the discriminator is fed, in units of its own spread."""
        return discriminator_inputs(weights, self._distances) / self.discriminator.scale

    def advance(self, unit: int) -> dict[str, float]:
        """Take one step, which depends on the settings and its number alone; returns every loss term by name."""
        settings, part = self.settings, unit >= self.settings.shared_steps
        self.generator.filter.requires_grad_(part)
        rng = np.random.default_rng([settings.seed, unit])
        torch.manual_seed(settings.seed * 1_000_003 + unit)
        against = part and self._adversary
        self._pace(unit, part=part)
        size = settings.batch // 2 if against else settings.batch
        ranks = rng.choice(retrieval.TUNING.candidates, 2, replace=False).tolist() if against else (None,)
        batches = make_batches(self._material, self.statistics, settings, rng, size=size, ranks=ranks)
        fills = self._generate(batches, rng)
        if against:
            terms = self._against(batches[0], *fills)
        else:
            shares = replace(settings.shares, far=1.0)  # truth counts everywhere: nothing else would
            terms = _means(fill_losses(fills[0], batches[0], self._distances, shares))
        self._make.zero_grad()
        torch.stack([term for name, term in terms.items() if not name.startswith("judge")]).sum().backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self.generator.parameters(), 1.0)
        self._make.step()
        self.kept.update_parameters(self.generator)
        return {name: float(term.detach()) for name, term in terms.items()}

    def _pace(self, step: int, *, part: bool) -> None:
        """Halve the rate once the ways part and let it fall to a tenth of that by the end."""
        done = (step - self.settings.shared_steps) / max(1, self.settings.parted_steps)
        rate = self.settings.rate * (1 - 0.9 * done if part else 2.0)
        for group, pace in zip(self._make.param_groups, (1.0, self.settings.filter_pace), strict=True):
            group["lr"] = rate * pace

    def _generate(self, batches: Sequence[Batch], rng: np.random.Generator) -> Tensor:
        """Fill each window once on each base motion, with different noise, (bases, batch, frames, 52)."""
        size, frames = batches[0].truth.shape[:2]
        noise = torch.from_numpy(np.stack([noise_curves(frames, rng) for _ in range(len(batches) * size)]))
        motion = self.generator(torch.cat([batch.features for batch in batches]), noise)
        blends, bases = (torch.stack([getattr(batch, name) for batch in batches]) for name in ("blend", "base"))
        fills: Tensor = bases + blends * motion.unflatten(0, (len(batches), size))
        return fills

    def _against(self, batch: Batch, first: Tensor, second: Tensor) -> dict[str, Tensor]:
        """Let the discriminator learn, then return the generator's terms with its score (equations 2 and 3).

        Each window is filled twice, with different noise over different stretches of its take, so that how fills differ
        can be compared with how truths would. Without an adversary nothing is retrieved: errors would teach to undo it.
        """
        shares, fakes = self.settings.shares, [self._seen(first), self._seen(second)]
        pair = [fill_losses(filled, batch, self._distances, shares) for filled in (first, second)]
        terms = {name: (term + pair[1][name]).mean() / 2 for name, term in pair[0].items()}
        judged: dict[str, Tensor] = {}
        for _ in range(self.settings.judge_steps):
            judged = self._judge_step(self._seen(batch.truth), [fake.detach() for fake in fakes], batch.hole)
        apart = torch.stack([spectrum_gap(filled, batch, self.generator.scale) for filled in (first, second)]).mean()
        terms["adversary"] = -shares.adversary * self.discriminator(torch.cat(fakes)).mean()
        terms["spectrum"] = shares.spectrum * apart
        terms["scatter"] = shares.scatter * scatter(first, second, batch).mean()
        return terms | judged

    def _judge_step(self, real: Tensor, fakes: list[Tensor], hole: Tensor) -> dict[str, Tensor]:
        """Take one step of the discriminator: each fill is judged beside the very truth that it stands in for.

        All the rest of a window is alike in both and cancels out (Jolicoeur-Martineau 2018, relativistic pairs). Judged
        apart, as in the paper, it learnt nothing in as many steps as there is time for: half of held pairs right, not 88 %.
        """
        lead = self.discriminator(real) - torch.stack([self.discriminator(fake) for fake in fakes])
        hinge = (1 - lead).relu().mean()
        share = torch.rand(len(real), 1, 1)
        between = (share * real + (1 - share) * fakes[0]).requires_grad_()
        slope = torch.autograd.grad(self.discriminator(between).sum(), between, create_graph=True)[0]
        masked = slope * hole.amax(dim=2, keepdim=True)
        penalty = self.settings.shares.penalty * (masked.flatten(1).norm(dim=1) - 1).square().mean()
        self._judge.zero_grad()
        (hinge + penalty).backward()
        self._judge.step()
        return {"judge_hinge": hinge.detach(), "judge_penalty": penalty.detach()}

    def filler(self) -> Filler:
        """Return the averaged network, ready for use."""
        generator = Generator(self.generator.config)
        generator.load_state_dict(self.kept.module.state_dict())
        return Filler(generator, self.statistics)

    def _parts(self) -> Parts:
        modules = {"generator": self.generator, "kept": self.kept, "discriminator": self.discriminator}
        return Parts(modules, {"make": self._make, "judge": self._judge})

    def state(self) -> State:
        """Return both networks, the averaged one and what Adam knows of them."""
        return State(self._parts().tensors())

    def restore(self, state: State) -> None:
        """Take over such a state."""
        self._parts().restore(state.tensors)


def _means(losses: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name: term.mean() for name, term in losses.items()}


def train(data: Path, out: Path = MODELS, settings: Settings | None = None, report: Report = print) -> dict[str, Any]:
    """Train the network and its twin without adversary; writes both with their cards, returns validation figures.

    Stop it at any time: it goes on from the last hundred steps. Raises `EngineError` where there are no takes.
    """
    settings = settings or Settings()
    training, validation, _ = split(data)
    material = performances(training, settings.help, np.random.default_rng(settings.seed), listened(data))
    figures: dict[str, Any] = {}
    for name, adversary in (("inpaint", True), ("inpaint_feedforward", False)):
        trainer = Trainer(material, settings, adversary=adversary)
        with one_thread():
            seconds = loop.train(trainer, _schedule(name, trainer, material, out), report)
        figures[name] = validation_figures(trainer.filler(), validation, training)
        report(f"{name}: {figures[name]}")
        save_filler(out / f"{name}.safetensors", trainer.filler())
        save_card(out / f"{name}.safetensors", _card(name, training, settings, figures[name], seconds))
        (out / f"{name}.partial.safetensors").unlink(missing_ok=True)
    (out / SHARED).unlink(missing_ok=True)
    return figures


def _schedule(name: str, trainer: Trainer, material: Sequence[Performance], out: Path) -> Schedule:
    """Return how one way is trained: the steps before the ways part have a checkpoint in common."""
    settings = trainer.settings
    last = settings.shared_steps + settings.parted_steps
    return Schedule(
        last,
        out / f"{name}.partial.safetensors",
        identity(settings, (performance.weights for performance in material)),
        label=lambda done: f"{name} {done}/{last}",
        every=EVERY,
        shared=out / SHARED,
        shared_units=settings.shared_steps,
    )


def _card(name: str, training: Sequence[Piece], settings: Settings, metrics: dict[str, Any], seconds: float) -> Card:
    return Card(
        kind="inpaint",
        data={"recorded_seconds": recorded_seconds(training), "synthetic_minutes": settings.help.synthetic_minutes},
        split="train; figures on the last 15 % of each training take; test takes never seen",
        seed=settings.seed,
        commit=commit(),
        settings=asdict(settings),
        metrics={"validation": metrics, "training_seconds": round(seconds)},
        notes="The twin without adversary is kept for comparison." if name.endswith("feedforward") else "",
    )
