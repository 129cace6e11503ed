"""The actions of reviewing, and the questions they ask."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.review.comparing import Comparing, Pair
from app.review.reporting import Reporting
from app.review.section import ReviewSection
from app.session import Change, Session
from app.session.commands import EditCommand
from app.widgets.saving import ask_where, beside
from engine.project import ENDING
from engine.review.changes import Change as Difference
from engine.take import Take

APPROVED, NEEDS_WORK = 1, 2  # places in VERDICTS


class ReviewActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session : whose take is reviewed
    window : the parent of the dialogs
    """

    told = Signal(str)
    failed = Signal(str, str)  # sentence, advice

    def __init__(self, session: Session, window: QWidget) -> None:
        super().__init__()
        self._session, self._window = session, window
        self.section = ReviewSection(session)
        self.comparing = Comparing(session)
        self.comparing.changed.connect(self._show)
        self.comparing.paired.connect(self._open_pair)
        self.reporting = Reporting()
        self.reporting.written.connect(lambda path: self.told.emit(f"The report is in {path.name}."))
        for part in (self.comparing, self.reporting):
            part.failed.connect(self.failed)
        self.section.wanted.connect(lambda name: getattr(self, name)())
        # Opens a take in place of what is open, once that is safe; the window says how.
        self.open_take: Callable[[Take, Callable[[], None]], None] = lambda _take, _then: None
        session.changed.connect(self._on_change)

    def close(self) -> None:
        """End the threads."""
        self.comparing.close()
        self.reporting.close()

    def review_tool(self) -> None:
        """Show what was changed."""
        self._session.view.choose_tool("review")

    def next_change(self) -> None:
        """Go to the next change."""
        self.section.step(1)

    def previous_change(self) -> None:
        """Go to the change before."""
        self.section.step(-1)

    def approve(self) -> None:
        """Give the verdict that the take is good."""
        self.section.judge(APPROVED)

    def send_back(self) -> None:
        """Give the verdict that the take needs work."""
        self.section.judge(NEEDS_WORK)

    def compare_take(self) -> None:
        """Choose another version of the open take, and see where the two differ."""
        name, _ = QFileDialog.getOpenFileName(
            self._window, "Compare with another take", "", f"Takes and projects (*.csv *{ENDING})"
        )
        if name:
            self.comparing.read(Path(name))

    def write_report(self) -> None:
        """Choose a file and write what was changed as a page to read anywhere."""
        suggested = beside(self._session.document.path, f"{Path(self._session.document.name).stem}_review.html")
        path, _ = ask_where(self._window, "Write a report", suggested, {"Report (*.html)": ".html"})
        if path is not None:
            self.told.emit("Writing the report…")
            self.reporting.write(self._session.document.contents(), self._session.document.name, path)

    def _show(self, changes: tuple[Difference, ...]) -> None:
        self.section.show_changes(changes)
        if self._session.view.tool == "review":
            self._session.document.set_differences(tuple((change.start, change.stop) for change in changes))

    def _on_change(self, change: Change) -> None:
        if change & Change.TOOL:
            watched = self._session.view.tool == "review"
            self.comparing.watch(watched)
            if not watched:
                self._session.document.set_differences(None)

    def _open_pair(self, open_then: Take, found: Pair) -> None:
        """Make the other version one step after the open take, so that undo and hold-to-compare tell the two apart."""
        if open_then is not self._session.document.take:
            return  # it was edited or closed while the other one was read

        def step() -> None:
            self._session.document.undo.push(
                EditCommand.of(self._session.document, found.patch, f"as in {found.name}", kind="compare", inputs={})
            )
            self.told.emit(f"{found.name} is {found.alignment.sentence}.")
            if not found.alignment.alike:
                self.failed.emit(
                    f"{found.before.name} and {found.name} do not look like one performance.",
                    "They are shown side by side all the same.",
                )
            self.review_tool()

        if found.same_clock:
            step()
        else:
            self.open_take(found.before, step)
