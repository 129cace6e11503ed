"""Retargeting under way: what is carried to which head, live around the playhead and whole on request."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.background import LatestWins
from app.retarget.carry import (
    Carried,
    Carrier,
    Carry,
    Performance,
    Stopped,
    Target,
    opened,
    points_of,
    posed,
    with_place,
)
from app.retarget.commands import KeepCommand, TargetCommand
from app.session import Change, Session
from engine.character import bundled
from engine.formats import labels as label_files
from engine.formats import markers, markers_layout
from engine.spacetime.layout import MARKERS
from engine.spacetime.retarget import Matching
from engine.spacetime.source import Source, from_markers
from engine.take import SHAPES, Array

if TYPE_CHECKING:
    from engine.editing import Patch

LIVE_FRAMES = 12  # on either side of the playhead
AHEAD_FRAMES = 6  # how near the end of what is known the playhead may come before more is asked for
MOVEMENT, LABELS = "movement", "labels"


@dataclass(frozen=True, eq=False)
class Errand:
    """Work for a background thread, and who gets what it returns."""

    work: Callable[[], Any]
    then: Callable[[Any], None]


class Retargeting(QObject):
    """Knows source, target and method; keeps what came of it as one undo step.

    Parameters
    ----------
    session : whose take is carried, and becomes what was carried

    Attributes
    ----------
    target : the head, its markers and labels
    capture : markers that are carried in place of the take's weights
    method : MOVEMENT or LABELS
    matching : how movement is matched
    result : the whole take as the target plays it, until it is kept or dropped
    share : how far the solve is, 0..1; None while nothing is solved
    opening : the name of the file that is being opened, or nothing
    chosen : the marker that the next click on the target places
    suggestions : frames that are worth a label, best first
    draft_pose : weights of the target that were moved at the playhead
    """

    changed = Signal()
    drawn = Signal()  # other weights, all else alike
    progress = Signal(float)
    failed = Signal(str, str)
    capture_opened = Signal(object)  # a Take of the capture's length

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.target, self.capture = Target(), None
        self.method, self.matching = MOVEMENT, Matching()
        self.result: Carried | None = None
        self.live: Carried | None = None
        self.share: float | None = None
        self.opening, self.chosen = "", ""
        self.draft_pose: dict[str, float] = {}
        self.suggestions: list[int] = []
        self._capture_path: Path | None = None
        self._performance: Performance | None = None
        self._solving: Carry | None = None
        self._live_for: tuple[object, ...] = ()
        self._live_span = (0, 0)
        self._carrier, self._live_carrier = Carrier(), Carrier()
        self._whole, self._short = (LatestWins(_run, name=name) for name in ("retarget", "retarget live"))
        for thread in (self._whole, self._short):
            thread.done.connect(self._deliver)
            thread.failed.connect(self._refused)
        self.progress.connect(self._advance)
        session.changed.connect(self._on_change)

    # --- what there is

    capture: Source | None

    @property
    def performance(self) -> Performance:
        """What is carried."""
        if self._performance is None:
            session = self._session
            self._performance = Performance(session.take, session.character or bundled(), self.capture)
        return self._performance

    @property
    def ready(self) -> bool:
        """Whether there is a source and another head to carry it to."""
        head = self.target.head
        return head is not None and (self.capture is not None or head is not self.performance.head)

    @property
    def names(self) -> tuple[str, ...]:
        """The source's markers."""
        return self.capture.names if self.capture is not None else MARKERS

    @property
    def idle(self) -> bool:
        """Whether nothing is being worked out."""
        return self._whole.idle and self._short.idle

    def face_at(self, frame: int) -> Array | None:
        """Return the weights of the target at a frame, (52,), as far as they are known."""
        if not self.ready:
            return None
        label = self.label_at(frame)
        base = None if self.result is None else self.result.weights_at(frame)
        if base is None and self.method == LABELS and self.capture is None:
            base = np.asarray(self._session.take.weights[frame])
        if base is None and self.live is not None:
            nearest = int(np.clip(frame, self.live.start, self.live.start + len(self.live.take) - 1))
            base = self.live.weights_at(nearest)
        if base is None:
            base = np.zeros(len(SHAPES))
        return posed(base, label) if self.method == LABELS else base

    def label_at(self, frame: int) -> dict[str, float]:
        """Return the label of a frame with what is being posed there, weights by shape name."""
        posing = self.draft_pose if frame == self._session.playhead else {}
        return {**self.target.labels.get(frame, {}), **posing}

    @property
    def loosest(self) -> int | None:
        """The frame that the labels hold most loosely: the one to label next."""
        if self.result is None or self.result.uncertainty is None:
            return None
        return int(np.argmax(self.result.uncertainty))

    # --- source and target

    def open_markers(self, path: Path, neutral_frame: int = 0) -> None:
        """Read a capture and carry it in place of the take."""

        def work() -> Source:
            return from_markers(markers.read(path), neutral_frame=neutral_frame)

        self._open(path.name, work, lambda capture: self._take_capture(capture, path))

    def measure_from(self, frame: int) -> None:
        """Take another frame of the capture for the face at rest."""
        if self._capture_path is not None:
            self.open_markers(self._capture_path, frame)

    def choose_target(self, path: Path | None) -> None:
        """Carry to the head in a file or folder; None is the bundled one."""
        name = path.name if path else bundled().name
        self._open(name, lambda: opened(path), lambda target: self.change_target(target, f"carry to {name}"))

    def _open(self, name: str, work: Callable[[], Any], then: Callable[[Any], None]) -> None:
        self.cancel()
        self.opening = name
        self._whole.submit(Errand(work, then))
        self.changed.emit()

    def _take_capture(self, capture: Source, path: Path) -> None:
        self.opening = ""
        before = self.capture, self._capture_path
        self.capture, self._capture_path = capture, path
        self.capture_opened.emit(capture.take)
        if self._session.take is not capture.take:  # edits would have been lost, and the user would rather not
            self.capture, self._capture_path = before
        elif self.target.head is None:
            self.choose_target(None)
        self.changed.emit()

    def change_target(self, target: Target, title: str) -> None:
        """Put another target in place, or another state of it, as one undo step."""
        self._session.undo.push(TargetCommand(self._put, self.target, target, title))

    def _put(self, target: Target) -> None:
        self.target, self.opening = target, ""
        if self.chosen not in self.names:
            self.chosen = ""
        self._begin_anew()

    # --- markers on the target

    def choose(self, name: str) -> None:
        """Let the next click on the target place a marker."""
        self.chosen = name if name in self.names else ""
        self.changed.emit()

    def place(self, vertex: int) -> None:
        """Put the chosen marker on a vertex, and choose the next that has no place yet."""
        name = self.chosen
        if self.target.head is None or not name:
            return
        new = name not in self.target.places
        self.change_target(with_place(self.target, name, vertex), f"place {name}")
        if new:
            self.choose(next((each for each in self.names if each not in self.target.places), name))

    def unplace(self) -> None:
        """Take the chosen marker off the target."""
        if self.chosen in self.target.places:
            self.change_target(with_place(self.target, self.chosen, None), f"remove {self.chosen}")

    def place_rest(self) -> None:
        """Let the markers that were not placed by hand follow those that were."""
        from engine.formats.characters.placing import place_rest

        performance, target, head = self.performance, self.target, self.target.head
        if head is None:
            return

        def work() -> Target:
            source = self._carrier.source(performance)
            given = {name: target.places[name] for name in source.names if name in target.by_hand}
            return replace(target, places=place_rest(source.neutral, source.names, head, given))

        self._whole.submit(Errand(work, lambda placed: self.change_target(placed, "place the other markers")))

    def read_places(self, path: Path) -> None:
        """Read where the markers are from a landmark file; raises `EngineError`."""
        if self.target.head is not None:
            places = markers_layout.read(path, vertices=len(self.target.head.neutral))
            self.change_target(replace(self.target, places=places, by_hand=frozenset(places)), f"read {path.name}")

    def write_places(self, path: Path) -> None:
        """Write where the markers are to a landmark file; raises `EngineError`."""
        markers_layout.write(self.target.places, path)

    # --- labels

    def pose(self, name: str, value: float) -> None:
        """Move a weight of the target at the playhead."""
        self.draft_pose[name] = value
        self.drawn.emit()

    def label(self) -> None:
        """Keep the target's pose at the playhead as a label."""
        face = self.face_at(self._session.playhead)
        if face is not None:
            frame, self.draft_pose = self._session.playhead, {}
            pose = dict(zip(SHAPES, face.tolist(), strict=True))
            self._relabel({**self.target.labels, frame: pose}, f"label frame {frame}")

    def unlabel(self) -> None:
        """Remove the label at the playhead."""
        frame, self.draft_pose = self._session.playhead, {}
        if frame in self.target.labels:
            rest = {each: pose for each, pose in self.target.labels.items() if each != frame}
            self._relabel(rest, f"remove the label of frame {frame}")

    def _relabel(self, poses: Mapping[int, Mapping[str, float]], title: str) -> None:
        result = self.result
        self.change_target(replace(self.target, labels=poses), title)
        self.result = result  # it is what the next label is posed from
        self.changed.emit()

    def suggest(self, count: int) -> None:
        """Find frames to label next: those that bring the others nearest to a labelled one."""
        performance, labelled = self.performance, sorted(self.target.labels)

        def work() -> list[int]:
            from engine.manifold.retarget import suggest_frames

            return suggest_frames(points_of(performance), count, labelled=labelled)

        self._whole.submit(Errand(work, self._take_suggestions))

    def _take_suggestions(self, frames: list[int]) -> None:
        self.suggestions = frames
        self.changed.emit()

    def read_labels(self, path: Path) -> None:
        """Read labels; raises `EngineError`."""
        stored = label_files.read(path)
        self._relabel(stored.labels, f"read {path.name}")

    def write_labels(self, path: Path) -> None:
        """Write labels; raises `EngineError`."""
        label_files.write(label_files.LabelFile(self.target.labels, self.target.path), path)

    # --- carrying

    def use(self, *, method: str | None = None, matching: Matching | None = None) -> None:
        """Carry by another method, or with other settings."""
        self.method, self.matching = method or self.method, matching or self.matching
        self._begin_anew()

    def ask_live(self) -> None:
        """Carry the frames around the playhead, where they are not known yet."""
        playhead, frames = self._session.playhead, len(self._session.take)
        if not self.ready or self.result is not None or self._session.tool != "retarget":
            return
        if self.method == LABELS and self.capture is None:
            return
        wanted = (self.performance, self.target.places, self.target.head, self.matching)
        asked = self._live_span if self._live_for == wanted else (0, 0)
        inside = asked[0] <= playhead and (playhead + AHEAD_FRAMES < asked[1] or asked[1] == frames)
        if inside and playhead < asked[1]:
            return
        span = (max(0, playhead - LIVE_FRAMES), min(frames, playhead + LIVE_FRAMES + 1))
        self._live_for, self._live_span = wanted, span
        wish = Carry(self.performance, self.target, self.matching, span)
        self._short.submit(Errand(lambda: self._live_carrier(wish, _nobody), lambda made: self._show_live(wish, made)))

    def _show_live(self, wish: Carry, made: Carried) -> None:
        if wish.performance is self._performance and wish.target.head is self.target.head:
            self.live = made
            self.drawn.emit()

    def solve(self) -> None:
        """Carry the whole take."""
        if not self.ready:
            self.failed.emit("There is no other head to carry the take to.", "Choose a target in the Retarget panel.")
            return
        if self.method == LABELS and not self.target.labels:
            self.failed.emit("No frame is labelled yet.", "Suggest frames, pose the target at each, and label it.")
            return
        self.cancel()
        wish = Carry(self.performance, self.target, self.matching, from_labels=self.method == LABELS)
        self._solving, self.share = wish, 0.0
        self._whole.submit(Errand(lambda: self._stoppable(wish), lambda made: self._finish(wish, made)))
        self.changed.emit()

    def _stoppable(self, wish: Carry) -> Carried | None:
        try:
            return self._carrier(wish, self.progress.emit)
        except Stopped:
            return None

    def _finish(self, wish: Carry, made: Carried | None) -> None:
        if wish is self._solving:
            self._solving, self.share, self.result = None, None, made
            self.changed.emit()

    def _advance(self, share: float) -> None:
        if self._solving is not None:
            self.share = share

    def cancel(self) -> bool:
        """Stop the solve under way; returns whether there was one."""
        if self._solving is None:
            return False
        self._solving.stop.set()
        self._solving = self.share = None
        self.changed.emit()
        return True

    def keep(self) -> None:
        """Make what was carried the take, on its head, as one undo step."""
        result, target = self.result, self.target
        if result is None or target.head is None:
            return
        session, head = self._session, target.head
        take = session.take
        inputs = {
            "target": str(target.path or ""),
            "source": self.capture.take.name if self.capture else take.name,
            "method": self.method,
            "labels": {str(frame): dict(pose) for frame, pose in target.labels.items()},
            "places": dict(target.places),
            "alpha": self.matching.alpha,
            "beta": self.matching.beta,
            "closure": self.matching.closure,
        }

        def work() -> Patch:
            from engine.editing import Patch

            return Patch.between(take, take.with_weights(result.take.weights), (0, len(take)))

        def then(patch: Patch) -> None:
            if session.take is take:
                played_on = None if head is bundled() else head
                session.undo.push(KeepCommand(session, patch, f"carry to {head.name}", played_on, inputs))

        self._whole.submit(Errand(work, then))

    def drop(self) -> None:
        """Keep nothing of what was carried."""
        self.result = None
        self._live_for = ()
        self.ask_live()
        self.changed.emit()

    def close(self) -> None:
        """Stop what is under way and end the threads."""
        self.cancel()
        self._whole.stop()
        self._short.stop()

    # --- within

    def _begin_anew(self) -> None:
        """Forget what another source, target or setting came to."""
        self.cancel()
        self.result, self.draft_pose = None, {}
        self.ask_live()
        self.changed.emit()

    def _deliver(self, errand: Errand, result: Any) -> None:
        errand.then(result)

    def _refused(self, request: object, sentence: str, advice: str) -> None:
        self._solving, self.share, self.opening = None, None, ""
        self.failed.emit(sentence, advice)
        self.changed.emit()

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            if self.capture is not None and self._session.take is not self.capture.take:
                self.capture, self._capture_path = None, None
            self.target, self.suggestions = replace(self.target, labels={}), []
        if change & (Change.TAKE | Change.CURVES | Change.CHARACTER):
            self._performance, self.live, self._live_for = None, None, ()
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


def _nobody(_: float) -> None:
    pass
