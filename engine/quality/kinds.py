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
class Kind:
    """A kind of flag.

    Attributes
    ----------
    name, title : in tables and on the screen
    find : yields the flags of the frames [low, high) of what is seen
    threshold : what is flagged, with units, for people
    reach : frames to either side that a verdict on a frame needs; None where it needs the whole take
    on : whether it is looked for unless somebody says otherwise
    """

    name: str
    title: str
    find: Callable[[Seen, int, int], Iterator[Flag]]
    threshold: str
    reach: Callable[[Seen], int] | None = None
    on: bool = True


TABLE: tuple[Kind, ...] = (
    Kind("lost", "no face", tracker.lost, "any frame without a face", _beside(1)),
    Kind(
        "spike",
        "a spike",
        tracker.spikes,
        f"a weight leaps by {_T.leap:g} for one frame and returns to within {_T.returns:g}",
        _beside(2),
    ),
    Kind(
        "frozen",
        "frozen frames",
        tracker.frozen,
        f"frames like the one before for {_T.least_freeze_s:g} s",
        lambda seen: 1 + tracker.least_repeats(seen.fps),
    ),
    Kind(
        "jitter",
        "trembling",
        tracker.jitter,
        f"noise of {_T.jitter:g} weight on most frames of {_T.jitter_s:g} s",
        lambda seen: tracker.jitter_block(seen.fps) + 4,
    ),
    Kind(
        "pop",
        "a step",
        tracker.pops,
        f"a weight steps by {_T.pop:g} in one frame and stays, eyes and tongue left out",
        lambda seen: max(2, round(_T.pop_beside_s * seen.fps)) + 2,
    ),
    Kind("head", "the head jumps", tracker.head, f"a turn of {_T.jump_deg:g}° more than beside it", _beside(4)),
    Kind(
        "impossible",
        "no face does this",
        shape.impossible,
        f"two excluding shapes above {_T.both:g}, rounded and wide lips above {_T.both_wide:g}",
        _beside(1),
    ),
    Kind(
        "unlike",
        "unlike recorded faces",
        shape.unlike,
        f"a mouth {_T.unlike_times:g} times as far from the mean as any recorded one",
        _beside(1),
    ),
    Kind(
        "range",
        "out of range",
        shape.out_of_range,
        f"a weight below {_T.least_weight:g} or above {_T.most_weight:g}, of gaze {_T.most_gaze:g}",
        _beside(1),
    ),
    Kind(
        "through",
        "through each other",
        shape.crossing,
        f"lips {_T.through_lips_mm:g} mm or lids {_T.through_lids_mm:g} mm through each other",
        _beside(1),
    ),
    Kind("swapped", "left and right exchanged", shape.swapped, f"a correlation below −{_T.swapped:g}"),
    Kind("open", "lips stay open", lips.stay_open, f"lips {_T.closed_mm:g} mm apart where they should meet"),
    Kind("teeth", "lip off the teeth", lips.off_teeth, f"lips {_T.teeth_mm:g} mm apart all through an F or V"),
    Kind(
        "close",
        "lips close too far",
        lips.close_above_jaw,
        f"mouthClose {_T.above_jaw:g} above jawOpen",
        _beside(1),
    ),
    Kind(
        "unclosed",
        "a blink stays open",
        eyes.unclosed,
        f"lids {_T.unclosed_mm:g} mm apart at the bottom of a blink, and {_T.unlike_mm:g} mm more than in others",
    ),
    Kind("late", "one eye late", eyes.late, f"lids {_T.late_s:g} s apart in a blink", eyes.reach),
    Kind("unblinking", "no blinks", eyes.unblinking, f"{_T.unblinking_s:g} s without a blink"),
    Kind("missed", "asked for, not reached", edit.missed, f"{_T.missed_mm:g} mm or degrees off", _beside(1)),
    Kind(
        "seam",
        "an edit's border shows",
        edit.seams,
        f"a step of {_T.seam:g}, or a turn of {_T.seam_slope:g} a second, beyond the take's own",
        edit.seam_reach,
    ),
    Kind("short", "ends before its sound", sound.short, f"{_T.short_s:g} s of sound after the end"),
    Kind("sound", "out of step with the sound", sound.out_of_step, f"{_T.out_of_step_s:g} s from the loudness"),
)
