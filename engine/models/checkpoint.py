"""Model files: safetensors that name what they are, with a card beside them."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save

from engine import assets
from engine.errors import AssetError
from engine.formats.atomic import write_bytes

MODELS = assets.MODELS
VERSION = 1


@dataclass(frozen=True)
class Card:
    """What a person must know before trusting a model: data, split, seed, commit, metrics."""

    kind: str
    data: dict[str, Any]
    split: str
    seed: int
    commit: str
    settings: dict[str, Any]
    metrics: dict[str, Any]
    notes: str = ""


def save_model(path: Path, tensors: Mapping[str, torch.Tensor], *, kind: str, config: Mapping[str, Any]) -> None:
    """Write tensors with their kind, format version and configuration, whole or not at all."""
    metadata = {"kind": kind, "version": str(VERSION), "config": json.dumps(config)}
    contiguous = {name: tensor.detach().contiguous() for name, tensor in tensors.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, [save(contiguous, metadata=metadata)])


def load_model(path: Path, *, kind: str) -> tuple[dict[str, torch.Tensor], dict[str, Any]]:
    """Return tensors and configuration; raises `AssetError` when the file is missing, damaged or of another kind."""
    try:
        with safe_open(str(path), framework="pt") as file:
            metadata = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - not a dict
    except (OSError, SafetensorError) as error:
        raise AssetError(
            f"The model file {path.name} is missing or damaged.", f"Train it: retake train {kind}."
        ) from error
    if metadata.get("kind") != kind or metadata.get("version") != str(VERSION):
        raise AssetError(f"{path.name} is not a {kind} model of this version.", f"Train it: retake train {kind}.")
    return tensors, json.loads(metadata.get("config", "{}"))


def save_card(path: Path, card: Card) -> None:
    """Write a card as JSON beside its model."""
    write_bytes(path.with_suffix(".card.json"), [json.dumps(asdict(card), indent=2).encode() + b"\n"])


def commit() -> str:
    """Return the commit that the program is at, with a mark if the working tree differs; empty outside a checkout."""
    try:
        run = subprocess.run(
            ["git", "describe", "--always", "--dirty"],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return run.stdout.strip()
