"""Labelled frames: which there are, which to label next, and the target's pose at the playhead."""

from __future__ import annotations

from functools import partial

import numpy as np
from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtWidgets import QPushButton, QVBoxLayout, QWidget

from app.retarget.labelling import Labelling
from app.retarget.retargeting import Retargeting
from app.session import Session
from app.widgets.section import empty, quiet
from app.widgets.weight_sliders import WeightSliders
from engine.take import timecode

SHOWN = 10


class LabelsBox(QWidget):
    """Lists frames with a label and those worth one; sliders pose the target at the playhead.

    Parameters
    ----------
    session : whose playhead it is
    retargeting, labelling : keep the labels, and change them

    Attributes
    ----------
    suggest_button, label_button, unlabel_button, loosest_button : for the window's actions
    frames : the listed frames' buttons, by frame
    weights : the target's pose at the playhead
    """

    menu_wanted = Signal(QPoint)  # on the screen, after the playhead went to the labelled frame

    def __init__(self, session: Session, retargeting: Retargeting, labelling: Labelling) -> None:
        super().__init__()
        self._session, self._retargeting, self._labelling = session, retargeting, labelling
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        self.suggest_button, self.label_button = QPushButton("Suggest frames"), QPushButton("Label this frame")
        self.unlabel_button, self.loosest_button = QPushButton("Remove this label"), QPushButton()
        self._list = QVBoxLayout()
        self._list.setSpacing(2)
        column.addWidget(self.suggest_button)
        column.addLayout(self._list)
        column.addWidget(self.loosest_button)
        self._hint = quiet("")
        column.addWidget(self._hint)
        column.addWidget(self.label_button)
        column.addWidget(self.unlabel_button)
        self.weights = WeightSliders()  # the section puts it last: it is long
        self.weights.moved.connect(labelling.pose)
        self.weights.searched.connect(self.show_pose)
        self.frames: dict[int, QPushButton] = {}

    def show_all(self) -> None:
        """Show the labels and the pose at the playhead."""
        self._show_list()
        loosest = self._labelling.loosest
        self.loosest_button.setVisible(loosest is not None)
        if loosest is not None:
            self.loosest_button.setText(f"Likely worst: frame {loosest}")
            self.loosest_button.setToolTip(
                "Where the labels tell least, and the solve is likely furthest off: label it next"
            )
        self.show_pose()

    def show_pose(self) -> None:
        """Show the target's pose at the playhead."""
        frame, retargeting = self._session.view.playhead, self._retargeting
        face = retargeting.face_at(frame)
        if face is None:
            return
        labelled = frame in retargeting.target.labels
        self._hint.setText(f"Frame {frame} has a label." if labelled else f"The target's pose at frame {frame}:")
        self.label_button.setText("Replace the label" if labelled else "Label this frame")
        self.unlabel_button.setVisible(labelled)
        reach = round(self._session.document.take.fps / 2)
        around = self._session.document.take.weights[max(0, frame - reach) : frame + reach + 1]
        self.weights.show_face(face, np.ptp(around, axis=0) + face, retargeting.draft_pose)

    def _show_list(self) -> None:
        labelled, fps = self._retargeting.target.labels, self._session.document.take.fps
        waiting = [frame for frame in self._retargeting.suggestions if frame not in labelled]
        listed = sorted([*labelled, *waiting])
        if listed[:SHOWN] != list(self.frames):
            self._lay_out_list(listed)
        for frame, button in self.frames.items():
            state = "labelled" if frame in labelled else "to label"
            button.setText(f"{timecode(frame / fps, fps)}  {frame} · {state}")

    def _open_menu(self, frame: int, button: QPushButton, at: QPoint) -> None:
        where = button.mapToGlobal(at)
        self._session.view.move_playhead(frame)
        self.menu_wanted.emit(where)

    def _lay_out_list(self, frames: list[int]) -> None:
        empty(self._list)
        self.frames = {}
        for frame in frames[:SHOWN]:
            button = self.frames[frame] = QPushButton()
            button.setToolTip("Go to this frame")
            button.clicked.connect(lambda _=False, frame=frame: self._session.view.move_playhead(frame))
            button.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            button.customContextMenuRequested.connect(partial(self._open_menu, frame, button))
            self._list.addWidget(button)
        if len(frames) > SHOWN:
            self._list.addWidget(quiet(f"and {len(frames) - SHOWN} more"))
