"""Inference with the cleaning network, one frame at a time, for a live stream or a recorded take (BSS20b)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.clean.inertialisation import Inertialisation, advance, no_offset
from engine.clean.network import _OFFSET, _RATE, CleanNetwork, from_config
from engine.models.checkpoint import MODELS, load_model, rebuilt
from engine.take import MODEL_FPS, SHAPES

Floats = npt.NDArray[np.float32]
_SHAPES = len(SHAPES)


@dataclass(frozen=True)
class Tuning:
    """Settings of the inference; ranges tried were not recorded."""

    plausible: tuple[float, float] = (-1.0, 2.0)  # weight; beyond it is a fault of tracker or network, not a face
    frozen_s: float = 1.0  # seconds of identical frames after which the tracker counts as frozen
    lead_s: float = 0.008  # seconds by which a moving shape is extrapolated, about the lag of the estimate
    lead_fps: float = 60.0  # below this rate a velocity is outdated, and a full lead would put corners into the motion
    slow_per_s: float = 0.5  # weight per second; slower motion is not extrapolated, which would be jitter at rest
    step_s: tuple[float, float] = (1e-3, 0.5)  # seconds, range of time steps: the longest a face is extrapolated


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class CleanState:
    """The recurrent state from one frame to the next.

    Attributes
    ----------
    weights : (52,) float32, the estimate
    velocity : (52,) float32, its derivative per second
    hidden, cell : (layers, hidden) float32 of the recurrent layers
    offset : inertialisation after a lost run
    lead : (52,) float32, extrapolation of the estimate that makes up for its lag
    observed : (52,) float32, the last frame with a face
    frozen_s : seconds for which the tracker has sent that same frame
    """

    weights: Floats
    velocity: Floats
    hidden: Floats
    cell: Floats
    offset: Inertialisation
    lead: Floats
    observed: Floats
    frozen_s: float = 0.0

    @property
    def output(self) -> Floats:
        """The estimate with its offset and lead, (52,) float32 in 0..1."""
        output: Floats = np.clip(self.weights + self.offset.offset + self.lead, 0.0, 1.0)
        return output


class Cleaner:
    """Runs `CleanNetwork` in numpy for one stream: a frame takes some forty microseconds instead of torch's hundreds.

    Parameters
    ----------
    network : trained; its weights are copied
    """

    def __init__(self, network: CleanNetwork) -> None:
        def stored(tensor: object) -> Floats:
            return np.ascontiguousarray(tensor.detach().numpy(), np.float32)  # type: ignore[attr-defined]

        self._config = network.config
        self._enter = stored(network.enter.weight), stored(network.enter.bias)
        self._restore = stored(network.restore.weight), stored(network.restore.bias)
        self._leave = stored(network.leave.weight), stored(network.leave.bias)
        self._cells = [
            (
                np.concatenate([stored(cell.weight_ih), stored(cell.weight_hh)], axis=1),
                stored(cell.bias_ih) + stored(cell.bias_hh),
            )
            for cell in network.cells
        ]

    def start(self, weights: Floats) -> CleanState:
        """Return the state at rest on a first frame, (52,)."""
        still = np.zeros((self._config.layers, self._config.hidden), np.float32)
        first = np.clip(weights, 0.0, 1.0).astype(np.float32)
        rest = np.zeros(_SHAPES, np.float32)
        return CleanState(first, rest, still, still, no_offset(_SHAPES), rest, first)

    def step(self, observed: npt.ArrayLike | None, step_s: float, state: CleanState) -> CleanState:
        """Advance the state by one frame (BSS20b equations 1 and 2).

        Parameters
        ----------
        observed : (52,) the tracker's weights; None where it had no face. Implausible weights count as no face.
        step_s : time since the frame before, seconds
        """
        step = np.float32(min(max(step_s, TUNING.step_s[0]), TUNING.step_s[1]))
        frame = plausible(observed)
        present = np.float32(frame is not None)
        innovation = np.zeros(_SHAPES, np.float32)
        if frame is not None:
            innovation = frame + self._restore[0] @ frame + self._restore[1] - state.weights
        x = self._enter[0] @ _features(state, innovation, present, step) + self._enter[1]
        hidden, cell = np.empty_like(state.hidden), np.empty_like(state.cell)
        for layer, (matrix, bias) in enumerate(self._cells):
            gates = matrix @ np.concatenate([x, state.hidden[layer]]) + bias
            hidden[layer], cell[layer] = _lstm(gates, state.cell[layer])
            x = x + hidden[layer]
        rate, offset, motion = (self._leave[0] @ x + self._leave[1]).reshape(3, _SHAPES)
        follow = -np.expm1(-step * np.float32(_RATE) * np.logaddexp(np.float32(0), rate)) * present
        moved = state.weights + follow * (innovation + np.float32(_OFFSET) * offset) + step * motion
        frozen_s = 0.0
        if frame is not None and np.array_equal(frame, state.observed):
            frozen_s = state.frozen_s + float(step)
            moved = state.weights + np.float32(_frozen_gain(frozen_s)) * (moved - state.weights)
        weights = np.clip(moved, 0.0, 1.0)
        jump = weights - state.weights
        offset_after = advance(state.offset, jump, state.velocity, float(step), present=frame is not None)
        last = state.observed if frame is None else frame
        returns = frame is not None and state.offset.gap_s > 0  # the jump that ends a lost run is no motion
        lead = state.lead if returns else _lead(jump / step, step)
        return CleanState(weights, jump / step, hidden, cell, offset_after, lead, last, frozen_s)


def _lead(velocity: Floats, step_s: np.float32) -> Floats:
    """Return the extrapolation of moving shapes by the lag of the estimate: ``lead_s`` times the speed beyond slow."""
    lead_s = np.float32(TUNING.lead_s * min(1.0, 1.0 / (TUNING.lead_fps * float(step_s))) ** 2)
    return lead_s * (velocity - np.clip(velocity, -TUNING.slow_per_s, TUNING.slow_per_s))


def _frozen_gain(frozen_s: float) -> float:
    """Return the gain of the estimate's motion, 1..0, which decays while the tracker sends the same frame.

    A tracked face is never quite still; a frozen stream would otherwise leave the network oscillating for ever.
    """
    return float(np.exp(-max(0.0, frozen_s - TUNING.frozen_s) / TUNING.frozen_s))


def plausible(observed: npt.ArrayLike | None) -> Floats | None:
    """Return a frame clipped to 0..1, or None where it has a value that is not a number or far out of range."""
    if observed is None:
        return None
    frame = np.asarray(observed, np.float64)
    if not (frame.min() >= TUNING.plausible[0] and frame.max() <= TUNING.plausible[1]):  # false for NaN too
        return None
    return np.clip(frame, 0.0, 1.0).astype(np.float32)


def _features(state: CleanState, innovation: Floats, present: np.float32, step: np.float32) -> Floats:
    derivatives = np.arcsinh(np.concatenate([state.velocity, innovation / step]) / 2)
    last = np.array([present, np.log(step * np.float32(MODEL_FPS))], np.float32)
    return np.concatenate([2 * state.weights, derivatives, 4 * innovation, last])


def _lstm(gates: Floats, cell: Floats) -> tuple[Floats, Floats]:
    """Return hidden and cell of one layer from its gates in torch's order: input, forget, cell, output."""
    squashed = np.tanh(gates * _halves(len(cell)))  # one call: sigmoid(x) = (1 + tanh(x / 2)) / 2
    enter, forget, candidate, leave = squashed.reshape(4, -1)
    kept: Floats = (0.5 + 0.5 * forget) * cell + (0.5 + 0.5 * enter) * candidate
    return (0.5 + 0.5 * leave) * np.tanh(kept), kept


@lru_cache(maxsize=4)
def _halves(hidden: int) -> Floats:
    return np.repeat(np.array([0.5, 0.5, 1.0, 0.5], np.float32), hidden)


def load_network(path: Path = MODELS / "clean.safetensors") -> CleanNetwork:
    """Read the network; raises `AssetError` where it is missing or damaged."""
    tensors, config = load_model(path, kind="clean")
    return rebuilt(lambda: from_config(config), tensors, path, kind="clean")


@lru_cache(maxsize=1)
def bundled() -> Cleaner:
    """Return the cleaner that ships with the program."""
    return Cleaner(load_network())
