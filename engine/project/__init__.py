"""The `.retake` file: a performance, all that was done to it, and what people noted beside it, in one SQLite database."""

from engine.project.media import Found, attach, find, name_of, placed
from engine.project.records import (
    MARK,
    Contents,
    Edit,
    Marks,
    Media,
    Note,
    Pin,
    Replayed,
    Span,
    Summary,
    mark_edit,
    marks_of,
    replay,
)
from engine.project.store import ENDING, InUseError, Project, create, delete, peek

__all__ = [
    "ENDING",
    "MARK",
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
    "attach",
    "create",
    "delete",
    "find",
    "mark_edit",
    "marks_of",
    "name_of",
    "peek",
    "placed",
    "replay",
]
