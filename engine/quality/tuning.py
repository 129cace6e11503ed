"""The thresholds of the flags, each with its unit, the range tried on the training takes, and what it bought."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tuning:
    """Thresholds of what is flagged; each `full_` is the amount at which a flag of that kind weighs 1.

    In brackets the range tried; "of 40" are planted faults found, "false" are flags on 13.5 clean minutes, both of the
    training takes (S07-001, alex_rom_3 and the FACEGOOD ones; apfel and S88-001, which the tracker spoilt, give plants
    alone). Where there is no bracket, the value was not tuned.
    """

    # A spike leaps for one frame, comes back to within `returns`, and the frames beside it move on by less than a share
    # of the leap: a peak of three frames is an articulation.
    leap: float = 0.12  # weight [.1 .. .2]; 40 of 40, at .15 37
    returns: float = 0.05  # weight
    leap_quiet: float = 0.4  # share of the leap [.4 .. none]; false 18 -> 0
    full_leap: float = 0.5
    # seconds of frames like the one before; a single one is what a source of another rate leaves behind, and hand
    # animation holds a pose for up to .13 s
    least_freeze_s: float = 0.15
    full_freeze_s: float = 0.5
    full_loss_s: float = 1.0
    # A shape jitters where the deviation of its noise, measured by fourth differences, is above `jitter` on a share of the
    # frames of a stretch (one spike is no jitter), and is a large share of its first differences (fast speech is less).
    jitter: float = 0.015  # weight [.008 .. .03]; false 4 -> 0, 40 of 40
    jitter_share: float = 0.6  # of the frames [.4 .. .7]; false 5 -> 0, 40 of 40
    jitter_ratio: float = 0.6  # 1 is white noise [0 .. .7]; false 16 -> 0, 40 of 40
    jitter_s: float = 0.5  # seconds; stretches begin at multiples of it
    full_jitter: float = 0.1
    # A pop is a step in one frame between two stretches that move by less than a share of it.
    pop: float = 0.15  # weight [.1 .. .25]; 40 of 40, at .2 36
    pop_quiet: float = 0.2  # share of the step [.1 .. .4]; false 20 -> 1
    pop_beside_s: float = 0.067  # seconds on each side
    full_pop: float = 0.6
    jump_deg: float = 5.0  # degrees beyond the turns of the frames beside it [2 .. 5]; no take records heads: cautious
    full_jump_deg: float = 25.0
    closed_mm: float = 2.0  # mm between lips that should meet
    full_gap_mm: float = 8.0
    brief_s: float = 0.25  # seconds; lips that meet for longer rest
    teeth_mm: float = 8.0  # mm between the lips all through an F or V [5 .. 10]; 40 of 40 everywhere
    full_teeth_mm: float = 20.0
    above_jaw: float = 0.08  # weight of mouthClose beyond jawOpen [.03 .. .12]; false 11 -> 0
    full_above_jaw: float = 0.5
    # A blink is a lid that falls and rises, each by `blink_drop_mm` within `blink_within_s`.
    blink_drop_mm: float = 2.0  # mm [2 .. 4]; unclosed 36 of 40, at 3.5 28; false 3, at 3.5 1
    blink_within_s: float = 0.2  # seconds
    blink_share: float = (
        0.45  # of the way to shut that a lid falls in a blink; less is a flutter [0 .. .6]; false 2 -> 0
    )
    unclosed_mm: float = 3.0  # mm between the lids at the bottom [2.5 .. 4]; 36 of 40, at 3.5 34
    unlike_mm: float = 3.0  # mm more than at the bottom of the middle blink [1.5 .. 3]; false 7 -> 2, 35 of 40 (36)
    shut_mm: float = 1.5  # mm; lids that come nearer are shut
    glance: float = (
        0.2  # weight of eyeLookDown beyond that before or after: lids fall with the gaze [.05 .. .5]; false 4 -> 3
    )
    full_unclosed_mm: float = 6.0
    late_s: float = 0.06  # seconds between the bottoms of a blink's two lids [.03 .. .09]; 40 of 40, at .09 38
    together_s: float = 0.35  # seconds; bottoms farther apart are two blinks
    full_late_s: float = 0.2
    unblinking_s: float = 20.0  # seconds without a blink [15 .. 25]; no false one, the longest recorded is 12 s
    full_unblinking_s: float = 60.0
    both: float = 0.5  # weight of two excluding shapes [.4 .. .7]; false 6 -> 3, at .6 only 23 of 40
    both_wide: float = (
        0.65  # the same where lips are rounded and pulled wide, which three people did up to .56 [.5 .. .7]
    )
    least_weight: float = -0.02  # weights below and above are out of range
    most_weight: float = 1.05
    most_gaze: float = 1.15  # the same for gaze, of which the tracker reports up to 1.08 [1.05 .. 1.2]
    full_beyond: float = 0.5
    # Times as far from the mean mouth as the furthest of the recorded faces [1 .. 1.6]; 22 of 40, at 1.25 32. With the
    # take of most extreme faces left out of the prior, its own go up to 1.54 times as far.
    unlike_times: float = 1.6
    full_unlike_times: float = 2.5
    swapped: float = 0.35  # correlation of the mouth's way with the other side's muscles [.2 .. .5]; 40 of 40
    swapped_frames: int = 300  # takes of fewer tell too little
    full_swapped: float = 0.9
    through_lips_mm: float = 0.5  # mm on the bundled head [.2 .. 1]; no false one
    through_lids_mm: float = 4.5  # mm [3 .. 5]; shut lids overlap by up to 4 in recordings: false 2 -> 0
    full_through_mm: float = 8.0
    missed_mm: float = 2.0  # mm (or degrees) between what was asked for and what was reached
    full_miss_mm: float = 8.0
    # At an edit's border, beyond the take's own within `seam_near_s`.
    seam: float = 0.06  # weight, step [.04 .. .12]; 38 of 40 at .08, 34 at .12
    seam_slope: float = 3.0  # weight per second, change of slope [2 .. 9]; an eased edit stays below
    seam_near_s: float = 0.25  # seconds
    full_seam: float = 0.5
    short_s: float = 0.2  # seconds of sound after the take's end
    full_short_s: float = 2.0
    out_of_step_s: float = 0.08  # seconds between lips and loudness [.06 .. .15]; 40 of 40, at .15 36; no false one
    step_range_s: float = 0.6  # seconds; the largest offset that is looked for
    step_correlation: float = 0.25  # at the best offset; below it nothing is reported [.15 .. .35]
    step_gain: float = 0.05  # by which the best offset correlates better than none [.02 .. .1]
    step_least_s: float = 10.0  # seconds that lips and sound have in common
    full_out_of_step_s: float = 0.4


TUNING = Tuning()
