"""The 52 shapes of the ARKit standard as motions of the sculpture."""

from __future__ import annotations

from collections.abc import Callable

from engine.lab.modelling.sculpture import Sculpture
from engine.lab.modelling.shapes import eyes, face, jaw, mouth
from engine.lab.modelling.shapes.fields import Stroke, strokes
from engine.take import Array

Modelled = dict[str, Callable[[Sculpture], Array]]


def _stroked(*pushes: Stroke) -> Callable[[Sculpture], Array]:
    return lambda head: strokes(head, *pushes)


MIDDLE: Modelled = {
    "jawOpen": jaw.jaw_open,
    "jawForward": jaw.jaw_forward,
    "mouthClose": jaw.mouth_close,
    "mouthPucker": mouth.mouth_pucker,
    "mouthFunnel": mouth.mouth_funnel,
    "mouthRollLower": mouth.mouth_roll_lower,
    "mouthRollUpper": mouth.mouth_roll_upper,
    "mouthShrugLower": mouth.mouth_shrug_lower,
    "mouthShrugUpper": mouth.mouth_shrug_upper,
    "tongueOut": mouth.tongue_out,
    "cheekPuff": face.cheek_puff,
    "browInnerUp": face.brow_inner_up,
}
LEFT: Modelled = {
    "jaw": jaw.jaw_left,
    "mouth": _stroked(*mouth.SIDEWAYS),
    **{name: _stroked(*pushes) for name, pushes in mouth.CORNER_STROKES.items()},
    "mouthPress": mouth.mouth_press,
    "mouthUpperUp": mouth.mouth_upper_up,
    "mouthLowerDown": mouth.mouth_lower_down,
    "cheekSquint": face.cheek_squint,
    "noseSneer": face.nose_sneer,
    "browDown": face.brow_down,
    "browOuterUp": face.brow_outer_up,
    "eyeBlink": eyes.eye_blink,
    "eyeWide": eyes.eye_wide,
    "eyeSquint": eyes.eye_squint,
    "eyeLookUp": eyes.eye_look_up,
    "eyeLookDown": eyes.eye_look_down,
    "eyeLookIn": eyes.eye_look_in,
    "eyeLookOut": eyes.eye_look_out,
}


def shapes(head: Sculpture) -> dict[str, Array]:
    """Return the motion, (n, 3) in cm, of every shape by name; right shapes mirror the left ones."""
    moved = {name: head.symmetric(model(head)) for name, model in MIDDLE.items()}
    for name, model in LEFT.items():
        left = model(head)
        moved[f"{name}Left"], moved[f"{name}Right"] = left, head.flip(left)
    return moved
