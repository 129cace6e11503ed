"""Every action of the program in one table: menus, toolbar, shortcuts and the list of keys are made from it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Action:
    """Something the user can do.

    Attributes
    ----------
    name : method of the main window that does it
    title : in menus; with `short` on the toolbar
    menu : the menu it is in
    keys : shortcuts
    short : text on the toolbar, empty where it is not there
    checkable : whether it is on or off
    twin : the command that does the same from a shell, or why there is none
    """

    name: str
    title: str
    menu: str
    keys: tuple[str, ...] = ()
    short: str = ""
    checkable: bool = False
    twin: str = "only moves what is on screen"


ACTIONS: tuple[Action, ...] = (
    Action("open_take", "Open…", "File", ("Ctrl+O",), "Open", twin="retake FILE"),
    Action("save", "Save", "File", ("Ctrl+S",), "Save", twin="retake edit -o"),
    Action("save_as", "Save as…", "File", ("Ctrl+Shift+S",), twin="retake edit -o"),
    Action("close", "Quit", "File", ("Ctrl+Q",), twin="ends the program"),
    Action("undo", "Undo", "Edit", ("Ctrl+Z",), "↶", twin="a command writes a new file; the old one stays"),
    Action("redo", "Redo", "Edit", ("Ctrl+Shift+Z", "Ctrl+Y"), "↷", twin="a command writes a new file"),
    Action("close_here", "Close here", "Edit", ("Shift+C",), twin="retake edit --set 0"),
    Action("cancel", "Drop what is under way", "Edit", ("Escape",), twin="Ctrl+C"),
    Action("wider_brush", "Wider brush", "Edit", ("]",), twin="retake edit --frames"),
    Action("narrower_brush", "Narrower brush", "Edit", ("[",), twin="retake edit --frames"),
    Action("drag_tool", "Drag", "Tools", ("V",), "Drag", True, twin="retake edit"),
    Action("play", "Play or pause", "Playback", ("Space",), "▶", True, twin="retake render -o OUT.mp4"),
    Action("play_backwards", "Play backwards", "Playback", ("J",)),
    Action("stop", "Stop", "Playback", ("K",)),
    Action("play_forwards", "Play forwards", "Playback", ("L",)),
    Action("loop", "Loop", "Playback", ("Ctrl+L",), "Loop", True),
    Action("next_frame", "Next frame", "Playback", ("Right",)),
    Action("previous_frame", "Previous frame", "Playback", ("Left",)),
    Action("first_frame", "First frame", "Playback", ("Shift+Left",)),
    Action("last_frame", "Last frame", "Playback", ("Shift+Right",)),
    Action("next_span", "Next span", "Playback", ("Down",), twin="retake info"),
    Action("previous_span", "Previous span", "Playback", ("Up",), twin="retake info"),
    Action("set_in", "Selection begins here", "Playback", ("I",), twin="--frames A:B"),
    Action("set_out", "Selection ends here", "Playback", ("O",), twin="--frames A:B"),
    Action("clear_selection", "Clear selection", "Playback", ("Ctrl+D",), twin="--frames A:B"),
    Action("frame_all", "Show the whole take", "View", ("Home",)),
    Action("zoom_in", "Zoom in", "View", ("Ctrl+=", "=")),
    Action("zoom_out", "Zoom out", "View", ("Ctrl+-", "-")),
    Action("next_lane", "Next curve", "View", ("Ctrl+Down",)),
    Action("previous_lane", "Previous curve", "View", ("Ctrl+Up",)),
    Action("light_theme", "Light theme", "View", (), "", True),
    Action("show_keys", "Keys", "Help", ("F1",), twin="retake --help"),
    Action("about", "About Retake", "Help", (), twin="retake --version"),
)
TOOLBAR: tuple[tuple[str, ...], ...] = (
    ("open_take", "save"),
    ("undo", "redo"),
    ("drag_tool",),
    ("play", "loop"),
)
MENUS: tuple[str, ...] = ("File", "Edit", "Tools", "Playback", "View", "Help")
