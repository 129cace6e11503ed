"""Every action of the program in one table: menus, toolbar, shortcuts and the list of keys are made from it."""

from __future__ import annotations

from collections.abc import Mapping
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
    submenu : the menu within that menu, empty where it is not in one
    twin : the command that does the same from a shell, or why there is none
    """

    name: str
    title: str
    menu: str
    keys: tuple[str, ...] = ()
    short: str = ""
    checkable: bool = False
    twin: str = "only moves what is on screen"
    submenu: str = ""

    @property
    def words(self) -> str:
        """The title where no menu is around it: in lists of keys."""
        title = self.title.rstrip("…")
        return f"{self.submenu}: {title}" if self.submenu else title


OTHER_HEAD = "Show on another head"


ACTIONS: tuple[Action, ...] = (
    Action("open_take", "Open…", "File", ("Ctrl+O",), "Open", twin="retake FILE"),
    Action("open_folder", "Open a take folder…", "File", twin="retake FOLDER"),
    Action("save", "Save project", "File", ("Ctrl+S",), "Save", twin="commands read projects and write takes"),
    Action("save_as", "Save project as…", "File", ("Ctrl+Shift+S",), twin="commands read projects and write takes"),
    Action("export", "Export take…", "File", ("Ctrl+E",), "Export", twin="retake edit -o"),
    Action("attach_audio", "Attach sound…", "File", twin="a file beside the take under its name is found"),
    Action("attach_video", "Attach a reference video…", "File", twin="a file beside the take under its name is found"),
    Action("detach_audio", "Detach the sound", "File", twin="commands play nothing"),
    Action("detach_video", "Detach the reference video", "File", twin="commands play nothing"),
    Action("locate_media", "Locate missing sound or video…", "File", twin="commands play nothing"),
    Action("attach_visemes", "Attach visemes…", "File", twin="retake fill --visemes"),
    Action("show_import", "How this take was read", "File", checkable=True, twin="retake info"),
    Action("quit", "Quit", "File", ("Ctrl+Q",), twin="ends the program"),
    Action("undo", "Undo", "Edit", ("Ctrl+Z",), "↶", twin="a command writes a new file; the old one stays"),
    Action("redo", "Redo", "Edit", ("Ctrl+Shift+Z", "Ctrl+Y"), "↷", twin="a command writes a new file"),
    Action("close_here", "Close here", "Edit", ("Shift+C",), twin="retake edit --set 0"),
    Action("hit_exactly", "Hit the curve exactly", "Edit", ("Shift+E",), checkable=True, twin="retake edit --exact"),
    Action("go_there", "Reach it all the same", "Edit", ("Shift+F",), twin="retake edit --exact"),
    Action("again", "Apply to the last edit", "Edit", ("Ctrl+R",), twin="retake edit"),
    Action("cancel", "Cancel", "Edit", ("Escape",), twin="Ctrl+C"),
    Action("wider_brush", "Wider brush", "Edit", ("]",), twin="retake edit --frames"),
    Action("narrower_brush", "Narrower brush", "Edit", ("[",), twin="retake edit --frames"),
    Action("copy", "Copy", "Edit", ("Ctrl+C",), twin="works with paste in the window"),
    Action("paste", "Paste at the playhead", "Edit", ("Ctrl+V",), twin="works with copy in the window"),
    Action("name_viseme", "Name the viseme here…", "Edit", ("Shift+V",), twin="the file of visemes can be edited"),
    Action("shift_visemes", "Shift the visemes…", "Edit", twin="retake fill --visemes-offset"),
    Action("restore_visemes", "Visemes as attached", "Edit", twin="the file of visemes is never changed"),
    Action("remove_visemes", "Remove the visemes", "Edit", twin="retake fill without --visemes"),
    Action("note", "Note on this frame", "Edit", ("N",), twin="a note belongs to a project"),
    Action("edit_note", "Edit the note here", "Edit", ("Shift+N",), twin="a note belongs to a project"),
    Action("delete_note", "Delete the note here", "Edit", twin="a note belongs to a project"),
    Action("show_settings", "Settings…", "Edit", ("Ctrl+,",), twin="each command has its own options"),
    Action("edit_keys", "Keys…", "Edit", twin="each command has its own options"),
    Action("drag_tool", "Drag", "Tools", ("V",), "Drag", True, twin="retake edit"),
    Action("draw_tool", "Draw", "Tools", ("D",), "Draw", True, twin="retake edit --set"),
    Action("scale_tool", "Scale", "Tools", ("S",), "Scale", True, twin="retake edit --scale"),
    Action("pin_tool", "Pin", "Tools", ("P",), "Pin", True, twin="retake pin"),
    Action("remove_pin", "Remove the pin here", "Tools", twin="the pose stays; a new command writes a new file"),
    Action("mark_tool", "Mark", "Tools", ("M",), "Mark", True, twin="retake fill --frames A:B"),
    Action("unmark_span", "Unmark the span", "Tools", ("Shift+M",), twin="the frames stay as they are"),
    Action("fill", "Fill the span", "Tools", ("F",), "Fill", twin="retake fill"),
    Action("accept", "Keep the fill", "Tools", ("Return", "Enter"), twin="retake fill --seed"),
    Action("clean_tool", "Clean", "Tools", ("C",), "Clean", True, twin="retake clean"),
    Action("live_tool", "Live", "Tools", ("Ctrl+Shift+L",), "Live", True, twin="retake live"),
    Action("retarget_tool", "Retarget", "Tools", ("T",), "Retarget", True, twin="retake retarget"),
    Action("smooth", "Smooth", "Tools", ("Ctrl+B",), twin="retake smooth"),
    Action("show_removed", "Show what Clean removes", "View", ("Shift+R",), checkable=True, twin="retake clean --json"),
    Action("open_markers", "Retarget a capture's markers…", "Retarget", twin="retake retarget MARKERS"),
    Action("choose_target", "Choose a head…", "Retarget", twin="retake retarget --character"),
    Action("choose_target_folder", "Choose a folder of OBJ files…", "Retarget", twin="retake character import"),
    Action("own_target", "Retarget to the Retake head", "Retarget", twin="retake retarget without --character"),
    Action("second_target", "Retarget to the second head", "Retarget", twin="retake retarget --character second"),
    Action("carry", "Solve the whole take", "Retarget", ("Ctrl+Return",), twin="retake retarget"),
    Action("stop_carrying", "Stop solving", "Retarget", twin="Ctrl+C"),
    Action("keep_carried", "Keep the result", "Retarget", ("Ctrl+Shift+Return",), twin="retake retarget -o"),
    Action("drop_carried", "Discard the result", "Retarget", twin="a command writes a new file"),
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
    Action("review_tool", "Review", "Review", ("Q",), "Review", True, twin="retake review"),
    Action("next_change", "Next change", "Review", ("Alt+Down",), twin="retake review --json"),
    Action("previous_change", "Previous change", "Review", ("Alt+Up",), twin="retake review --json"),
    Action("loop_change", "Loop the change here", "Review", ("Shift+Q",), checkable=True),
    Action("reply_note", "Reply to the note here", "Review", ("Ctrl+Shift+N",), twin="a note belongs to a project"),
    Action("resolve_note", "Resolve the note here", "Review", ("Alt+N",), twin="a note belongs to a project"),
    Action("next_note", "Next open note", "Review", ("Alt+PgDown",), twin="retake review --json"),
    Action("previous_note", "Previous open note", "Review", ("Alt+PgUp",), twin="retake review --json"),
    Action("draw_mark", "Draw on the face", "Review", ("Shift+D",), checkable=True, twin="a drawing goes with a note"),
    Action(
        "dismiss_flag", "Dismiss the finding here…", "Review", ("X",), twin="retake check leaves out what was dismissed"
    ),
    Action("restore_flag", "Restore the finding here", "Review", ("Shift+X",), twin="retake check"),
    Action("flag_settings", "Flag settings…", "Review", twin="retake check goes by the project's own"),
    Action("compare_take", "Compare with another take…", "Review", twin="retake review BEFORE AFTER"),
    Action(
        "offset_later",
        "Move the first take a frame later",
        "Review",
        ("Ctrl+Alt+Right",),
        twin="retake review --offset",
    ),
    Action(
        "offset_earlier",
        "Move the first take a frame earlier",
        "Review",
        ("Ctrl+Alt+Left",),
        twin="retake review --offset",
    ),
    Action("open_queue", "Open a folder of pairs…", "Review", ("Ctrl+Shift+O",), twin="retake review --queue"),
    Action("next_take", "Next take of the queue", "Review", ("Ctrl+PgDown",), twin="retake review --queue"),
    Action("previous_take", "Previous take of the queue", "Review", ("Ctrl+PgUp",), twin="retake review --queue"),
    Action("approve", "Approve", "Review", ("Ctrl+Shift+A",), twin="a verdict belongs to a project"),
    Action("send_back", "Needs work…", "Review", ("Ctrl+Shift+W",), twin="a verdict belongs to a project"),
    Action("write_report", "Write a report…", "Review", ("Ctrl+Shift+E",), twin="retake review -o REPORT.html"),
    Action("write_movie", "Write a movie side by side…", "Review", twin="retake render --before-edits --burn-in"),
    Action("write_findings", "Write flags and notes…", "Review", twin="retake review --findings --markers"),
    Action("expand_lane", "Show or hide the weights below", "View", ("W",)),
    Action("play", "Play or pause", "Playback", ("Space", "K"), "▶", True, twin="retake render -o OUT.mp4"),
    Action("play_backwards", "Play backwards", "Playback", ("J",)),
    Action("stop", "Stop", "Playback", ("Shift+K",)),
    Action("play_forwards", "Play forwards", "Playback", ("L",)),
    Action("play_slowly", "Play at ½, at ¼", "Playback", ("Shift+L",)),
    Action("play_backwards_slowly", "Play backwards at ½, at ¼", "Playback", ("Shift+J",)),
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
    Action("view_before", "Show the recorded face", "View", ("1",), checkable=True, twin="retake render"),
    Action("view_after", "Show the edited face", "View", ("2",), checkable=True, twin="retake render"),
    Action("view_wipe", "Show both with a wipe", "View", ("3",), checkable=True, twin="retake render --compare"),
    Action("wipe_left", "Move the wipe left", "View", ("Ctrl+[",)),
    Action("wipe_right", "Move the wipe right", "View", ("Ctrl+]",)),
    Action("view_split", "Show both side by side", "View", ("4",), checkable=True, twin="retake render --compare"),
    Action("view_difference", "Show the difference", "View", ("5",), checkable=True),
    Action("frame_head", "Look at the whole head from the front", "View"),
    Action("own_head", "Retake head", "View", twin="retake render without --character", submenu=OTHER_HEAD),
    Action("second_head", "Second head", "View", twin="retake render --character second", submenu=OTHER_HEAD),
    Action("load_character", "From a file…", "View", twin="retake render --character", submenu=OTHER_HEAD),
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
        "reply_note",
        "dismiss_flag",
        "compare_take",
        "open_queue",
        "approve",
        "write_report",
        "sound_later",
        "next_frame",
        "next_span",
        "set_in",
        "view_before",
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
    ("fill", "clean_tool", "live_tool", "retarget_tool", "review_tool"),
    ("play", "loop"),
)
MENUS: tuple[str, ...] = ("File", "Edit", "Tools", "Retarget", "Review", "Playback", "View", "Help")


# What a right click, or the menu key, offers on each kind of thing; an empty name is a line between two groups.
CONTEXT: dict[str, tuple[str, ...]] = {
    "face": (
        *(
            "view_after",
            "view_before",
            "view_wipe",
            "view_split",
            "view_difference",
            "",
            "frame_head",
            *("own_head", "second_head", "load_character"),
            "",
        ),
        *("pin_tool", "note", "draw_mark", "", "play"),
    ),
    "curve": (
        *("close_here", "copy", "paste", "smooth", "", "hit_exactly", "go_there", "again", ""),
        *("set_in", "set_out", "clear_selection", "", "fill", "note", "", "expand_lane", "frame_all"),
    ),
    "lane": ("expand_lane", "close_here", "", "hit_exactly", "go_there", "", "previous_lane", "next_lane"),
    "span": ("fill", "smooth", "unmark_span", "", "copy", "clear_selection", "", "note", "loop"),
    "flag": (
        "dismiss_flag",
        "restore_flag",
        "flag_settings",
        "",
        "previous_span",
        "next_span",
        "",
        "note",
        "pin_tool",
        "smooth",
        "mark_tool",
    ),
    "note": ("edit_note", "reply_note", "resolve_note", "delete_note", "", "next_note", "", "note"),
    "pin": ("pin_tool", "remove_pin", "", "note"),
    "label": ("label_frame", "unlabel_frame", "", "go_to_loosest", "suggest_labels", "", "save_labels", "read_labels"),
    "time": (
        "play",
        "loop",
        "",
        "set_in",
        "set_out",
        "clear_selection",
        "",
        "note",
        "",
        "zoom_in",
        "zoom_out",
        "frame_all",
    ),
    "audio": ("mute", "sound_earlier", "sound_later", "", "attach_audio", "detach_audio"),
}


# What the mouse does beyond the buttons, for the list of keys.
MOUSE: tuple[tuple[str, str], ...] = (
    ("Bend a curve", "drag it"),
    ("Wider or narrower brush", "wheel while dragging, or Alt+wheel"),
    ("Fine steps", "Shift while dragging"),
    ("Scroll the lanes", "wheel"),
    ("Zoom in time", "Ctrl+wheel; on the ruler: wheel"),
    ("Move along the take", "Shift+wheel, or drag with the middle button"),
    ("Go to a frame", "click or drag the ruler"),
    ("Select frames", "Shift+drag on the ruler"),
    ("Mark a span", "drag in the spans lane"),
    ("Move the sound", "drag the waveform"),
    ("Show the weights below", "click a curve's name"),
    ("Turn, move, zoom the face", "drag, right-drag, wheel"),
    ("Whole head from the front", "double-click the face"),
    ("Before and after", "drag the line on the face"),
    ("What can be done here", "right-click, or the menu key"),
)


def keys_of(entry: Action, preset: str) -> tuple[str, ...]:
    """Return an action's shortcuts under a preset."""
    return PRESETS.get(preset, {}).get(entry.name, entry.keys)


def all_keys(preset: str, own: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Return every action's shortcuts: the user's own, and of the preset's those that the user gave to no other action."""
    names = {entry.name for entry in ACTIONS}
    given = {key.lower() for name, keys in own.items() if name in names for key in keys}
    return {
        entry.name: own.get(entry.name, tuple(key for key in keys_of(entry, preset) if key.lower() not in given))
        for entry in ACTIONS
    }
