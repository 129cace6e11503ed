"""Where a training run stands: enough to go on from the last epoch as if it had never stopped."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from engine.errors import AssetError
from engine.models.checkpoint import load_model, save_model

KIND = "regress_partial"


@dataclass
class Standing:
    """Position in a run.

    Attributes
    ----------
    stage, epoch : stage under way and how many of its epochs are done
    terms : validation terms of the last epoch that is done
    figures : validation terms of the stages that are finished
    """

    stage: int = 0
    epoch: int = 0
    terms: dict[str, float] = field(default_factory=dict)
    figures: dict[str, float] = field(default_factory=dict)


def save(
    path: Path,
    standing: Standing,
    *,
    run: dict[str, Any],
    network: torch.nn.Module,
    optimizer: torch.optim.Optimizer,
) -> None:
    """Write everything that the next epoch depends on; `run` names settings and data, which must be the same later."""
    tensors = {f"network.{name}": value for name, value in network.state_dict().items()}
    for index, state in optimizer.state_dict()["state"].items():
        tensors |= {f"optimizer.{index}.{name}": value for name, value in state.items()}
    save_model(path, tensors, kind=KIND, config={"standing": asdict(standing), "run": run})


def load(path: Path, *, run: dict[str, Any]) -> tuple[Standing, dict[str, dict[str, Tensor]]] | None:
    """Return the standing and the tensors by group, or None where there is nothing to go on from."""
    try:
        tensors, config = load_model(path, kind=KIND)
    except AssetError:
        return None
    if config["run"] != run:
        return None
    groups: dict[str, dict[str, Tensor]] = {"network": {}, "optimizer": {}}
    for name, value in tensors.items():
        group, rest = name.split(".", 1)
        groups[group][rest] = value
    return Standing(**config["standing"]), groups


def restore_optimizer(optimizer: torch.optim.Optimizer, tensors: dict[str, Tensor]) -> None:
    """Give an optimizer of the same parameters the moments that were saved."""
    state: dict[int, dict[str, Tensor]] = {}
    for name, value in tensors.items():
        index, key = name.split(".", 1)
        state.setdefault(int(index), {})[key] = value
    optimizer.load_state_dict(optimizer.state_dict() | {"state": state})
