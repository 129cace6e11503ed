"""The `.retake` file: a performance, all that was done to it, and what people noted beside it, in one SQLite database."""

from engine.project.media import Found, attach, find, name_of, placed
from engine.project.records import (
    MARK,
    VISEMES,
    Contents,
    Edit,
    Marks,
    Media,
    Note,
    Pin,
    Span,
    Summary,
    mark_edit,
    marks_of,
)
from engine.project.replaying import Before, Replayed, replay
from engine.project.store import ENDING, InUseError, Project, create, delete, peek
from engine.project.visemes import VisemeChange, change_between, viseme_edit

__all__ = [
    "ENDING",
    "MARK",
    "VISEMES",
    "Before",
    "Contents",
    "Edit",
    "Found",
    "InUseError",
    "Marks",
    "Media",
    "Note",
    "Pin",
    "Project",
    "Replayed",
    "Span",
    "Summary",
    "VisemeChange",
    "attach",
    "change_between",
    "create",
    "delete",
    "find",
    "mark_edit",
    "marks_of",
    "name_of",
    "peek",
    "placed",
    "replay",
    "viseme_edit",
]
