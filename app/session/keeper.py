"""Keeping the work safe: each finished step goes to the project file, or to a file of unsaved work until there is one."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QTimer, Signal

from app.background import LatestWins
from app.session.changes import Change
from app.session.keeping import Kept, Look, Saving, as_unsaved_work
from app.session.left_over import LeftOver, new_path, unsaved_folder, unsaved_work
from app.session.opening import Opened
from app.session.session import Session
from engine import project
from engine.errors import EngineError
from engine.project import Contents, DisplacedError, Project

log = logging.getLogger(__name__)
PATIENCE_S = 0.3  # a wait that nobody notices when a take is closed
LOOK_MS = 3000  # between looks whether the project is still the one that was opened


class Keeper(QObject):
    """Commits each change of a session's undo stack and marks, and saves projects, on a thread of its own.

    Where a step cannot be written the work stays in memory, and the next step brings all that is missing. While a
    project is being copied, the steps made meanwhile go to the file that is copied, and with it to the copy. A project
    that somebody replaced or deleted is let go of as it is, and all of the work goes on as unsaved work.

    Parameters
    ----------
    session : what is kept
    folder : for unsaved work; the user's own without one
    """

    failed = Signal(str, str)  # sentence, advice
    mended = Signal(str)  # the sentence of a failure that is over
    kept = Signal(object)  # the Contents that are safe on disk
    saved = Signal(object)  # the path of a project that was just saved
    progress = Signal(float)  # the share of the save that is done, from the keeper's thread
    saving_changed = Signal()
    _displaced = Signal(object)  # a DisplacedError, from the keeper's thread

    def __init__(self, session: Session, folder: Path | None = None) -> None:
        super().__init__()
        self._session, self.folder = session, folder or unsaved_folder()
        self._kept: Kept | None = None
        self._newest = session.document.contents()  # what is to be written
        self._wished: Saving | None = None
        self._stopped = False
        self._waits: Contents | None = None  # steps that could not be kept while a copy was made
        self._afterwards: list[Callable[[], None]] = []
        self._told = ""
        self._lock = threading.Lock()
        self._work = LatestWins(self._write, name="keeper")
        self._work.done.connect(self._written)
        self._work.failed.connect(self._refused)
        self._work.rested.connect(self._go_on)
        session.document.undo.indexChanged.connect(self._keep)
        session.changed.connect(self._on_change)
        self._displaced.connect(self._on_displaced)
        self._looks = QTimer(self, interval=LOOK_MS)
        self._looks.timeout.connect(self._look)

    @property
    def path(self) -> Path | None:
        """The project that every step goes to; None while the work is unsaved."""
        kept = self._kept
        return kept.project.path if kept is not None and kept.saved else None

    @property
    def saving(self) -> Path | None:
        """The path that a project is being saved to."""
        return self._wished.path if self._wished else None

    @property
    def _project(self) -> Project | None:
        return self._kept.project if self._kept is not None else None

    def when_idle(self, then: Callable[[], None]) -> bool:
        """Do something when nothing is being written any more; returns whether nothing is.

        What waits is dropped where a save fails.
        """
        self._afterwards.append(then)
        if not self._work.finish(PATIENCE_S):
            return False
        QCoreApplication.sendPostedEvents(self, QEvent.Type.MetaCall.value)  # what came of it is heard of first
        self._go_on()
        return True

    # --- saving and opening

    def open(self, opened: Opened) -> None:
        """Show a project that was read, undo history included, and let each step go there from now on.

        One that cannot be written is shown all the same, as unsaved work; so is what an earlier start left.
        """
        left_over = opened.wish.left_over
        self._adopt(opened, None if left_over else opened.wish.path, saved=not left_over)
        if left_over:
            self._session.document.undo.resetClean()

    def release(self) -> None:
        """Close the project, so that it can be read again; what is open is in memory alone until `keep` or `open`."""
        self._detach(delete=False)

    def holds(self, path: Path) -> bool:
        """Whether a path is the project that is open: a file is open once, and what is in memory is in it."""
        return self.path is not None and path.exists() and path.samefile(self.path)

    def save_as(self, path: Path) -> None:
        """Make a project of the session at a path, whole or not at all; from then on each step goes there.

        Returns at once; `saved` or `failed` follows. Where it fails nothing is lost: neither what was at the path, nor
        the work.
        """
        self._newest, self._wished, self._stopped = self._session.document.contents(), Saving(path), False
        self._work.submit(self._wished, "save")
        self.saving_changed.emit()

    def stop_saving(self) -> None:
        """Give up the save under way; each step goes on being kept where it was before."""
        self._stopped = True

    def keep(self) -> None:
        """Write what is open even where nothing was edited: a recording exists nowhere else."""
        self._session.document.undo.resetClean()
        self._submit(self._session.document.contents())

    def forget(self) -> None:
        """Remove the unsaved work, after it was exported or discarded; a saved project stays as it is."""
        self._detach(delete=True)

    def close(self) -> None:
        """Finish writing and end the thread; unsaved work that was not forgotten is offered at the next start."""
        self._session.document.undo.indexChanged.disconnect(self._keep)
        self._session.changed.disconnect(self._on_change)
        self._detach(delete=False)
        self._work.stop()

    # --- what an earlier start left

    def left_over(self) -> list[LeftOver]:
        """Return the unsaved work of programs that run no more, newest first."""
        return unsaved_work(self.folder)

    def discard(self, left: LeftOver) -> None:
        """Remove unsaved work for good; raises `EngineError` when another program has taken it."""
        project.delete(left.path)

    # --- within

    def _keep(self, _: int = 0) -> None:
        if self._session.document.opening:
            return  # what opening does to the stack is no work of the user's
        contents = self._session.document.contents()
        if self._project or contents.edits:
            self._submit(contents)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self._detach(delete=False)
        elif change & Change.MARKS:
            contents = self._session.document.contents()
            if self._project or contents.edits:  # what a take brings with it is no work of the user's
                self._submit(contents)

    def _submit(self, contents: Contents) -> None:
        self._newest = contents
        self._work.submit(contents)

    def _look(self) -> None:
        if self._kept is not None and self._work.idle:
            self._work.submit(Look(), "look")

    def _write(self, wanted: Contents | Saving | Look) -> Project | None:
        """Bring the file to these contents, or save it elsewhere; runs on the keeper's thread."""
        with self._lock:
            if isinstance(wanted, Saving):
                return self._save(wanted.path)
            contents = self._newest if isinstance(wanted, Look) else wanted
            if self._kept is None:
                return None if isinstance(wanted, Look) else self._keep_unsaved(contents)
            with nullcontext() if self._kept.saved else as_unsaved_work(self._kept.project.path):
                try:
                    if isinstance(wanted, Look):
                        self._kept.project.check()
                    elif contents is not self._kept.project.contents:  # a save may have brought them already
                        self._kept.project.put(contents)
                except DisplacedError as error:
                    self._go_on_unsaved(contents, error)
            return self._kept.project

    def _keep_unsaved(self, contents: Contents) -> Project:
        """Keep the work in a new file of unsaved work; the file before is closed as it is."""
        before, path = self._kept, new_path(self.folder)
        with as_unsaved_work(path):
            created = project.create(path, contents)
        self._kept = Kept(created, saved=False)
        if before is not None:
            before.project.close()
        return created

    def _go_on_unsaved(self, contents: Contents, error: DisplacedError) -> None:
        """Keep all of the work elsewhere: the file that it went to is no more its own."""
        kept = self._project
        same = kept is not None and contents.original is kept.contents.original
        self._keep_unsaved(contents if same or kept is None else kept.contents)
        self._displaced.emit(error)

    def _on_displaced(self, error: DisplacedError) -> None:
        self._session.document.undo.resetClean()
        if self._wished is None:  # else the save tells it
            self.failed.emit(error.sentence, error.advice)

    def _written(self, wanted: Contents | Saving | Look, result: Project | None) -> None:
        if isinstance(wanted, Look):
            return
        if self._told:
            self.mended.emit(self._told)
            self._told = ""
        if isinstance(wanted, Saving) and result is not None:
            self._arrived(wanted, result)
        elif isinstance(wanted, Contents):
            self._show_clean(wanted)
            self.kept.emit(wanted)

    def _arrived(self, wanted: Saving, result: Project) -> None:
        if wanted is self._wished:
            self._end_saving()
        if result is self._project:  # else another take was opened meanwhile
            self._session.document.path = result.path
            self._looks.start()
            self._show_clean(result.contents)
            self.saved.emit(result.path)

    def _show_clean(self, safe: Contents) -> None:
        now = self._session.document.contents()
        latest = (now.edits, now.position, now.marks) == (safe.edits, safe.position, safe.marks)
        if self.path and latest and now.original is safe.original:
            self._session.document.undo.setClean()

    def _refused(self, wanted: Contents | Saving | Look, sentence: str, advice: str) -> None:
        asked_for = isinstance(wanted, Saving)
        if asked_for:
            self._afterwards.clear()
        if wanted is self._wished:
            self._end_saving()
        if asked_for or sentence != self._told:  # once is enough, until it works again
            self._told = sentence
            self.failed.emit(sentence, advice)

    def _end_saving(self) -> None:
        self._wished = None
        self.saving_changed.emit()

    def _go_on(self) -> None:
        if self._work.idle:
            waiting, self._afterwards = self._afterwards, []
            for then in waiting:
                then()

    def _adopt(self, opened: Opened, path: Path | None, *, saved: bool) -> None:
        assert opened.project is not None and opened.state is not None
        self._detach(delete=False)
        self._session.restore(opened.project.contents, path, opened.steps, opened.state, opened.measured)
        if not opened.project.read_only:
            self._kept = Kept(opened.project, saved)
            self._secure(self._kept)
            self._looks.start()

    def _detach(self, *, delete: bool) -> None:
        """Go on without a file; unsaved work is removed if it is to be deleted, a project of the user's never is."""
        self._looks.stop()
        self._work.finish()
        with self._lock:
            before, self._kept = self._kept, None
        if before is not None:
            self._close_project(before.project, delete=delete and not before.saved)
        self._told = ""

    def _close_project(self, old: Project, *, delete: bool) -> None:
        old.close()
        if delete:
            try:
                project.delete(old.path)
            except (EngineError, OSError):
                log.exception("%s was not removed", old.path)

    def _save(self, path: Path) -> Project:
        saved, before = self._copy(path), self._kept  # in this order: the copy may let go of what was kept in
        self._kept = Kept(saved, saved=True)
        self._secure(self._kept)
        if before is not None and before.project is not saved:
            self._close_project(before.project, delete=not before.saved)
        return saved

    def _secure(self, kept: Kept) -> None:
        """Record where a saved project is, so that it is found even if its file is replaced just before a kill."""
        if kept.saved:
            kept.project.keep_spare(self.folder)

    def _copy(self, path: Path) -> Project:
        contents, old = self._newest, self._project
        if old is not None and contents.original is old.contents.original:
            try:
                old.put(contents)
            except DisplacedError as error:
                stays = path.exists() and path.resolve() == old.path.resolve()  # whose it is was not known when asked
                self._go_on_unsaved(contents, error)
                if stays:
                    raise
            except EngineError as error:
                if path.exists() and path.samefile(old.path):
                    raise
                log.warning("all of the work is saved anew: %s", error)
            else:
                return old.save_as(path, self._report_and_keep)
        return project.create(path, contents, self._report)

    def _report(self, share: float) -> None:
        """Emit the progress of a save; on the keeper's thread."""
        if self._stopped:
            raise EngineError("The project was not saved.", "Your work is kept as it was before.")
        self.progress.emit(share)

    def _report_and_keep(self, share: float) -> None:
        """Put the steps made meanwhile in the file that is being copied, and so in the copy."""
        self._report(share)
        old, newest = self._project, self._newest
        if old is None or newest in (old.contents, self._waits) or newest.original is not old.contents.original:
            return
        try:
            old.put(newest)
        except EngineError as error:
            self._waits = newest  # once is enough: each attempt lets the copy begin anew
            log.warning("a step waits for the save to end: %s", error)
