"""The space in which two bodies of motion are compared: a small autoencoder of its own, that no method is trained with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from engine.lab.corpus import split
from engine.lab.reporting import Report
from engine.lab.train.inpaint.material import Help, draw, performances
from engine.models.checkpoint import MODELS, Card, commit, load_model, save_card, save_model
from engine.take import SHAPES, Array

FRAMES, LATENTS = 32, 16
STEPS, BATCH, SEED = 1500, 64, 0


class MotionAutoencoder(nn.Module):
    """Two strided convolutions and a dense layer each way: (batch, 32 frames, 52) to 16 latents and back."""

    scale: Tensor
    mean: Tensor

    def __init__(self) -> None:
        super().__init__()
        shapes, wide = len(SHAPES), 64
        self.encode = nn.Sequential(
            *(nn.Conv1d(shapes, wide, 5, stride=2, padding=2), nn.ELU()),
            *(nn.Conv1d(wide, wide, 5, stride=2, padding=2), nn.ELU(), nn.Flatten()),
            nn.Linear(wide * FRAMES // 4, LATENTS),
        )
        self.decode = nn.Sequential(
            *(nn.Linear(LATENTS, wide * FRAMES // 4), nn.ELU(), nn.Unflatten(1, (wide, FRAMES // 4))),
            *(nn.ConvTranspose1d(wide, wide, 4, stride=2, padding=1), nn.ELU()),
            nn.ConvTranspose1d(wide, shapes, 4, stride=2, padding=1),
        )
        self.register_buffer("scale", torch.ones(shapes))
        self.register_buffer("mean", torch.zeros(shapes))

    def latents(self, weights: Tensor) -> Tensor:
        """Return latents, (batch, 16), of windows, (batch, 32, 52)."""
        found: Tensor = self.encode(((weights - self.mean) / self.scale).transpose(1, 2))
        return found

    def forward(self, weights: Tensor) -> Tensor:
        """Return windows as the latents hold them."""
        held: Tensor = self.decode(self.latents(weights)).transpose(1, 2) * self.scale + self.mean
        return held


def latents_of(stretches: Sequence[Array]) -> Array:
    """Return latents, (n, 16), of every half-overlapping window of stretches, (frames, 52) each; short ones are held."""
    cut = []
    for weights in stretches:
        held = np.pad(weights, ((0, max(0, FRAMES - len(weights))), (0, 0)), mode="edge")
        cut += [held[start : start + FRAMES] for start in range(0, len(held) - FRAMES + 1, FRAMES // 2)]
    with torch.inference_mode():
        return np.asarray(bundled().latents(torch.tensor(np.stack(cut), dtype=torch.float32)).numpy(), np.float64)


@lru_cache(maxsize=1)
def bundled() -> MotionAutoencoder:
    """Return the autoencoder that ships; raises `AssetError` where it is missing."""
    tensors, _ = load_model(MODELS / "motion.safetensors", kind="motion")
    network = MotionAutoencoder()
    network.load_state_dict(tensors)
    return network.eval()


def train(data: Path, out: Path = MODELS, report: Report = print) -> float:
    """Train the autoencoder on the training takes; returns its root mean square error on the validation takes."""
    torch.manual_seed(SEED)
    rng = np.random.default_rng(SEED)
    training, validation, _ = split(data)
    material = performances(training, Help(synthetic_minutes=0.0), rng)
    everything = np.concatenate([one.weights for one in material])
    network = MotionAutoencoder()
    network.mean.copy_(torch.tensor(everything.mean(axis=0)))
    network.scale.copy_(torch.tensor(np.maximum(everything.std(axis=0), 0.02)))
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-3)
    for step in range(STEPS):
        batch = torch.tensor(np.stack([draw(material, FRAMES, rng).weights for _ in range(BATCH)]), dtype=torch.float32)
        loss = ((network(batch) - batch) / network.scale).square().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        if step % 500 == 499:
            report(f"motion {step + 1}/{STEPS}: loss {float(loss.detach()):.4f}")
    kept = [piece.weights[:FRAMES] for piece in validation if len(piece.weights) >= FRAMES]
    with torch.inference_mode():
        truth = torch.tensor(np.stack(kept), dtype=torch.float32)
        error = float((network(truth) - truth).square().mean().sqrt())
    path = out / "motion.safetensors"
    save_model(path, network.state_dict(), kind="motion", config={})
    names = sorted({piece.source for piece in training})
    settings = {"steps": STEPS, "batch": BATCH, "help": asdict(Help(synthetic_minutes=0.0))}
    metrics = {"validation_rms": round(error, 5)}
    save_card(path, Card("motion", {"recordings": names}, "train", SEED, commit(), settings, metrics, _NOTES))
    return error


_NOTES = "Used by tables alone, to compare bodies of motion; no method is trained with it."
