"""The front door: one function for each verb of the user, which a window, a command and a script all call.

A verb takes a take and a request (`requests`, `heads`), and returns a `Patch`. Retargeting, cleaning with its figures and
driving a mesh return what there is beside weights. `Editor` answers many requests to one take faster. Methods are
composed here and nowhere else; they, their networks and solvers are loaded when they are first needed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from engine.editing.drags import Dragger, ask, warm_up
from engine.editing.editor import Editor
from engine.editing.frames import parse_frames
from engine.editing.heads import (
    DriveRequest,
    LabelRequest,
    Performance,
    Retargeted,
    RetargetRequest,
    capture_of,
    drive,
    retarget,
    retarget_from_labels,
    standard_places,
    suggest_frames,
)
from engine.editing.requests import (
    DEFAULT_BELIEVABILITY,
    VERBS,
    Change,
    CleanRequest,
    ControlRequest,
    DragRequest,
    PasteRequest,
    PinRequest,
    Request,
    SmoothRequest,
    SpansRequest,
    WeightRequest,
    restored,
)
from engine.editing.verbs import (
    clean,
    cleaned,
    drag,
    fill,
    fill_spans,
    fill_variants,
    lost_spans,
    merged_pins,
    paste,
    pin,
    pose_reaching,
    replace_weight,
    set_control,
    smooth,
)
from engine.inpaint.request import STYLES, FillRequest, Style
from engine.patch import Patch
from engine.quality import flags_after, flags_of
from engine.spacetime.layout import MARKERS
from engine.spacetime.matching import Matching

if TYPE_CHECKING:
    from engine.spacetime.source import Source as Source  # which brings scipy; a name is enough to ask

__all__ = [
    "DEFAULT_BELIEVABILITY",
    "MARKERS",
    "STYLES",
    "VERBS",
    "Change",
    "CleanRequest",
    "ControlRequest",
    "DragRequest",
    "Dragger",
    "DriveRequest",
    "Editor",
    "FillRequest",
    "LabelRequest",
    "Matching",
    "PasteRequest",
    "Patch",
    "Performance",
    "PinRequest",
    "Request",
    "RetargetRequest",
    "Retargeted",
    "SmoothRequest",
    "SpansRequest",
    "Style",
    "WeightRequest",
    "ask",
    "capture_of",
    "clean",
    "cleaned",
    "drag",
    "drive",
    "fill",
    "fill_spans",
    "fill_variants",
    "flags_after",
    "flags_of",
    "lost_spans",
    "merged_pins",
    "parse_frames",
    "paste",
    "pin",
    "pose_reaching",
    "replace_weight",
    "restored",
    "retarget",
    "retarget_from_labels",
    "set_control",
    "smooth",
    "standard_places",
    "suggest_frames",
    "warm_up",
]
