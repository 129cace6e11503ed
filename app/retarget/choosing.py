"""Reads files of markers and heads on a thread, and sets them as source and target."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from app.retarget.capture import Capture, captured
from app.retarget.target import Pose, Target, opened, with_markers
from app.session import Session
from engine.character import Character, bundled
from engine.formats.characters.reading import Reading

if TYPE_CHECKING:
    from app.retarget.retargeting import Retargeting


class Choosing(QObject):
    """Reads one source or target at a time, and puts it in place.

    Parameters
    ----------
    session : whose take is retargeted
    retargeting : whose source and target they are

    Attributes
    ----------
    opening : the name of the file that is being opened, or nothing
    refused : a head that could not be used as it was read, and how it was; None where there is none
    """

    capture_opened = Signal(object)  # a Take of the capture's length
    message = Signal(str)  # what is being read, or nothing

    def __init__(self, session: Session, retargeting: Retargeting) -> None:
        super().__init__()
        self._session, self._retargeting = session, retargeting
        self.opening = ""
        self.refused: tuple[Path, Reading] | None = None
        self._head: tuple[Path | None, Reading] | None = None  # that is being opened
        self._capture_path: Path | None = None
        self._offered: Character | None = None  # shown on, and made the target where the user chose none

    def open_markers(self, path: Path, neutral_frame: int = 0) -> None:
        """Read a capture and retarget it in place of the take."""
        target = self._retargeting.target

        def work() -> Capture:
            return captured(path, neutral_frame, target)

        self._open(path.name, work, lambda capture: self._take_capture(capture, path))

    def measure_from(self, frame: int) -> None:
        """Take another frame of the capture for the face at rest."""
        if self._capture_path is not None:
            self.open_markers(self._capture_path, frame)

    def choose_target(
        self, path: Path | None, labels: Mapping[int, Pose] | None = None, reading: Reading | None = None
    ) -> None:
        """Read the head to retarget to from a file or folder; None is the bundled one. `labels` are those known for it.

        `reading` is what a person corrected about it: its markers by hand and its labels stay then.
        """
        name = _title(path) if path else bundled().name
        before, capture = self._retargeting.target, self._retargeting.capture

        def work() -> Target:
            found = opened(path, reading)
            if reading is not None and before.path == path:
                by_hand = {each: before.places[each] for each in before.by_hand}
                found = replace(found, labels=before.labels, by_hand=before.by_hand)
                found = replace(found, places={**found.places, **by_hand})
            found = found if labels is None else replace(found, labels=labels)
            return found if capture is None else with_markers(found, capture, before.markers)

        title = f"retarget to {name}" if reading is None else f"read {name} again"
        self.refused = None
        self._open(
            name, work, lambda target: self._retargeting.change_target(target, title), (path, reading or Reading())
        )

    def read_anew(self, **changes: Any) -> None:
        """Read the target again, or the head that could not be used, with fields of its `Reading` changed."""
        target = self._retargeting.target
        path, reading = self.refused or (target.path, target.reading)
        if path is not None:
            self.choose_target(path, reading=replace(reading, **changes))

    def show_on(self, path: Path | None) -> None:
        """Read a head to show the take on, None for the bundled one; it is the target where the user chose no other."""
        self.message.emit(f"reading {_title(path)}…" if path else "")
        self._retargeting.submit_short(lambda: opened(path) if path else Target(), self._take_shown, "head")

    def _take_shown(self, offer: Target) -> None:
        self.message.emit("")
        self._session.view.show_on(offer.head)
        state = self._retargeting
        target = state.target
        touched = target.head is not self._offered or target.labels or target.by_hand or state.result is not None
        if target.head is None or not touched:
            self._offered = offer.head
            state.put(offer if state.capture is None else with_markers(offer, state.capture, target.markers))

    def _open(
        self,
        name: str,
        work: Callable[[], Any],
        then: Callable[[Any], None],
        head: tuple[Path | None, Reading] | None = None,
    ) -> None:
        self._retargeting.cancel()
        self.opening, self._head = name, head
        self._retargeting.submit(work, then)
        self._retargeting.changed.emit()

    def _take_capture(self, opened: Capture, path: Path) -> None:
        """Set a capture as the source, unless the user kept the open take to save its edits."""
        self.opening = ""
        state = self._retargeting
        before = state.capture, self._capture_path
        state.capture, self._capture_path = opened.source, path
        self.capture_opened.emit(opened.source.take)
        if self._session.document.take is not opened.source.take:
            state.capture, self._capture_path = before
        else:
            state.put(opened.on(state.target))
            if state.target.head is None:
                self.choose_target(None)
            if opened.doubt is not None:
                state.failed.emit(opened.doubt.sentence, "Place some of its markers on the target by hand.")
        state.changed.emit()

    def chosen(self) -> None:
        """Take note that a target is in place."""
        self.opening, self.refused = "", None

    def forget_capture(self) -> None:
        """Take note that another take was opened."""
        self._capture_path = None

    def give_up(self) -> None:
        """Remember the head that could not be read; nothing is being opened any more."""
        if self.opening and self._head is not None and self._head[0] is not None:
            self.refused = self._head[0], self._head[1]
        self.opening, self._head = "", None


def _title(path: Path) -> str:
    from engine.formats.characters.opening import SECOND_TITLE, is_second

    return SECOND_TITLE if is_second(path) else path.name
