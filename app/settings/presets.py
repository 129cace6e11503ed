"""Keys of programs that hands already know; what a preset does not name keeps Retake's own."""

from __future__ import annotations

PRESETS: dict[str, dict[str, tuple[str, ...]]] = {
    "Retake": {},
    "Blender": {
        "play": ("Space", "Alt+A"),
        "first_frame": ("Shift+Left", "Ctrl+Shift+Down"),
        "scale_tool": ("S",),
        "drag_tool": ("G",),
        "set_in": ("Ctrl+Home",),
        "set_out": ("Ctrl+End",),
        "pin_tool": ("I",),
        "next_span": ("Down", "PgUp"),
        "previous_span": ("Up", "PgDown"),
        "undo": ("Ctrl+Z",),
        "redo": ("Ctrl+Shift+Z",),
    },
    "Maya": {
        "play": ("Alt+V", "Space"),
        "drag_tool": ("W",),
        "scale_tool": ("R",),
        "pin_tool": ("S",),
        "expand_lane": ("Shift+W",),
        "next_frame": ("Right", "Alt+."),
        "previous_frame": ("Left", "Alt+,"),
        "next_span": ("Down", "."),
        "previous_span": ("Up", ","),
        "frame_all": ("Home", "A"),
        "undo": ("Ctrl+Z", "Z"),
        "redo": ("Ctrl+Y", "Shift+Z"),
    },
}
