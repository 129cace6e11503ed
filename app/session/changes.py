"""The kinds of change that the session's one signal names."""

from __future__ import annotations

from enum import Flag, auto


class Change(Flag):
    """What kind of thing changed."""

    TAKE = auto()  # another take was opened: everything
    CURVES = auto()  # weights, and with them the controls
    DRAFT = auto()  # what the edit under way would do
    PLAYHEAD = auto()
    VIEW = auto()  # which frames are on screen
    SELECTION = auto()  # the range that tools and playback work on
    LANE = auto()  # the lane that is worked on
    LANES = auto()  # which lanes there are
    TOOL = auto()
    SAVED = auto()
    MEDIA = auto()  # sound or reference video
    MARKS = auto()  # spans, pins, notes, media or the verdict
    VISEMES = auto()  # what is said when
    FLAGS = auto()  # what was found automatically
    CHARACTER = auto()  # whose head the weights are for
    HEAD = auto()  # the head that the take is shown on
    REVIEW = auto()  # where the take differs from the recording
    READING = auto()  # the frame rate, or the sides of mouth and jaw, that the take is read with
