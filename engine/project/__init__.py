"""The `.retake` file: a performance, all that was done to it, and what people noted beside it, in one SQLite database."""

from engine.project.media import Found, attach, find, name_of, placed
from engine.project.records import (
    MARK,
    READING,
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
    read_as_of,
    reading_edit,
)
from engine.project.replaying import Before, Replayed, replay
from engine.project.store import ENDING, InUseError, Project, create, delete, peek
from engine.project.visemes import VisemeChange, change_between, viseme_edit

__all__ = [
    "ENDING",
    "MARK",
    "READING",
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
    "read_as_of",
    "reading_edit",
    "replay",
    "viseme_edit",
]
