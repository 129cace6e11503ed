"""The Retarget tool's settings: source, head, method, and what to do with the result."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QProgressBar, QPushButton, QSpinBox, QWidget

from app.retarget.labelling import Labelling
from app.retarget.labels import LabelsBox
from app.retarget.retargeting import Retargeting
from app.retarget.solving import LABELS, MOVEMENT
from app.retarget.strengths import StrengthSliders
from app.session import Session
from app.widgets.section import Section, quiet
from engine.words import counted

METHODS = {"Match the movement": MOVEMENT, "From a few labels": LABELS}


class RetargetSection(Section):
    """Source, target, method; solve the whole take, keep it or drop it.

    Parameters
    ----------
    session : whose take is retargeted
    retargeting, labelling : retarget it, and hold the labels

    Attributes
    ----------
    markers_button, target_button, folder_button, bundled_button, solve_button, cancel_button, keep_button, drop_button,
    save_button, read_button : for the window's actions
    """

    tools = frozenset({"retarget"})

    def __init__(self, session: Session, retargeting: Retargeting, labelling: Labelling) -> None:
        super().__init__(session, "Retarget")
        self._retargeting = retargeting
        self._source, self._target = quiet(""), quiet("")
        self.markers_button = QPushButton("Markers…")
        self.markers_button.setToolTip("Retarget a capture's markers (CSV, TRC, C3D) in place of the open take")
        self.rest_frame = QSpinBox(maximum=10_000_000)
        self.rest_frame.setKeyboardTracking(False)
        self.rest_frame.setToolTip("A frame of the capture in which the face is at rest")
        self.rest_frame.valueChanged.connect(retargeting.choosing.measure_from)
        self.target_button, self.folder_button = QPushButton("Head…"), QPushButton("Folder…")
        self.bundled_button = QPushButton("Retake head")
        self.target_button.setToolTip("A character file, glTF, GLB or VRM, OBJ, or a packed ICT-FaceKit")
        self.folder_button.setToolTip("A folder with one OBJ file for each shape")
        self.bundled_button.setToolTip("The head that comes with Retake, which every take is shown on at first")
        self.column.addWidget(self._source)
        self.column.addWidget(self.markers_button)
        self._rest = QWidget()
        rest = QHBoxLayout(self._rest)
        rest.setContentsMargins(0, 0, 0, 0)
        rest.addWidget(quiet("At rest in frame"), 1)
        rest.addWidget(self.rest_frame)
        self.column.addWidget(self._rest)
        self.column.addWidget(self._target)
        self.side_by_side(self.target_button, self.folder_button)
        self.column.addWidget(self.bundled_button)
        self.method = QComboBox()
        self.method.addItems(list(METHODS))
        self.method.setAccessibleName("Method")
        self.method.activated.connect(lambda _: retargeting.use(method=METHODS[self.method.currentText()]))
        self.column.addWidget(self.method)
        self.strengths = StrengthSliders()
        self.strengths.changed.connect(lambda matching: retargeting.use(matching=matching))
        self.column.addWidget(self.strengths)
        self.labels = LabelsBox(session, retargeting, labelling)
        self.column.addWidget(self.labels)
        self._lay_out_solve()
        self.column.addWidget(self.labels.weights)
        retargeting.changed.connect(self.show_all)
        retargeting.drawn.connect(self._show_pose)
        retargeting.progress.connect(self._show_share)
        self.show_all()

    def _lay_out_solve(self) -> None:
        self.solve_button, self.cancel_button = QPushButton("Solve the whole take"), QPushButton("Cancel")
        self.keep_button, self.drop_button = QPushButton("Keep"), QPushButton("Discard")
        for button in (self.solve_button, self.keep_button):
            button.setProperty("primary", True)
        self.keep_button.setToolTip("The take becomes this, on the target's head; one undo takes it back")
        self.bar = QProgressBar(maximum=100)
        self.bar.setAccessibleName("Progress of the solve")
        self.column.addWidget(self.solve_button)
        self.column.addWidget(self.bar)
        self.column.addWidget(self.cancel_button)
        self.side_by_side(self.keep_button, self.drop_button)
        self._facts = quiet("")
        self.column.addWidget(self._facts)
        self.save_button, self.read_button = QPushButton("Save…"), QPushButton("Read…")
        self.save_button.setToolTip("Write the labels to a file")
        self.read_button.setToolTip("Read labels from a file; the head that it names is opened too")
        self.side_by_side(self.save_button, self.read_button)

    def show_all(self) -> None:
        """Show the state."""
        state = self._retargeting
        head, capture, labels = state.target.head, state.capture, state.method == LABELS
        what = (
            f"{capture.take.name}, {counted(len(capture.names), 'marker')}"
            if capture
            else self.session.document.take.name
        )
        self._source.setText(f"From: {what}" + ("" if capture else f" on {state.performance.head.name}"))
        self._target.setText(
            f"Opening {state.choosing.opening}…"
            if state.choosing.opening
            else f"To: {head.name if head else 'no head yet'}"
        )
        self._rest.setVisible(capture is not None)
        with QSignalBlocker(self.rest_frame):
            self.rest_frame.setMaximum(max(0, len(self.session.document.take) - 1))
        self.strengths.setVisible(state.ready and not labels)
        for part in (self.labels, self.labels.weights, self.save_button, self.read_button):
            part.setVisible(state.ready and labels)
        self.method.setVisible(state.ready)
        solving = state.share is not None
        again = labels and state.result is not None  # a label was added where it was worst
        self.solve_button.setVisible(state.ready and not solving and (state.result is None or labels))
        self.solve_button.setText(
            "Solve again" if again else "Solve from the labels" if labels else "Solve the whole take"
        )
        self.bar.setVisible(solving)
        self.cancel_button.setVisible(solving)
        for widget in (self.keep_button, self.drop_button):
            widget.setVisible(state.result is not None)
        self._show_share(state.share or 0.0)
        self._facts.setText(self._hint())
        with QSignalBlocker(self.method):
            self.method.setCurrentIndex([*METHODS.values()].index(state.method))
        if labels and state.ready:
            self.labels.show_all()

    def _hint(self) -> str:
        state = self._retargeting
        if state.target.head is None:
            return "Choose a head to retarget to."
        if not state.ready:
            return f"The take is on {state.target.head.name}. Choose another head to retarget to."
        if state.result is not None:
            notices = [each for each in state.result.take.notices if each not in state.performance.take.notices]
            return " ".join(
                [f"Solved {counted(len(state.result.take), 'frame')}: play them, then keep or discard them.", *notices]
            )
        if state.share is not None:
            return "You can go on working."
        if state.method == LABELS:
            return f"{counted(len(state.target.labels), 'frame')} labelled."
        return "The preview follows at once, for the frames around the playhead."

    def _show_share(self, share: float) -> None:
        self.bar.setValue(round(100 * share))

    def _show_pose(self) -> None:
        if self._retargeting.method == LABELS and self._retargeting.ready:
            self.labels.show_pose()
