"""What a take was imported as, in words: its rate and where that is from, its sides and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

from engine.formats import livelink
from engine.formats.livelink_clock import Clock, clock_of
from engine.formats.livelink_sides import Judgement
from engine.formats.reading import SIDES_IN_WORDS
from engine.take import Take

SAME = 1e-6  # two rates that differ by less are one


@dataclass(frozen=True, eq=False)
class Imported:
    """What the file of a take says of itself, beside what the take was read as.

    Attributes
    ----------
    fps : frames per second of the take
    clock : what the timecodes tell without being overruled
    recorded : whether mouth and jaw are read as the app records them
    judged : what the motion tells of the sides
    """

    fps: float
    clock: Clock
    recorded: bool
    judged: Judgement

    @property
    def overruled(self) -> bool:
        """Whether the rate is not the one that the timecodes tell."""
        return abs(self.fps / self.clock.fps - 1) > SAME

    @property
    def rate_reason(self) -> str:
        """Where the rate is from, in a few words."""
        return f"as asked; the timecodes say {self.clock.fps:.5g}" if self.overruled else self.clock.reason

    @property
    def sides(self) -> str:
        """How the sides are read, in words."""
        return SIDES_IN_WORDS["recorded" if self.recorded else "named"]

    @property
    def sides_reason(self) -> str:
        """What the motion tells of the sides, in a few words."""
        judged = self.judged
        if judged.agreement is None:
            return judged.confidence
        if judged.recorded != self.recorded:
            usual = SIDES_IN_WORDS["recorded" if judged.recorded else "named"]
            return f"as asked; the motion says {usual}, {judged.confidence}, r = {judged.agreement:+.2f}"
        return f"by the motion, {judged.confidence}, r = {judged.agreement:+.2f}"


def imported(take: Take) -> Imported | None:
    """Return what a take was imported as; None where it is from no file that says anything of it."""
    origin = take.origin
    if not isinstance(origin, livelink.Origin):
        return None
    return Imported(take.fps, clock_of(origin.timecodes), origin.swapped, livelink.judged(origin))
