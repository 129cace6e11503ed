"""Exports of a review: a movie, flags and notes, with their progress and a button that cancels."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton

from app.review.reporting import Reporting
from app.session import Session
from app.widgets.progress import Progress
from app.widgets.section import Section


class HandingOnSection(Section):
    """Asks for what is written, and shows how far that is.

    Parameters
    ----------
    session : whose take is reviewed
    reporting : what writes
    """

    tools = frozenset({"review"})
    wanted = Signal(str)  # the name of an action

    def __init__(self, session: Session, reporting: Reporting) -> None:
        super().__init__(session, "Hand on")
        for title, action in (("Write a movie…", "write_movie"), ("Write flags and notes…", "write_findings")):
            button = QPushButton(title)
            button.clicked.connect(lambda _=False, name=action: self.wanted.emit(name))
            self.column.addWidget(button)
        self.progress = Progress("Stop writing", reporting.cancel)
        self.column.addWidget(self.progress)
        reporting.under_way.connect(self.progress.follow)
        reporting.progress.connect(self.progress.advance)
