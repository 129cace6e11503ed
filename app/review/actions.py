"""The actions of reviewing, and the questions they ask."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.playback.transport import Transport
from app.review.comparing import Comparing
from app.review.handing_on import HandingOnSection
from app.review.queue_section import QueueSection
from app.review.queueing import Queueing
from app.review.reporting import Arguments, Reporting, findings, movie, report
from app.review.section import ReviewSection
from app.review.verdict import APPROVED, VerdictSection
from app.session import Change, Session
from app.session.commands import AlignCommand, EditCommand
from app.widgets.saving import ask_where, beside
from engine.project import ENDING, Edit
from engine.review.changes import Change as Difference
from engine.review.pairing import COMPARE, Pair
from engine.take import Take
from engine.words import counted


class ReviewActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session : whose take is reviewed
    transport : plays the change that is looped
    window : the parent of the dialogs
    """

    message = Signal(str)
    failed = Signal(str, str)  # sentence, advice
    looped = Signal(bool)  # whether a change is played round and round

    def __init__(self, session: Session, transport: Transport, window: QWidget) -> None:
        super().__init__()
        self._session, self._transport, self._window = session, transport, window
        self._looping: tuple[int, int] | None = None
        self.comparing, self.queueing, self.reporting = Comparing(session), Queueing(session), Reporting()
        self.section, self.verdict = ReviewSection(session), VerdictSection(session)
        self.queue = QueueSection(session, self.queueing)
        self.comparing.changed.connect(self._show)
        self.comparing.paired.connect(self._open_pair)
        self.comparing.aligned.connect(self._align)
        for moved in (self.comparing.failed, self.comparing.stepped):
            moved.connect(self._show_alignment)
        self.handing_on = HandingOnSection(session, self.reporting)
        self.reporting.written.connect(self._tell_written)
        for part in (self.comparing, self.queueing, self.reporting):
            part.failed.connect(self.failed)
        for section in (self.section, self.verdict, self.queue, self.handing_on):
            section.wanted.connect(self._carry_out)
        self.section.moved.connect(self.comparing.shift)
        # What opens a take or a project in place of what is open, once that is safe; the window says how.
        self.open_take: Callable[[Take, Callable[[], None]], None] = lambda _take, _then: None
        self.load: Callable[[Path], None] = lambda _path: None
        self.queueing.ready.connect(self._load_review)
        transport.changed.connect(self._on_transport)
        session.changed.connect(self._on_change)

    def close(self) -> None:
        """End the threads."""
        self.comparing.close()
        self.queueing.close()
        self.reporting.close()

    def _tell_written(self, path: Path) -> None:
        self.message.emit(f"{path.name} is written.")

    def _carry_out(self, name: str) -> None:
        getattr(self, name)()

    # --- actions

    def review_tool(self) -> None:
        """Show what was changed."""
        self._session.view.choose_tool("review")

    def next_change(self) -> None:
        """Go to the next change."""
        self.section.step(1)

    def previous_change(self) -> None:
        """Go to the change before."""
        self.section.step(-1)

    def loop_change(self) -> None:
        """Play the change at the playhead round and round, or no longer."""
        if self._looping is not None:
            self._end_loop()
            self._transport.run(0.0)
            return
        change = self.section.here
        if change is None:
            self.failed.emit("There is no change to play.", "Choose Review after an edit, or compare two takes.")
            self.looped.emit(False)
            return
        self._looping = change.start, change.stop
        self._session.view.select(self._looping)
        if not change.start <= self._session.view.playhead < change.stop:
            self._session.view.move_playhead(change.start)
        self._transport.set_loop(True)
        self._transport.run(self._transport.speed if self._transport.speed > 0 else 1.0)
        self.looped.emit(True)

    def approve(self) -> None:
        """Give the verdict that the take is good."""
        self.verdict.judge(APPROVED)

    def send_back(self) -> None:
        """Give the verdict that the take needs work, with a sentence."""
        self.review_tool()  # else there would be nowhere to type it
        self.verdict.ask()

    def offset_later(self) -> None:
        """Let the take before be a frame later."""
        self._shift_by(1)

    def offset_earlier(self) -> None:
        """Let the take before be a frame earlier."""
        self._shift_by(-1)

    def open_queue(self) -> None:
        """Choose a folder of pairs to review one after another."""
        name = QFileDialog.getExistingDirectory(self._window, "Open a folder of pairs")
        if name:
            self.review_tool()
            self.queueing.open(Path(name))

    def next_take(self) -> None:
        """Open the next pair of the queue."""
        self.queueing.step(1)

    def previous_take(self) -> None:
        """Open the pair before in the queue."""
        self.queueing.step(-1)

    def compare_take(self) -> None:
        """Choose another version of the open take, and see where the two differ."""
        name, _ = QFileDialog.getOpenFileName(
            self._window, "Compare with another take", "", f"Takes and projects (*.csv *{ENDING})"
        )
        if name:
            self.comparing.read(Path(name))

    def write_report(self) -> None:
        """Choose a file and write what was changed as a page to read anywhere."""
        self._write("Write a report", "review.html", {"Report (*.html)": ".html"}, report)

    def write_movie(self) -> None:
        """Choose a file and write the take before and after its edits, side by side, with sound, timecode and notes."""
        document = self._session.document
        audio = document.audio
        sound = None if audio is None or audio.path is None else (audio.path, document.offset_s("audio"))
        self._write("Write a movie", "review.mp4", {"Movie (*.mp4)": ".mp4"}, movie(sound))

    def write_findings(self) -> None:
        """Choose a file and write flags and notes as a table, as JSON, or as markers for editors."""
        kinds = {"Table (*.csv)": ".csv", "JSON (*.json)": ".json", "Markers for editors (*.edl)": ".edl"}
        self._write("Write flags and notes", "notes.csv", kinds, findings)

    def _write(self, title: str, ending: str, kinds: dict[str, str], arguments: Arguments) -> None:
        document = self._session.document
        suggested = beside(document.path, f"{Path(document.name).stem}_{ending}")
        path, _ = ask_where(self._window, title, suggested, kinds)
        if path is not None:
            self.message.emit(f"Writing {path.name}…")
            self.reporting.write(document.contents(), document.name, path, arguments)

    # --- within

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
        if change & (Change.TAKE | Change.READING):
            self._show_alignment()
        moved = bool(change & (Change.TAKE | Change.SELECTION)) and self._session.view.selection != self._looping
        if self._looping is not None and moved:
            self._end_loop()

    def _on_transport(self) -> None:
        if self._looping is not None and not self._transport.playing:
            self._end_loop()

    def _show_alignment(self, *_: str) -> None:
        self.section.show_pair(self.comparing.alignment_inputs)

    def _end_loop(self) -> None:
        self._looping = None
        self._transport.set_loop(False)
        self.looped.emit(False)

    def _shift_by(self, frames: int) -> None:
        inputs = self.comparing.alignment_inputs
        if inputs is None:
            self.failed.emit("There is no second take to move.", "Compare with another take first.")
        else:
            self.comparing.shift(float(inputs["offset_s"]) + frames / self._session.document.take.fps)

    def _align(self, edit: Edit) -> None:
        self._session.document.undo.push(AlignCommand.of(self._session.document, edit))

    def _load_review(self, path: Path) -> None:
        self.review_tool()
        self.load(path)

    def _open_pair(self, open_then: Take, found: Pair) -> None:
        """Make the other version one step after the open take, so that undo and hold-to-compare show the two."""
        if open_then is not self._session.document.take:
            return  # it was edited or closed while the other one was read
        name = found.after.name

        def step() -> None:
            self.comparing.remember(found.raw)
            self._session.document.undo.push(
                EditCommand.of(self._session.document, found.patch, f"as in {name}", kind=COMPARE, inputs=found.inputs)
            )
            apart = f" {counted(found.apart, 'frame')} of it have no counterpart." if found.apart else ""
            self.message.emit(f"{name} is {found.alignment.sentence}.{apart}")
            if not found.alignment.alike:
                self.failed.emit(
                    f"{found.before.name} and {name} do not look like one performance.",
                    "They are shown side by side all the same.",
                )
            self.review_tool()

        if found.same_clock:
            step()
        else:
            self.open_take(found.before, step)
