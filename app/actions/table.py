"""Every action of the program in one table: menus, toolbar, shortcuts and the list of keys are made from it."""

from __future__ import annotations

from dataclasses import dataclass

from app.settings import PRESETS


@dataclass(frozen=True)
class Action:
    """Something the user can do.

    Attributes
    ----------
    name : method that does it, of the window or of one of the `…Actions`
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
    Action("save", "Save project", "File", ("Ctrl+S",), "Save", twin="commands read projects and write takes"),
    Action("save_as", "Save project as…", "File", ("Ctrl+Shift+S",), twin="commands read projects and write takes"),
    Action("export", "Export take…", "File", ("Ctrl+E",), "Export", twin="retake edit -o"),
    Action("attach_audio", "Attach sound…", "File", twin="a file beside the take under its name is found"),
    Action("attach_video", "Attach a reference video…", "File", twin="a file beside the take under its name is found"),
    Action("detach_audio", "Detach the sound", "File", twin="commands play nothing"),
    Action("detach_video", "Detach the reference video", "File", twin="commands play nothing"),
    Action("locate_media", "Locate missing sound or video…", "File", twin="commands play nothing"),
    Action("attach_visemes", "Attach visemes…", "File", twin="retake fill --visemes"),
    Action("load_character", "Show on another head…", "File", twin="retake render --character"),
    Action("quit", "Quit", "File", ("Ctrl+Q",), twin="ends the program"),
    Action("undo", "Undo", "Edit", ("Ctrl+Z",), "↶", twin="a command writes a new file; the old one stays"),
    Action("redo", "Redo", "Edit", ("Ctrl+Shift+Z", "Ctrl+Y"), "↷", twin="a command writes a new file"),
    Action("close_here", "Close here", "Edit", ("Shift+C",), twin="retake edit --set 0"),
    Action("hit_exactly", "Hit the curve exactly", "Edit", ("Shift+E",), checkable=True, twin="retake edit --exact"),
    Action("go_there", "Reach it all the same", "Edit", ("Shift+F",), twin="retake edit --exact"),
    Action("again", "Apply to the last edit", "Edit", ("Ctrl+R",), twin="retake edit"),
    Action("cancel", "Drop what is under way", "Edit", ("Escape",), twin="Ctrl+C"),
    Action("wider_brush", "Wider brush", "Edit", ("]",), twin="retake edit --frames"),
    Action("narrower_brush", "Narrower brush", "Edit", ("[",), twin="retake edit --frames"),
    Action("copy", "Copy", "Edit", ("Ctrl+C",), twin="works with paste in the window"),
    Action("paste", "Paste at the playhead", "Edit", ("Ctrl+V",), twin="works with copy in the window"),
    Action("name_viseme", "Name the viseme here…", "Edit", ("Shift+V",), twin="the file of visemes can be edited"),
    Action("shift_visemes", "Shift the visemes…", "Edit", twin="retake fill --visemes-offset"),
    Action("restore_visemes", "Visemes as attached", "Edit", twin="the file of visemes is never changed"),
    Action("remove_visemes", "Remove the visemes", "Edit", twin="retake fill without --visemes"),
    Action("note", "Note on this frame", "Edit", ("N",), twin="a note belongs to a project"),
    Action("show_settings", "Settings…", "Edit", ("Ctrl+,",), twin="each command has its own options"),
    Action("drag_tool", "Drag", "Tools", ("V",), "Drag", True, twin="retake edit"),
    Action("draw_tool", "Draw", "Tools", ("D",), "Draw", True, twin="retake edit --set"),
    Action("scale_tool", "Scale", "Tools", ("S",), "Scale", True, twin="retake edit --scale"),
    Action("pin_tool", "Pin", "Tools", ("K",), "Pin", True, twin="retake pin"),
    Action("mark_tool", "Mark", "Tools", ("M",), "Mark", True, twin="retake fill --frames A:B"),
    Action("fill", "Fill the span", "Tools", ("F",), "Fill", twin="retake fill"),
    Action("accept", "Keep the fill", "Tools", ("Return", "Enter"), twin="retake fill --seed"),
    Action("clean_tool", "Clean", "Tools", ("C",), "Clean", True, twin="retake clean"),
    Action("live_tool", "Live", "Tools", ("Ctrl+Shift+L",), "Live", True, twin="retake live"),
    Action("retarget_tool", "Retarget", "Tools", ("T",), "Retarget", True, twin="retake retarget"),
    Action("smooth", "Smooth", "Tools", ("Ctrl+B",), twin="retake smooth"),
    Action("show_removed", "Show what Clean removes", "View", ("Shift+R",), checkable=True, twin="retake clean --json"),
    Action("open_markers", "Carry a capture's markers…", "Retarget", twin="retake retarget MARKERS"),
    Action("choose_target", "Carry to a head…", "Retarget", twin="retake retarget --character"),
    Action("choose_target_folder", "Carry to a folder of OBJ files…", "Retarget", twin="retake character import"),
    Action("own_target", "Carry to Retake's own head", "Retarget", twin="retake retarget without --character"),
    Action("carry", "Solve the whole take", "Retarget", ("Ctrl+Return",), twin="retake retarget"),
    Action("stop_carrying", "Stop solving", "Retarget", twin="Ctrl+C"),
    Action("keep_carried", "Keep what was solved", "Retarget", ("Ctrl+Shift+Return",), twin="retake retarget -o"),
    Action("drop_carried", "Drop what was solved", "Retarget", twin="a command writes a new file"),
    Action("suggest_labels", "Suggest frames to label", "Retarget", twin="helps to label in the window"),
    Action("label_frame", "Label this frame", "Retarget", ("Ctrl+K",), twin="retake retarget --labels"),
    Action("unlabel_frame", "Remove the label of this frame", "Retarget", twin="retake retarget --labels"),
    Action(
        "go_to_loosest", "Go to the least certain frame", "Retarget", ("Ctrl+J",), twin="helps to label in the window"
    ),
    Action("save_labels", "Save labels…", "Retarget", twin="retake retarget --labels"),
    Action("read_labels", "Read labels…", "Retarget", twin="retake retarget --labels"),
    Action("place_rest", "Place the other markers", "Retarget", twin="retake retarget --landmarks"),
    Action("unplace_marker", "Remove the chosen marker", "Retarget", twin="retake retarget --landmarks"),
    Action("save_places", "Save landmark file…", "Retarget", twin="retake retarget --landmarks"),
    Action("read_places", "Read landmark file…", "Retarget", twin="retake retarget --landmarks"),
    Action("expand_lane", "Show or hide the weights below", "View", ("W",)),
    Action("play", "Play or pause", "Playback", ("Space",), "▶", True, twin="retake render -o OUT.mp4"),
    Action("play_backwards", "Play backwards", "Playback", ("J",)),
    Action("stop", "Stop", "Playback", ("Shift+K",)),
    Action("play_forwards", "Play forwards", "Playback", ("L",)),
    Action("loop", "Loop", "Playback", ("Ctrl+L",), "Loop", True),
    Action("mute", "Mute", "Playback", ("Ctrl+M",), checkable=True),
    Action("sound_later", "Sound a frame later", "Playback", ("Alt+Right",), twin="commands play nothing"),
    Action("sound_earlier", "Sound a frame earlier", "Playback", ("Alt+Left",), twin="commands play nothing"),
    Action("video_later", "Video a frame later", "Playback", ("Alt+Shift+Right",), twin="commands play nothing"),
    Action("video_earlier", "Video a frame earlier", "Playback", ("Alt+Shift+Left",), twin="commands play nothing"),
    Action("next_frame", "Next frame", "Playback", ("Right",)),
    Action("previous_frame", "Previous frame", "Playback", ("Left",)),
    Action("first_frame", "First frame", "Playback", ("Shift+Left",)),
    Action("last_frame", "Last frame", "Playback", ("Shift+Right",)),
    Action("next_span", "Next flag or span", "Playback", ("Down",), twin="retake flags"),
    Action("previous_span", "Previous flag or span", "Playback", ("Up",), twin="retake flags"),
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
# what a menu has a line above
LINES = frozenset(
    {
        "attach_audio",
        "load_character",
        "quit",
        "close_here",
        "copy",
        "name_viseme",
        "note",
        "show_settings",
        "fill",
        "clean_tool",
        "carry",
        "suggest_labels",
        "place_rest",
        "sound_later",
        "next_frame",
        "next_span",
        "set_in",
        "frame_all",
        "next_lane",
        "light_theme",
        "about",
    }
)
TOOLBAR: tuple[tuple[str, ...], ...] = (
    ("open_take", "save", "export"),
    ("undo", "redo"),
    ("drag_tool", "draw_tool", "scale_tool", "pin_tool", "mark_tool"),
    ("fill", "clean_tool", "live_tool", "retarget_tool"),
    ("play", "loop"),
)
MENUS: tuple[str, ...] = ("File", "Edit", "Tools", "Retarget", "Playback", "View", "Help")


def keys_of(entry: Action, preset: str) -> tuple[str, ...]:
    """Return an action's shortcuts under a preset."""
    return PRESETS.get(preset, {}).get(entry.name, entry.keys)
