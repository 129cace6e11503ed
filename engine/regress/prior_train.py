"""Takes the prior from the recorded training faces: covariance, limits, a sample of faces."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import torch

from engine.corpus import recorded_seconds, split
from engine.models.checkpoint import Card, commit, save_card, save_model
from engine.regress.prior import KIND, learned

FACES = 4000  # whose controls are kept; a quarter of a megabyte
SEED = 0


def train(data: Path, out: Path, report: Callable[[str], None]) -> None:
    """Write the prior of the training split of a folder of takes, and its card."""
    pieces = split(data)[0]
    prior = learned(pieces, faces=FACES, seed=SEED)
    tensors = {
        "covariance": torch.from_numpy(prior.covariance),
        "surface": torch.from_numpy(prior.surface),
        "low": torch.from_numpy(prior.low),
        "high": torch.from_numpy(prior.high),
        "fastest": torch.from_numpy(prior.fastest),
        "faces": torch.from_numpy(prior.faces).float(),
        "whole": torch.from_numpy(prior.whole).to(torch.uint8),
    }
    path = out / "prior.safetensors"
    save_model(path, tensors, kind=KIND, config={})
    card = Card(
        kind=KIND,
        data={"recorded_seconds": recorded_seconds(pieces)},
        split="training takes without their last 15 %",
        seed=SEED,
        commit=commit(),
        settings={"faces": FACES},
        metrics={},
        notes="Covariance of weights with independent sides, limits of controls, controls of a sample of faces.",
    )
    save_card(path, card)
    report(f"wrote {path.name}")
