"""Cleaning with the trained network: one frame at a time for a live stream, or a recorded take (BSS20b)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from engine.clean.landing import Landing, advance
from engine.clean.landing import still as no_landing
from engine.clean.network import _OFFSET, _RATE, CleanNetwork, from_config
from engine.models.checkpoint import MODELS, load_model, rebuilt
from engine.take import MODEL_FPS, SHAPES

Floats = npt.NDArray[np.float32]
_SHAPES = len(SHAPES)
BELIEVABLE = (-1.0, 2.0)  # a weight beyond these is a fault of the tracker or of the network, not a face
FROZEN_S = 1.0  # a frame that comes again for longer than this is a tracker that stands, not a face that rests
LEAD_S = 0.008  # how far ahead a moving shape is shown, at most: the estimate trails the face by about as much
LEAD_FPS = 60.0  # below this rate a speed is old news, and showing it ahead would put corners into the motion
SLOW_PER_S = 0.5  # what is slower than this is not shown ahead: at rest it would be jitter
STEP_S = (1e-3, 0.5)  # a longer gap is taken for this long: no face extrapolates further


@dataclass(frozen=True, eq=False)
class CleanState:
    """What one frame hands to the next.

    Attributes
    ----------
    weights : (52,) float32, the estimate
    velocity : (52,) float32, its derivative per second
    hidden, cell : (layers, hidden) float32 of the recurrent layers
    landing : the way back after a lost run
    ahead : (52,) float32, how far the estimate is shown ahead of itself, so that it does not trail the face
    seen : (52,) float32, the last frame with a face
    frozen_s : for how long the tracker has sent that very frame, seconds
    """

    weights: Floats
    velocity: Floats
    hidden: Floats
    cell: Floats
    landing: Landing
    ahead: Floats
    seen: Floats
    frozen_s: float = 0.0

    @property
    def shown(self) -> Floats:
        """(52,) float32, 0..1: the estimate a moment ahead, or the way back to it after a lost run."""
        shown: Floats = np.clip(self.weights + self.landing.offset + self.ahead, 0.0, 1.0)
        return shown


class Cleaner:
    """`CleanNetwork` in plain numpy for one stream: a frame costs some forty microseconds instead of torch's hundreds.

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
        return CleanState(first, rest, still, still, no_landing(_SHAPES), rest, first)

    def step(self, seen: npt.ArrayLike | None, step_s: float, state: CleanState) -> CleanState:
        """Advance one frame: state in, state out.

        Parameters
        ----------
        seen : (52,) the tracker's weights; None where it had no face. Weights that no face has count as no face.
        step_s : time since the frame before, seconds
        """
        step = np.float32(min(max(step_s, STEP_S[0]), STEP_S[1]))
        frame = believable(seen)
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
        if frame is not None and np.array_equal(frame, state.seen):
            frozen_s = state.frozen_s + float(step)
            moved = state.weights + np.float32(_awake(frozen_s)) * (moved - state.weights)
        weights = np.clip(moved, 0.0, 1.0)
        jump = weights - state.weights
        landing = advance(state.landing, jump, state.velocity, float(step), present=frame is not None)
        last = state.seen if frame is None else frame
        returns = frame is not None and state.landing.gap_s > 0  # such a leap is no motion
        ahead = state.ahead if returns else _ahead(jump / step, step)
        return CleanState(weights, jump / step, hidden, cell, landing, ahead, last, frozen_s)


def _ahead(velocity: Floats, step_s: np.float32) -> Floats:
    """Return how far moving shapes get in the time that the estimate trails them."""
    lead_s = np.float32(LEAD_S * min(1.0, 1.0 / (LEAD_FPS * float(step_s))) ** 2)
    return lead_s * (velocity - np.clip(velocity, -SLOW_PER_S, SLOW_PER_S))


def _awake(frozen_s: float) -> float:
    """Return how much the estimate still moves, 1..0, when the tracker has long sent one and the same frame.

    A living face is never quite still; a frozen stream would otherwise leave the network circling round it for ever.
    """
    return float(np.exp(-max(0.0, frozen_s - FROZEN_S) / FROZEN_S))


def believable(seen: npt.ArrayLike | None) -> Floats | None:
    """Return a frame clamped to 0..1, or None where it holds what no face has: not a number, or far out of range."""
    if seen is None:
        return None
    frame = np.asarray(seen, np.float64)
    if not (frame.min() >= BELIEVABLE[0] and frame.max() <= BELIEVABLE[1]):  # false for NaN too
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
