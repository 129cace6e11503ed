"""Labels: what the target does at a few frames, posed there, suggested, read and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.retarget.retargeting import Retargeting
from app.retarget.solving import LABELS
from app.retarget.target import Pose
from app.session import Session
from engine.editing import suggest_frames
from engine.errors import EditError
from engine.formats import labels as files
from engine.formats.characters.opening import is_second
from engine.formats.labels import LabelFile
from engine.take import SHAPES
from engine.words import counted


class Labelling:
    """Changes the target's labels, each change one undo step.

    Parameters
    ----------
    session : whose playhead says which frame
    retargeting : whose target it is
    """

    def __init__(self, session: Session, retargeting: Retargeting) -> None:
        self._session, self._retargeting = session, retargeting

    @property
    def loosest(self) -> int | None:
        """The frame that the labels hold most loosely, as last solved: the one to label next."""
        result = self._retargeting.result
        if result is None or result.uncertainty is None:
            return None
        return int(np.argmax(result.uncertainty))

    def pose(self, name: str, value: float) -> None:
        """Move a weight of the target at the playhead."""
        self._retargeting.draft_pose[name] = value
        self._retargeting.drawn.emit()

    def label(self) -> None:
        """Keep the target's pose at the playhead as a label; raises `EditError` where there is no target."""
        frame = self._session.view.playhead
        face = self._retargeting.face_at(frame)
        if face is None:
            raise EditError("There is no head to label.", "Choose a head in the Retarget panel.")
        pose = dict(zip(SHAPES, face.tolist(), strict=True))
        self._change({**self._retargeting.target.labels, frame: pose}, f"label frame {frame}")

    def unlabel(self) -> None:
        """Remove the label at the playhead."""
        frame, labels = self._session.view.playhead, self._retargeting.target.labels
        if frame in labels:
            rest = {each: pose for each, pose in labels.items() if each != frame}
            self._change(rest, f"remove the label of frame {frame}")

    def suggest(self, count: int) -> None:
        """Find frames to label next: those that bring the others nearest to a labelled one."""
        state = self._retargeting
        performance, labelled = state.performance, sorted(state.target.labels)

        state.submit(lambda: suggest_frames(performance, count, labelled), state.propose)

    def read(self, path: Path) -> None:
        """Read labels, and open the head that they are for where the file names one; raises `EngineError`."""
        stored, frames, state = files.read(path), len(self._session.document.take), self._retargeting
        outside = [frame for frame in stored.labels if frame >= frames]
        if outside:
            raise EditError(f"{path.name} labels frame {outside[0]}; the take has {counted(frames, 'frame')}.")
        if state.method != LABELS:
            state.use(method=LABELS)
        known = state.target.path
        if stored.elsewhere and (known is None or known.absolute() != Path(stored.elsewhere)):
            name = stored.elsewhere.replace("\\", "/").rpartition("/")[2][:60]
            raise EditError(
                f"{path.name} is for the head {name!r}, which does not lie beside it.", "Choose that head first."
            )
        if stored.target is None or (known is not None and known.absolute() == stored.target.absolute()):
            self._change(stored.labels, f"read {path.name}")
        else:
            state.choosing.choose_target(stored.target, stored.labels)

    def write(self, path: Path) -> None:
        """Write labels; raises `EngineError`."""
        target, folder = self._retargeting.target, path.absolute().parent
        bundled = target.path is None or is_second(target.path)
        head = None if target.path is None or bundled else target.path.absolute()
        if head is not None:  # so that the two can move together; a file names nothing outside its folder
            head = head.relative_to(folder) if head.is_relative_to(folder) else None
        files.write(LabelFile(target.labels, head), path)

    def _change(self, labels: Mapping[int, Pose], title: str) -> None:
        state = self._retargeting
        solved = state.result, state.solved
        state.change_target(replace(state.target, labels=labels), title)
        state.show(*solved)  # it is what the next label is posed from
