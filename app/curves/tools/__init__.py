"""What the mouse does in the lanes: one tool at a time, each gesture one undo step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from app.curves.tools.base import Tool
from app.curves.tools.drag import DragTool
from app.curves.tools.draw import DrawTool
from app.curves.tools.mark import MarkTool, ScrubTool
from app.curves.tools.scale import ScaleTool

if TYPE_CHECKING:
    from app.curves.panel import CurvesPanel

TOOLS: dict[str, type[Tool]] = {
    "drag": DragTool,
    "draw": DrawTool,
    "scale": ScaleTool,
    "pin": ScrubTool,
    "mark": MarkTool,
    "clean": ScrubTool,
    "live": ScrubTool,
    "retarget": ScrubTool,
    "review": ScrubTool,
}


def make_tools(panel: CurvesPanel) -> dict[str, Tool]:
    """Return one tool of each kind, by name."""
    return {name: kind(panel) for name, kind in TOOLS.items()}
