"""The bundled demo take: "Maybe we should move. I have been happy before. Watch me smile.\""""

from __future__ import annotations

from pathlib import Path

from engine import assets
from engine.formats import write_take
from engine.lab.performer.performer import Script, perform
from engine.take import Take

BUNDLED = assets.DEMO_TAKE
PHONES = (
    "SIL SIL M EY1 B IY W IY SH UH D M UW1 V SIL SIL AY HH AE V B IH N HH AE1 P IY B IH F AO1 R SIL SIL SIL "
    "W AA1 CH M IY S M AY1 L SIL SIL SIL SIL SIL DH AH M UW1 V IY Z AA R P R IH T IY1 G UH D SIL SIL"
)
SCRIPT = Script(
    phones=tuple(PHONES.split()), smiles=((5.2, 7.6),), blinks_per_min=24.0, tempo=0.85, seed=7, lost_s=((8.4, 9.2),)
)


def performance() -> Take:
    """Return the demo performance."""
    return perform(SCRIPT, name="demo")


def build(path: Path = BUNDLED) -> None:
    """Write the demo take; the same script gives the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_take(performance(), path)
