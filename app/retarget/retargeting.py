"""Retargets the take or a capture to another head: live around the playhead, and whole on request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.retarget.choosing import Choosing
from app.retarget.commands import TargetCommand
from app.retarget.live import LiveFrames
from app.retarget.solving import KIND, LABELS, MOVEMENT, carry_out, whole
from app.retarget.target import Errand, Target, posed
from app.session import Change, Session
from app.session.asked import Asked
from app.session.edits import Runner
from app.session.heads import KeptHeads
from engine.character import bundled
from engine.editing import MARKERS, Matching, Performance, Retargeted
from engine.take import SHAPES, Array

if TYPE_CHECKING:
    from engine.editing import Patch, Source


class Retargeting(QObject):
    """Holds source, target and method, and keeps the result as one undo step.

    Parameters
    ----------
    session : whose take is retargeted, and replaced by the result

    Attributes
    ----------
    target : the head, its markers and labels
    capture : markers that are retargeted in place of the take's weights
    method : MOVEMENT or LABELS
    matching : how movement is matched
    result : the whole take on the target, until it is kept or discarded
    share : how far the solve is, 0..1; None while nothing is solved
    choosing : reads sources and targets
    suggestions : frames that are worth a label, best first
    draft_pose : weights of the target that were moved at the playhead
    """

    changed = Signal()
    drawn = Signal()  # other weights, all else alike
    progress = Signal(float)
    failed = Signal(str, str)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.target, self.capture = Target(), None
        self.method, self.matching = MOVEMENT, Matching()
        self.result: Retargeted | None = None
        self.solved: Asked | None = None
        self.share: float | None = None
        self.draft_pose: dict[str, float] = {}
        self.suggestions: list[int] = []
        self._performance: Performance | None = None
        self._solver = Runner(session, carry_out, name="retarget")
        self._solver.arrived.connect(self._finish)
        self._solver.progress.connect(self._advance)
        self._solver.failed.connect(self._solve_refused)
        self._nearby = Runner(session, carry_out, name="retarget live")
        self._nearby.failed.connect(self.failed)
        self._whole, self._short = (LatestWins(_run, name=name) for name in ("heads", "shown heads"))
        for thread in (self._whole, self._short):
            thread.done.connect(self._deliver)
        self._whole.failed.connect(self._refused)
        self._short.failed.connect(self._short_refused)
        self.choosing = Choosing(session, self)
        self._live = LiveFrames(self._nearby, self._to_be_seen, self.drawn.emit)
        self._kept_heads = KeptHeads(session, self.submit, self._follow)
        session.changed.connect(self._on_change)
        session.document.undo.indexChanged.connect(self._follow)

    # --- what there is

    capture: Source | None

    @property
    def performance(self) -> Performance:
        """The performance that is retargeted."""
        if self._performance is None:
            session = self._session
            self._performance = Performance(
                session.document.take, session.document.character or bundled(), self.capture
            )
        return self._performance

    @property
    def ready(self) -> bool:
        """Whether there is a source and another head to retarget it to."""
        head = self.target.head
        return head is not None and (self.capture is not None or head is not self.performance.head)

    @property
    def names(self) -> tuple[str, ...]:
        """The source's markers."""
        return self.capture.names if self.capture is not None else MARKERS

    @property
    def idle(self) -> bool:
        """Whether nothing is being worked out."""
        return all(each.idle for each in (self._solver, self._nearby, self._whole, self._short))

    def face_at(self, frame: int) -> Array | None:
        """Return the weights of the target at a frame, (52,), as far as they are known."""
        if not self.ready:
            return None
        label = self.label_at(frame)
        base = None if self.result is None else self.result.weights_at(frame)
        if base is None and self.method == LABELS and self.capture is None:
            base = np.asarray(self._session.document.take.weights[frame])
        if base is None:
            base = self._live.face_at(frame)
        if base is None:
            base = np.zeros(len(SHAPES))
        return posed(base, label) if self.method == LABELS else base

    def label_at(self, frame: int) -> dict[str, float]:
        """Return the label of a frame with what is being posed there, weights by shape name."""
        posing = self.draft_pose if frame == self._session.view.playhead else {}
        return {**self.target.labels.get(frame, {}), **posing}

    # --- source and target

    def submit(self, work: Callable[[], Any], then: Callable[[Any], None]) -> None:
        """Have work done off the GUI thread; `then` gets what it returns, and errors go to `failed`."""
        self._whole.submit(Errand(work, then))

    def submit_short(self, work: Callable[[], Any], then: Callable[[Any], None], channel: str = "") -> None:
        """Have work that takes a moment done beside what takes long; the newest of a channel wins."""
        self._short.submit(Errand(work, then), channel)

    def change_target(self, target: Target, title: str) -> None:
        """Put another target in place, or another state of it, as one undo step."""
        undo = self._session.document.undo
        clean = undo.isClean()
        undo.push(TargetCommand(self.put, self.target, target, title))
        if clean:
            undo.setClean()  # nothing of the take has changed

    def put(self, target: Target) -> None:
        """Put another target in place; for steps, and where the user chose none."""
        self.target = target
        self.choosing.chosen()
        self._begin_anew()

    def propose(self, frames: list[int]) -> None:
        """Show frames that are worth a label."""
        self.suggestions = frames
        self.changed.emit()

    # --- solving

    def use(self, *, method: str | None = None, matching: Matching | None = None) -> None:
        """Retarget by another method, or with other settings."""
        self.method, self.matching = method or self.method, matching or self.matching
        self._begin_anew()

    def ask_live(self) -> None:
        """Retarget the frames around the playhead that are not known yet."""
        view = self._session.view
        if not self.ready or self.result is not None or view.tool != "retarget":
            return
        if self.method != LABELS or self.capture is not None:
            self._live.ask(self.performance, self.target, self.matching, playhead=view.playhead)

    def _to_be_seen(self, asked: Asked) -> bool:
        return asked.of is self._performance and getattr(asked.inputs, "head", None) is self.target.head

    def solve(self) -> None:
        """Solve the whole take."""
        if not self.ready:
            self.failed.emit("There is no other head to retarget to.", "Choose a head in the Retarget panel.")
            return
        if self.method == LABELS and not self.target.labels:
            self.failed.emit("No frame is labelled yet.", "Suggest frames, pose the head at each, and label it.")
            return
        self.cancel()
        self.share = 0.0
        self._solver.ask(whole(self.performance, self.target, self.matching, self.method))
        self.changed.emit()

    def _finish(self, asked: Asked, found: Retargeted) -> None:
        if self._solver.is_last(asked):
            self._solver.drop()
            self.share, self.result, self.solved = None, found, asked
            self.changed.emit()

    def _advance(self, share: float) -> None:
        if self._solver.last is not None:
            self.share = share
            self.progress.emit(share)

    def cancel(self) -> bool:
        """Cancel the solve; returns whether there was one."""
        if self._solver.last is None:
            return False
        self._solver.drop()
        self.share = None
        self.changed.emit()
        return True

    def keep(self) -> None:
        """Replace the take by the result, on its head, as one undo step."""
        result, head, take = self.result, self.target.head, self._session.document.take
        if result is None or head is None:
            return
        asked = self.solved or whole(self.performance, self.target, self.matching, self.method)

        def then(patch: Patch) -> None:
            if self._session.document.take is take:
                self._kept_heads.know(asked.stored, None if head is bundled() else head)
                self._solver.keep(asked, patch)

        self.submit(lambda: result.patch(take), then)

    def show(self, result: Retargeted | None, solved: Asked | None = None) -> None:
        """Show an earlier result, or none."""
        self.result, self.solved = result, solved
        self.changed.emit()

    def drop(self) -> None:
        """Discard the result."""
        self.result = self.solved = None
        self._live.ask_anew()
        self.ask_live()
        self.changed.emit()

    def close(self) -> None:
        """Cancel the solve and end the threads."""
        # clearing itself at its end, it would still tell us
        self._session.document.undo.indexChanged.disconnect(self._follow)
        for part in (self._solver, self._nearby):
            part.close()
        for thread in (self._whole, self._short):
            thread.stop()

    # --- within

    def _begin_anew(self) -> None:
        """Forget what another source, target or setting came to."""
        self.cancel()
        self.result, self.solved, self.draft_pose = None, None, {}
        self.ask_live()
        self.changed.emit()

    def _follow(self, *_: int) -> None:
        """Put the take on the head of the last retarget in effect: undone, redone or opened with a project."""
        session = self._session
        if session.document.opening:
            return  # it says so when it is open
        contents = session.document.contents()
        kept = [edit for edit in contents.edits[: contents.position] if edit.kind == KIND]
        self._kept_heads.follow(kept[-1].inputs if kept else {})

    def _deliver(self, errand: Errand, result: Any) -> None:
        errand.then(result)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self.choosing.give_up()
        self.failed.emit(sentence, advice)
        self.changed.emit()

    def _solve_refused(self, sentence: str, advice: str) -> None:
        self.share = None
        self.failed.emit(sentence, advice)
        self.changed.emit()

    def _short_refused(self, request: object, sentence: str, advice: str) -> None:
        self.choosing.message.emit("")
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            if self.capture is not None and self._session.document.take is not self.capture.take:
                self.capture = None
                self.choosing.forget_capture()
            self.target, self.suggestions = replace(self.target, labels={}), []
            self._follow()
        if change & (Change.TAKE | Change.CURVES | Change.CHARACTER):
            self._performance = None
            self._live.forget()
            self._begin_anew()
        elif change & Change.PLAYHEAD:
            self.draft_pose = {}
            self.ask_live()
            self.drawn.emit()
        elif change & Change.TOOL:
            self.ask_live()
            self.changed.emit()


def _run(errand: Errand) -> Any:
    return errand.work()
