"""The table of kinds: what each flag is called, what finds it, its threshold, and whether it counts by itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from engine.quality import edit, eyes, lips, shape, sound, tracker
from engine.quality.record import Flag
from engine.quality.seen import Seen
from engine.quality.tuning import TUNING

_T = TUNING


def _beside(frames: int) -> Callable[[Seen], int]:
    return lambda seen: frames


@dataclass(frozen=True)
class Threshold:
    """What a project may set of a kind of flag: a field of `Tuning`, its unit and its limits."""

    name: str
    unit: str
    lowest: float
    highest: float

    def within(self, value: float) -> float:
        """Return the nearest value that is allowed."""
        return min(self.highest, max(self.lowest, value))


@dataclass(frozen=True)
class Kind:
    """A kind of flag.

    Attributes
    ----------
    name, title : in tables and on the screen
    find : yields the flags of the frames [low, high) of what is seen
    threshold : what is flagged, with units, for people
    reach : frames to either side that a verdict on a frame needs; None where it needs the whole take
    on : whether it is looked for unless somebody says otherwise
    setting : the threshold that a project may set; None where there is none
    """

    name: str
    title: str
    find: Callable[[Seen, int, int], Iterator[Flag]]
    threshold: str
    reach: Callable[[Seen], int] | None = None
    on: bool = True
    setting: Threshold | None = None


TABLE: tuple[Kind, ...] = (
    Kind("lost", "no face", tracker.lost, "any frame without a face", _beside(1)),
    Kind(
        "spike",
        "a spike",
        tracker.spikes,
        f"a weight leaps by {_T.leap:g} for one frame and returns to within {_T.returns:g}",
        _beside(2),
        setting=Threshold("leap", "weight", 0.05, 0.45),
    ),
    Kind(
        "frozen",
        "frozen frames",
        tracker.frozen,
        f"frames like the one before for {_T.least_freeze_s:g} s",
        lambda seen: 1 + tracker.least_repeats(seen),
        setting=Threshold("least_freeze_s", "s", 0.05, 10),
    ),
    Kind(
        "jitter",
        "trembling",
        tracker.jitter,
        f"noise of {_T.jitter:g} weight on most frames of {_T.jitter_s:g} s",
        lambda seen: tracker.jitter_block(seen) + 4,
        setting=Threshold("jitter", "weight", 0.005, 0.09),
    ),
    Kind(
        "pop",
        "a step",
        tracker.pops,
        f"a weight steps by {_T.pop:g} in one frame and stays, eyes and tongue left out",
        lambda seen: max(2, round(seen.tuning.pop_beside_s * seen.fps)) + 2,
        setting=Threshold("pop", "weight", 0.05, 0.55),
    ),
    Kind(
        "head",
        "the head jumps",
        tracker.head,
        f"a turn of {_T.jump_deg:g}° more than beside it",
        _beside(4),
        setting=Threshold("jump_deg", "°", 1, 24),
    ),
    Kind(
        "impossible",
        "no face does this",
        shape.impossible,
        f"two excluding shapes above {_T.both:g}, rounded and wide lips above {_T.both_wide:g}",
        _beside(1),
        setting=Threshold("both", "weight", 0.2, 0.95),
    ),
    Kind(
        "unlike",
        "unlike recorded faces",
        shape.unlike,
        f"a mouth {_T.unlike_times:g} times as far from the mean as any recorded one",
        _beside(1),
        on=False,  # of people whom the prior does not know it flags what is theirs: 1.2 false ones a minute
        setting=Threshold("unlike_times", "times as far", 0.5, 2.4),
    ),
    Kind(
        "range",
        "out of range",
        shape.out_of_range,
        f"a weight below {_T.least_weight:g} or above {_T.most_weight:g}, of gaze {_T.most_gaze:g}",
        _beside(1),
        setting=Threshold("most_weight", "weight", 1, 2),
    ),
    Kind(
        "through",
        "through each other",
        shape.crossing,
        f"lips {_T.through_lips_mm:g} mm or lids {_T.through_lids_mm:g} mm through each other",
        _beside(1),
        setting=Threshold("through_lips_mm", "mm", 0.1, 7),
    ),
    Kind(
        "swapped",
        "left and right exchanged",
        shape.swapped,
        f"a correlation below −{_T.swapped:g}",
        setting=Threshold("swapped", "correlation", 0.1, 0.85),
    ),
    Kind(
        "open",
        "lips stay open",
        lips.stay_open,
        f"lips {_T.closed_mm:g} mm apart where they should meet",
        setting=Threshold("closed_mm", "mm", 0.5, 7),
    ),
    Kind(
        "teeth",
        "lip off the teeth",
        lips.off_teeth,
        f"lips {_T.teeth_mm:g} mm apart all through an F or V",
        setting=Threshold("teeth_mm", "mm", 2, 19),
    ),
    Kind(
        "close",
        "lips close too far",
        lips.close_above_jaw,
        f"mouthClose {_T.above_jaw:g} above jawOpen",
        _beside(1),
        setting=Threshold("above_jaw", "weight", 0.01, 0.45),
    ),
    Kind(
        "unclosed",
        "a blink stays open",
        eyes.unclosed,
        f"lids {_T.unclosed_mm:g} mm apart at the bottom of a blink, and {_T.unlike_mm:g} mm more than in others",
        setting=Threshold("unclosed_mm", "mm", 1, 5.5),
    ),
    Kind(
        "late",
        "one eye late",
        eyes.late,
        f"lids {_T.late_s:g} s apart in a blink",
        eyes.reach,
        setting=Threshold("late_s", "s", 0.02, 0.19),
    ),
    Kind(
        "unblinking",
        "no blinks",
        eyes.unblinking,
        f"{_T.unblinking_s:g} s without a blink",
        setting=Threshold("unblinking_s", "s", 5, 59),
    ),
    Kind(
        "missed",
        "asked for, not reached",
        edit.missed,
        f"{_T.missed_mm:g} mm or degrees off",
        _beside(1),
        setting=Threshold("missed_mm", "mm or °", 0.2, 7.5),
    ),
    Kind(
        "seam",
        "an edit's border shows",
        edit.seams,
        f"a step of {_T.seam:g}, or a turn of {_T.seam_slope:g} a second, beyond the take's own",
        edit.seam_reach,
        setting=Threshold("seam", "weight", 0.01, 0.45),
    ),
    Kind(
        "short",
        "ends before its sound",
        sound.short,
        f"{_T.short_s:g} s of sound after the end",
        setting=Threshold("short_s", "s", 0.05, 1.9),
    ),
    Kind(
        "sound",
        "out of step with the sound",
        sound.out_of_step,
        f"{_T.out_of_step_s:g} s from the loudness",
        setting=Threshold("out_of_step_s", "s", 0.02, 0.38),
    ),
)
