"""Per-frame ridge regression: what the controls of one frame say about its weights, and nothing else."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn

from engine.lab.evaluate.baselines.parts import Areas, Material, Report, columns_of, restore
from engine.regress.areas import Area

PENALTIES = (1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0)  # of standardised controls; the best on validation is taken


class Ridge(nn.Module):
    """Weights are an affine function of standardised controls."""

    mean: Tensor
    scale: Tensor

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.linear = nn.Conv1d(inputs, outputs, 1)
        self.register_buffer("mean", torch.zeros(1, inputs, 1))
        self.register_buffer("scale", torch.ones(1, inputs, 1))

    def forward(self, controls: Tensor) -> Tensor:
        """Return weights, (batch, shapes, frames), of controls, (batch, controls, frames) in mm."""
        mapped: Tensor = self.linear((controls - self.mean) / self.scale)
        return mapped

    def solve(self, controls: Tensor, weights: Tensor, penalty: float) -> None:
        """Minimise mean |W - X B - b|^2 + penalty |B|^2 over the windows."""
        self.mean.copy_(controls.mean(dim=(0, 2))[None, :, None])
        self.scale.copy_(controls.std(dim=(0, 2))[None, :, None])
        x = ((controls - self.mean) / self.scale).permute(0, 2, 1).flatten(0, 1).double()
        y = weights.permute(0, 2, 1).flatten(0, 1).double()
        centre = y.mean(dim=0)
        gram = x.T @ x / len(x) + penalty * torch.eye(x.shape[1], dtype=x.dtype)
        slope = torch.linalg.solve(gram, x.T @ (y - centre) / len(x))
        with torch.no_grad():
            self.linear.weight.copy_(slope.T[:, :, None])
            self.linear.bias.copy_(centre)  # type: ignore[union-attr]


def train(materials: list[Material], report: Report) -> tuple[dict[str, nn.Module], dict[str, Any]]:
    """Solve each area with the penalty that validates best; returns the modules and their figures."""
    modules: dict[str, nn.Module] = {}
    figures: dict[str, Any] = {}
    for material in materials:
        module = _empty(material.area, every=material.every)
        controls, weights = material.pick(material.source.first)
        seen, truth = material.pick(material.valid)
        errors = {}
        for penalty in PENALTIES:
            module.solve(controls, weights, penalty)
            with torch.inference_mode():
                errors[penalty] = float((module(seen) - truth).square().mean())
        best = min(errors, key=errors.__getitem__)
        module.solve(controls, weights, best)
        modules[material.area.name] = module
        figures[material.area.name] = {"penalty": best, "mse": errors[best]}
        report(f"ridge {material.area.name}: penalty {best:g}, validation mse {errors[best]:.5f}")
    return modules, figures


def _empty(area: Area, *, every: bool) -> Ridge:
    return Ridge(len(columns_of(area, every=every)), len(area.shape_columns))


def load(*, every: bool = False) -> Areas:
    """Return the baseline that ships, or the same with the extended controls."""
    modules = restore("ridge_16" if every else "ridge", lambda area, _: _empty(area, every=every))
    return Areas(modules, alignment=1, every=every)
