"""What a take was imported as, in words: its rate and where that is from, its sides and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

from engine.formats.base.reading import AUTOMATIC, SIDES_IN_WORDS, Reading
from engine.formats.livelink import reader
from engine.formats.livelink.clock import Clock, clock_of
from engine.formats.livelink.origin import Origin
from engine.formats.livelink.sides import Judgement
from engine.take import Take

SAME = 1e-6  # two rates that differ by less are one


@dataclass(frozen=True, eq=False)
class Imported:
    """What the file of a take says of itself.

    Attributes
    ----------
    clock : what its timecodes tell
    judged : what its motion tells of the sides
    """

    clock: Clock
    judged: Judgement

    def rate_reason(self, fps: float, chosen: Reading = AUTOMATIC) -> str:
        """Return where a rate is from, in a few words."""
        if abs(fps / self.clock.fps - 1) < SAME:
            return self.clock.reason
        stated = "no rate that can be believed" if self.clock.reason == "assumed" else f"{self.clock.fps:.5g}"
        return f"{'as asked' if chosen.fps is not None else 'from take.json'}; the timecodes say {stated}"

    def sides_reason(self, *, swapped: bool) -> str:
        """Return what the motion tells of the sides that a take was read with, in a few words."""
        judged = self.judged
        if judged.agreement is None:
            return judged.confidence
        if judged.recorded == swapped:
            return f"by the motion, {judged.confidence}"
        return f"as asked; the motion says {in_words(judged.recorded)}, {judged.confidence}"


def in_words(swapped: bool) -> str:
    """Return what sides are called that are exchanged, as the app records them, or not."""
    return SIDES_IN_WORDS["recorded" if swapped else "named"]


def imported(take: Take) -> Imported | None:
    """Return what the file of a take says of itself; None where it is from none that says anything."""
    origin = take.origin
    if not isinstance(origin, Origin):
        return None
    return Imported(clock_of(origin.timecodes), reader.judged(origin))
