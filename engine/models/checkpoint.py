"""Model files: safetensors that name what they are, with a card beside them."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeVar

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save

from engine import assets
from engine.errors import AssetError
from engine.formats.base.atomic import write_bytes

MODELS = assets.MODELS
VERSION = 1
MAX_SIZE = 4096  # units, layers or frames; the largest in use is 512
# What torch and a network's constructor raise for sizes and names that do not fit.
FAULTS = (TypeError, ValueError, KeyError, IndexError, AttributeError, RuntimeError, OverflowError, ZeroDivisionError)
Network = TypeVar("Network", bound=torch.nn.Module)


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
    except (OSError, SafetensorError, ValueError, RuntimeError, TypeError, OverflowError) as error:
        raise AssetError(
            f"The model file {path.name} is missing or damaged.", f"Train it: retake train {kind}."
        ) from error
    if metadata.get("kind") != kind or metadata.get("version") != str(VERSION):
        raise AssetError(f"{path.name} is not a {kind} model of this version.", f"Train it: retake train {kind}.")
    return tensors, _config(metadata.get("config", "{}"), path, kind)


def rebuilt(build: Callable[[], Network], tensors: Mapping[str, torch.Tensor], path: Path, *, kind: str) -> Network:
    """Return the network that `build` makes, with the tensors of its file, ready to infer.

    It is made without memory first, so that sizes that the file's tensors do not have take none. Raises `AssetError`.
    """
    try:
        with torch.device("meta"):
            expected = {name: tensor.shape for name, tensor in build().state_dict().items()}
        if expected != {name: tensor.shape for name, tensor in tensors.items()}:
            raise ValueError("its tensors are those of another network")
        network = build()
        network.load_state_dict(dict(tensors))
    except FAULTS as error:
        raise _damaged(path, kind) from error
    network.eval()
    return network


def _config(text: str, path: Path, kind: str) -> dict[str, Any]:
    """Return a configuration, whose numbers are those of a network that can be."""
    try:
        config = json.loads(text)
        if not isinstance(config, dict):
            raise ValueError("a configuration is a table")
        _require_sizes(config)
    except (ValueError, TypeError, RecursionError, MemoryError) as error:
        raise _damaged(path, kind) from error
    return config


def _require_sizes(value: Any) -> None:
    """Raise `ValueError` for a whole number that no size of a network is: a million layers would be built one by one."""
    if isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            _require_sizes(each)
    elif isinstance(value, int) and not -MAX_SIZE <= value <= MAX_SIZE:
        raise ValueError("a size of the network is not possible")


def _damaged(path: Path, kind: str) -> AssetError:
    return AssetError(f"The model file {path.name} is damaged.", f"Train it: retake train {kind}.")


def save_card(path: Path, card: Card) -> None:
    """Write a card as JSON beside its model."""
    write_bytes(path.with_suffix(".card.json"), [json.dumps(asdict(card), indent=2).encode() + b"\n"])


def commit() -> str:
    """Return the commit that the program is at, with a mark if the working tree differs; empty outside a checkout."""
    try:
        run = subprocess.run(
            ["git", "describe", "--always", "--dirty"],
            cwd=assets.PACKAGE,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return run.stdout.strip()
