"""The synthetic performer: phones become a face, with blinks, glances, brow accents and a changing mood.

Speech is coarticulated by dominance functions (Cohen and Massaro 1993): every phone pulls towards its target with a
weight that falls off exponentially in time, and the face is the weighted mean of all targets.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from engine.easing import ease
from engine.errors import EngineError
from engine.lab.performer.visemes import VISEME_OF, pose_weights
from engine.take import MODEL_FPS, SHAPE_INDEX, SHAPES, Array, Take

FALL_OFF_PER_S = 16.0  # dominance drops to 1/e within 60 ms
BLINK_CLOSE_S, BLINK_OPEN_S = 0.08, 0.17  # lids fall twice as fast as they rise
SMILE = {"mouthSmile": 0.65, "cheekSquint": 0.45, "eyeSquint": 0.25, "mouthDimple": 0.15, "mouthUpperUp": 0.1}
ACCENT = {"browInnerUp": 0.45, "browOuterUp": 0.30}


@dataclass(frozen=True)
class Script:
    """What to perform.

    Attributes
    ----------
    phones : ARPAbet symbols, SIL for a pause; a digit 1 on a vowel marks stress, which the brows accent
    smiles : (start, stop) in seconds
    blinks_per_min : mean rate
    seed : the same script and seed give the same take
    """

    phones: tuple[str, ...]
    smiles: tuple[tuple[float, float], ...] = ()
    blinks_per_min: float = 18.0
    tempo: float = 1.0
    seed: int = 0
    lost_s: tuple[tuple[float, float], ...] = field(default=())


def perform(script: Script, *, fps: float = MODEL_FPS, name: str = "performance") -> Take:
    """Play a script; raises `EngineError` for a phone that is not ARPAbet."""
    rng = np.random.default_rng(script.seed)
    starts, stops, symbols = _timing(script, rng)
    time = np.arange(int(np.ceil(stops[-1] * fps))) / fps
    weights = _speech(time, starts, stops, symbols)
    weights += _accents(time, starts, stops, script.phones)
    for start, stop in script.smiles:
        swell = ease((time - start) / 0.35) * ease((stop - time) / 0.5)
        weights += swell[:, None] * pose_weights(SMILE) * (1 - 0.5 * weights)
    weights += _gaze(time, rng)
    weights = _blink(weights, time, script.blinks_per_min, rng)
    weights += _tremor(weights, fps, rng)
    weights = _keep_closures(np.clip(weights, 0.0, 1.0), time, starts, stops, symbols)
    lost = np.zeros(len(time), bool)
    for start, stop in script.lost_s:
        lost |= (time >= start) & (time < stop)
    return Take(weights=_without(weights, lost), fps=fps, lost=lost, name=name)


def _timing(script: Script, rng: np.random.Generator) -> tuple[Array, Array, list[str]]:
    symbols = [phone.rstrip("012") for phone in script.phones]
    unknown = [symbol for symbol in symbols if symbol not in VISEME_OF]
    if unknown or not symbols:
        raise EngineError(f"{unknown[0] if unknown else 'An empty script'} is not an ARPAbet phone.")
    durations = np.array([VISEME_OF[symbol].duration_s for symbol in symbols]) / script.tempo
    durations *= np.exp(0.18 * rng.standard_normal(len(symbols)))
    durations *= [1.35 if phone.endswith("1") else 1.0 for phone in script.phones]
    stops = np.cumsum(durations)
    return stops - durations, stops, symbols


def _speech(time: Array, starts: Array, stops: Array, symbols: list[str]) -> Array:
    targets = np.array([pose_weights(VISEME_OF[symbol].pose) for symbol in symbols])
    firm = np.array([VISEME_OF[symbol].firm for symbol in symbols])
    outside = np.maximum(0.0, np.maximum(starts - time[:, None], time[:, None] - stops))
    dominance = firm * np.exp(-FALL_OFF_PER_S * outside)
    return np.asarray(dominance @ targets / dominance.sum(axis=1, keepdims=True))


def _keep_closures(weights: Array, time: Array, starts: Array, stops: Array, symbols: list[str]) -> Array:
    """Shut the lips on each bilabial, whatever its neighbours and the smile do: lips that miss a B look wrong first."""
    jaw, close = SHAPE_INDEX["jawOpen"], SHAPE_INDEX["mouthClose"]
    parting = [
        SHAPE_INDEX[f"{name}{side}"] for name in ("mouthUpperUp", "mouthLowerDown") for side in ("Left", "Right")
    ]
    parting += [SHAPE_INDEX["mouthFunnel"]]
    shut = np.zeros(len(time))
    for start, stop, symbol in zip(starts, stops, symbols, strict=True):
        if symbol in ("P", "B", "M"):
            centre, half = (start + stop) / 2, (stop - start) / 2
            shut = np.maximum(shut, ease(1 - (np.abs(time - centre) - half) / 0.07))
    closed = weights.copy()
    closed[:, parting] *= (1 - shut)[:, None]
    closed[:, close] = np.maximum(weights[:, close], shut * weights[:, jaw])
    return closed


def _accents(time: Array, starts: Array, stops: Array, phones: tuple[str, ...]) -> Array:
    lift = np.zeros(len(time))
    for start, stop, phone in zip(starts, stops, phones, strict=True):
        if phone.endswith("1"):
            lift = np.maximum(lift, np.exp(-((((start + stop) / 2 - time) / 0.16) ** 2)))
    return np.asarray(lift[:, None] * pose_weights(ACCENT))


def _gaze(time: Array, rng: np.random.Generator) -> Array:
    """Saccades: the eyes rest for a while and jump within two frames."""
    weights = np.zeros((len(time), len(SHAPES)))
    aim, until = np.zeros(2), 0.0
    for index, now in enumerate(time):
        if now >= until:
            aim, until = rng.normal(0, (0.18, 0.10)), now + rng.gamma(2.0, 0.6)
        right, up = aim
        for side, inward in (("Left", max(0.0, right)), ("Right", max(0.0, -right))):
            weights[index, SHAPE_INDEX[f"eyeLookIn{side}"]] = inward
            weights[index, SHAPE_INDEX[f"eyeLookOut{side}"]] = max(0.0, -right if side == "Left" else right)
            weights[index, SHAPE_INDEX[f"eyeLookUp{side}"]] = max(0.0, up)
            weights[index, SHAPE_INDEX[f"eyeLookDown{side}"]] = max(0.0, -up)
    return weights


def _blink(weights: Array, time: Array, per_min: float, rng: np.random.Generator) -> Array:
    closed = np.zeros(len(time))
    start = rng.exponential(30.0 / per_min)
    while start < time[-1] - 0.3:
        down = np.clip((time - start) / BLINK_CLOSE_S, 0, 1)
        up = np.clip((time - start - BLINK_CLOSE_S - 0.04) / BLINK_OPEN_S, 0, 1)
        closed = np.maximum(closed, ease(down) * (1 - ease(up)))
        start += 0.5 + rng.exponential(60.0 / per_min)
    blinked = weights.copy()
    for side in ("Left", "Right"):
        blinked[:, SHAPE_INDEX[f"eyeBlink{side}"]] = closed
        blinked[:, SHAPE_INDEX[f"eyeSquint{side}"]] *= 1 - closed
        blinked[:, SHAPE_INDEX[f"eyeLookDown{side}"]] *= 1 - closed
    return blinked


def _tremor(weights: Array, fps: float, rng: np.random.Generator) -> Array:
    """A living face never rests quite: slow noise in proportion to what is active."""
    noise = rng.standard_normal(weights.shape)
    keep = np.exp(-2 * np.pi * 1.5 / fps)
    for index in range(1, len(noise)):
        noise[index] = keep * noise[index - 1] + np.sqrt(1 - keep**2) * noise[index]
    return np.asarray(noise * (0.006 + 0.03 * weights) * (weights > 1e-4))


def _without(weights: Array, lost: np.ndarray) -> Array:
    """Replace lost frames by a straight line, as an import does."""
    if not lost.any():
        return weights
    frames = np.arange(len(weights))
    return np.stack([np.interp(frames, frames[~lost], curve[~lost]) for curve in weights.T], axis=1)


def phones(script: Script) -> list[tuple[float, float, str]]:
    """Return start, stop in seconds and ARPAbet symbol of each phone, as `perform` plays them."""
    starts, stops, symbols = _timing(script, np.random.default_rng(script.seed))
    return [(float(a), float(b), symbol) for a, b, symbol in zip(starts, stops, symbols, strict=True)]
