"""The actions of retargeting, and the parts that perform them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.retarget.heads import HeadSection
from app.retarget.labelling import Labelling
from app.retarget.places import PlacesSection
from app.retarget.placing import Placing
from app.retarget.retargeting import Retargeting
from app.retarget.section import RetargetSection
from app.retarget.sides import sides
from app.session import Session
from app.widgets.saving import ask_where, beside
from app.widgets.section import Section
from engine.errors import EngineError
from engine.formats.characters.opening import SECOND

HEADS = "Heads (*.npz *.glb *.gltf *.vrm *.obj *.ply *.stl)"
CAPTURES = "Markers (*.csv *.tsv *.trc *.c3d)"
SUGGESTED = 4


class RetargetActions(QObject):
    """Each public method without arguments is an action of the table.

    Parameters
    ----------
    session : whose take is retargeted
    window : the parent of the dialogs

    Attributes
    ----------
    retargeting, labelling, placing : the performance, its labels and its markers
    panel, heads, places : the sections that show it
    """

    shown = Signal(object)  # sides, for the preview
    failed = Signal(str, str)

    def __init__(self, session: Session, window: QWidget) -> None:
        super().__init__()
        self._session, self._window = session, window
        self.retargeting = Retargeting(session)
        self.labelling, self.placing = Labelling(session, self.retargeting), Placing(self.retargeting)
        self.panel = RetargetSection(session, self.retargeting, self.labelling)
        self.heads = HeadSection(session, self.retargeting)
        self.places = PlacesSection(session, self.retargeting, self.placing)
        self.retargeting.failed.connect(self.failed)
        for signal in (self.retargeting.changed, self.retargeting.drawn):
            signal.connect(self._show)
        panel, labels, places = self.panel, self.panel.labels, self.places
        for button, do in (
            (panel.markers_button, self.open_markers),
            (panel.target_button, self.choose_target),
            (panel.folder_button, self.choose_target_folder),
            (panel.bundled_button, self.own_target),
            (panel.solve_button, self.carry),
            (panel.cancel_button, self.stop_carrying),
            (panel.keep_button, self.keep_carried),
            (panel.drop_button, self.drop_carried),
            (panel.save_button, self.save_labels),
            (panel.read_button, self.read_labels),
            (labels.suggest_button, self.suggest_labels),
            (labels.label_button, self.label_frame),
            (labels.unlabel_button, self.unlabel_frame),
            (labels.loosest_button, self.go_to_loosest),
            (places.rest_button, self.place_rest),
            (places.remove_button, self.unplace_marker),
            (places.save_button, self.save_places),
            (places.read_button, self.read_places),
        ):
            button.clicked.connect(lambda _=False, do=do: do())

    @property
    def sections(self) -> tuple[Section, ...]:
        """What the inspector shows with the tool."""
        return self.panel, self.heads, self.places

    def pick(self, side: int, vertex: int) -> None:
        """Place the chosen marker on the vertex that was clicked."""
        self.placing.place(vertex)

    def take_in(self, path: Path) -> None:
        """Retarget a capture that was dropped on the window."""
        self.retarget_tool()
        self.retargeting.choosing.open_markers(path)

    def _show(self) -> None:
        self.shown.emit(
            sides(self._session, self.retargeting, self.placing.chosen, dots=self.places.show_dots.isChecked())
        )

    # --- the actions

    def retarget_tool(self) -> None:
        """Work with the Retarget tool."""
        self._session.view.choose_tool("retarget")

    def open_markers(self) -> None:
        """Choose a capture to retarget."""
        self._with_file("Markers to retarget", CAPTURES, self.retargeting.choosing.open_markers)

    def choose_target(self) -> None:
        """Choose the head to retarget to."""
        self._with_file("The target head", HEADS, self.retargeting.choosing.choose_target)

    def choose_target_folder(self) -> None:
        """Choose a folder of OBJ files as the head to retarget to."""
        self.retarget_tool()
        name = QFileDialog.getExistingDirectory(self._window, "A folder of OBJ files")
        if name:
            self.retargeting.choosing.choose_target(Path(name))

    def own_target(self) -> None:
        """Retarget to the Retake head."""
        self.retarget_tool()
        self.retargeting.choosing.choose_target(None)

    def second_target(self) -> None:
        """Retarget to the second bundled head."""
        self.retarget_tool()
        self.retargeting.choosing.choose_target(SECOND)

    def carry(self) -> None:
        """Solve the whole take."""
        self.retarget_tool()
        self.retargeting.solve()

    def stop_carrying(self) -> None:
        """Cancel the solve."""
        self.retargeting.cancel()

    def keep_carried(self) -> None:
        """Keep the result, as one undo step."""
        self.retargeting.keep()

    def drop_carried(self) -> None:
        """Discard the result."""
        self.retargeting.drop()

    def suggest_labels(self) -> None:
        """Say which frames are worth a label."""
        self.labelling.suggest(SUGGESTED)

    def label_frame(self) -> None:
        """Keep the target's pose at the playhead as a label."""
        self._try(self.labelling.label)

    def unlabel_frame(self) -> None:
        """Remove the label at the playhead."""
        self.labelling.unlabel()

    def go_to_loosest(self) -> None:
        """Go to the frame that the labels tell least of."""
        frame = self.labelling.loosest
        if frame is None:
            self.failed.emit("Nothing was solved from labels yet.", "Label some frames and solve first.")
        else:
            self._session.view.move_playhead(frame)

    def save_labels(self) -> None:
        """Choose a file and write the labels."""
        self._to_file("Save the labels", "labels", {"Labels (*.json)": ".json"}, self.labelling.write)

    def read_labels(self) -> None:
        """Choose a file of labels."""
        self._with_file("Labels", "Labels (*.json)", self.labelling.read)

    def place_rest(self) -> None:
        """Let the other markers follow those that were placed by hand."""
        self.placing.place_rest()

    def unplace_marker(self) -> None:
        """Take the chosen marker off the target."""
        self.placing.unplace()

    def save_places(self) -> None:
        """Choose a landmark file and write where the markers are."""
        self._to_file("Save the landmarks", "landmarks", {"Landmarks (*.csv)": ".csv"}, self.placing.write)

    def read_places(self) -> None:
        """Choose a landmark file that says where the markers are."""
        self._with_file("Landmarks", "Landmarks (*.csv)", self.placing.read)

    # --- within

    def _with_file(self, title: str, kinds: str, use: Callable[[Path], None]) -> None:
        self.retarget_tool()
        name, _ = QFileDialog.getOpenFileName(self._window, title, "", kinds)
        if name:
            self._try(lambda: use(Path(name)))

    def _to_file(self, title: str, stem: str, kinds: Mapping[str, str], use: Callable[[Path], None]) -> None:
        path, _ = ask_where(
            self._window, title, beside(self._session.document.path, f"{stem}{next(iter(kinds.values()))}"), kinds
        )
        if path is not None:
            self._try(lambda: use(path))

    def _try(self, do: Callable[[], None]) -> None:
        try:
            do()
        except EngineError as error:
            self.failed.emit(error.sentence, error.advice)
