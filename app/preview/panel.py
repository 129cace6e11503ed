"""The panel that shows the face, with its views and its camera."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF, QTimer, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QComboBox, QFrame, QHBoxLayout, QSplitter, QToolButton, QVBoxLayout, QWidget

from app.preview.camera import PRESETS, Camera, looking
from app.preview.face import Face
from app.preview.kept import KeptPictures
from app.preview.marking import camera_of
from app.preview.overlay import Overlay
from app.preview.picking import vertex_under
from app.preview.renderer import Picture, Shot
from app.preview.worker import Wanted, render_thread
from app.session import Change, Session
from app.session.edits import Editing
from app.session.sides import Side
from app.theme import GRID
from app.widgets.text import Label
from engine.character import bundled
from engine.framing import framed
from engine.project import Drawing
from engine.take import Array
from engine.words import SENTENCE_LENGTH, plain

VIEWS = ("Before", "After", "Wipe", "Split", "Difference")
BUDGET_MS = 25.0  # a picture that takes longer loses its smooth edges while something moves, then half its resolution
STILL_MS = 180
HINT, BEFORE_HINT = "Drag to orbit · wheel to zoom", "hold B for before"
WIDE = 0.6  # of what preview and curves share, for two heads
STRIP_PX = (70, 88)  # one face of a strip
STRIP_CAMERA = Camera(zoom=1.5, pan=(0.0, -0.07))


class PreviewPanel(QFrame):
    """Before, after, split or difference of the frame at the playhead.

    Parameters
    ----------
    session : whose frame is shown
    inference : tells when the draft on screen was asked for, to time drag to preview
    """

    strip_drawn = Signal(object)  # faces side by side, (height, width, 3)
    timed = Signal(float)  # ms from the mouse event to its picture on screen
    live_timed = Signal(float)  # ms from a live packet's arrival to its picture on screen
    failed = Signal(str, str)
    picked = Signal(int, int)  # which side was clicked, and the vertex there
    dot_clicked = Signal(str)  # name of a marker
    view_changed = Signal(str)  # one of VIEWS

    def __init__(self, session: Session, inference: Editing) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self._session, self._inference = session, inference
        self._live: Array | None = None
        self._sides: tuple[Side, ...] = ()
        self._narrow: list[int] = []  # what the panels' widths were before there were two heads
        self.face = Face()
        self._frame_label = Label()
        self._frame_label.setProperty("quiet", True)
        self._coarse = False
        self._spent_ms = self._quick_ms = 0.0  # what a picture took, with smooth edges and without
        self._asked_at = 0.0
        self._off = False
        self._kept, self._from_kept = KeptPictures(), False
        self._still = QTimer(self, singleShot=True, interval=STILL_MS)
        self._still.timeout.connect(self._sharpen)
        self.drawing = render_thread()
        self.drawing.done.connect(self._arrived)
        self.drawing.failed.connect(self._refused)
        self._lay_out()
        self.face.setMouseTracking(True)
        self.face.camera_moved.connect(lambda _: self.refresh())
        self.face.resized.connect(self.refresh)
        self.face.clicked.connect(self._pick)
        session.changed.connect(self._on_change)

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(2)
        self.views: dict[str, QToolButton] = {}  # by name; Tab would reach but one of a QButtonGroup
        for name in VIEWS:
            button = QToolButton()
            button.setText(name)
            button.setCheckable(True)
            button.setProperty("segment", True)
            button.setToolTip(f"Show {name.lower()} (hold B to see the original)")
            self.views[name] = button
            row.addWidget(button)
            button.setChecked(name == self.face.view)
            button.clicked.connect(lambda _=False, chosen=name: self.show_view(chosen))
        row.addStretch(1)
        self.presets = QComboBox()
        self.presets.addItems(list(PRESETS))
        self.presets.setToolTip("Where the face is looked at from")
        self.presets.activated.connect(lambda index: self.look_from(list(PRESETS)[index]))
        row.addWidget(self.presets)
        foot = QHBoxLayout()
        self.hint = Label(f"{HINT} · {BEFORE_HINT}")
        self.hint.setProperty("quiet", True)
        foot.addWidget(self.hint)
        foot.addStretch(1)
        foot.addWidget(self._frame_label)
        self._column = column = QVBoxLayout(self)
        column.setContentsMargins(GRID, GRID, GRID, GRID)
        column.addLayout(row)
        column.addWidget(self.face, 1)
        column.addLayout(foot)

    def add_beneath(self, widget: QWidget) -> None:
        """Put another panel beneath the face."""
        self._column.addWidget(widget)

    def show_view(self, name: str) -> None:
        """Show before, after, split or difference."""
        self.face.view = name
        for view, button in self.views.items():
            button.setChecked(view == name)
        self.view_changed.emit(name)
        self.refresh(moving=False)  # nothing moves: a coarse picture first would flicker

    def step_wipe(self, by: int) -> None:
        """Move the line between before and after a step; the view is changed to the one that has it."""
        if self.face.view != "Wipe":
            self.show_view("Wipe")
        self.face.wipe.step(by)
        self.face.update()

    def draw_on(self, on: bool) -> None:
        """Let a drag draw on the picture of one face, or turn it again."""
        if on and self.face.view == "Split":
            self.show_view("After")
        self.face.draw_on(on)

    def drawn(self) -> Drawing | None:
        """Return what was drawn on the picture since it was last asked for."""
        drawing = self.face.marking.taken(self.face.camera)
        self.face.update()
        return drawing

    def look_at(self, drawing: Drawing) -> None:
        """Look at the face from where a drawing was drawn."""
        camera = camera_of(drawing)
        if camera is not None and camera != self.face.camera:
            self.face.camera = camera
            self.refresh(moving=False)

    def _show_noted(self) -> None:
        """Show what was drawn for the notes at the playhead."""
        frame, notes = self._session.view.playhead, self._session.document.marks.notes
        here = (note.drawing for note in notes if note.frame <= frame < note.stop and note.drawing is not None)
        noted = () if self._live is not None else tuple(here)
        if noted != self.face.noted:
            self.face.noted = noted
            self.face.update()

    def look_from(self, name: str) -> None:
        """Look at the face from a named place."""
        head = (self._sides[0].head if self._sides else self._session.view.head) or bundled()
        at = {point: head.neutral[vertex].astype(float) for point, vertex in head.landmarks.items()}
        self.face.camera = looking(name, at, *framed(head))
        self.presets.setCurrentText(name)
        self.refresh(moving=False)

    def close_renderer(self) -> None:
        """End the render thread."""
        self._still.stop()
        self.drawing.stop()

    def refresh(self, *, moving: bool = True, since: float = 0.0) -> None:
        """Draw the frame at the playhead anew; coarser while something moves and the budget is missed."""
        if self._off or not self.isVisible():
            return
        self._coarse = moving and self._spent_ms > BUDGET_MS
        ratio = self.devicePixelRatioF() * (0.5 if self._coarse and self._quick_ms > BUDGET_MS else 1.0)
        pictures = 2 if self._wiped else 1
        size = (pictures * int(self.face.width() * ratio), int(self.face.height() * ratio))
        self._asked_at = time.perf_counter()
        shot = replace(self._shot(), size=size, smooth_edges=not self._coarse)
        live = self._live is not None
        view = "After" if live or self._sides else self.face.view
        wanted = Wanted(shot, self._session.view.head, since, live=live, sides=self._sides, view=view)
        kept = self._kept.get(wanted)
        self._from_kept = kept is not None
        if kept is not None:
            self.face.show_picture(kept, view=wanted.view)
            return
        self.drawing.submit(wanted)
        if self._coarse:
            self._still.start()

    def show_live(self, weights: Array | None, arrived_s: float = 0.0) -> None:
        """Show a live face, (52,) weights, in place of the take's; None goes back to the take."""
        self._live = weights
        self._show_frame()
        self._show_hint()
        self.refresh(since=arrived_s)

    def show_sides(self, sides: tuple[Side, ...]) -> None:
        """Show these side by side in place of the take; none goes back to it."""
        self._sides = sides
        for button in self.views.values():
            button.setEnabled(not sides)
        self._show_hint()
        self._widen(wide=len(sides) > 1)
        self.refresh()

    def _widen(self, *, wide: bool) -> None:
        """Make room for two heads, and give it back after."""
        split = self.parentWidget()
        if not isinstance(split, QSplitter) or wide == bool(self._narrow):
            return
        sizes, self._narrow = (self._narrow, []) if not wide else (split.sizes(), split.sizes())
        whole = sum(sizes)
        split.setSizes([round(WIDE * whole), round((1 - WIDE) * whole)] if wide else sizes)

    def draw_strip(self, faces: list[Array]) -> None:
        """Draw faces, (52,) weights each, small and side by side; `strip_drawn` brings the picture."""
        if not self._off and faces:
            size = (STRIP_PX[0] * len(faces), STRIP_PX[1])
            wanted = Wanted(Shot(tuple(faces), STRIP_CAMERA, size), self._session.view.head, strip=True)
            self.drawing.submit(wanted, "strip")

    def _show_hint(self) -> None:
        """Say what the mouse does, and how to see the original where it can be shown."""
        self.hint.setText(HINT if self._sides or self._live is not None else f"{HINT} · {BEFORE_HINT}")

    def _show_frame(self) -> None:
        self._frame_label.setText("live" if self._live is not None else f"frame {self._session.view.playhead:,}")

    @property
    def _wiped(self) -> bool:
        """Whether two whole pictures are wanted, one over the other."""
        return self.face.view == "Wipe" and self._live is None and not self._sides

    def _shot(self) -> Shot:
        session, view = self._session, self.face.view
        after = session.document.frame_weights(session.view.playhead)
        before = np.asarray(session.document.original.weights[session.view.playhead])
        camera = self.face.camera
        if self._live is not None:
            return Shot((self._live,), camera)
        if self._sides:
            heads = tuple(side.head or bundled() for side in self._sides)
            return Shot(tuple(side.weights for side in self._sides), camera, heads=heads)
        if view == "Before":
            return Shot((before,), camera)
        if view in ("Split", "Wipe"):
            return Shot((before, after), camera)
        if view == "Difference":
            return Shot((after,), camera, compared_to=before)
        return Shot((after,), camera)

    def _sharpen(self) -> None:
        self.refresh(moving=False)

    def _arrived(self, wanted: Wanted, picture: Picture) -> None:
        if wanted.strip:
            self.strip_drawn.emit(picture)
            return
        spent = (time.perf_counter() - self._asked_at) * 1e3
        if wanted.shot.smooth_edges:
            self._spent_ms = spent
        elif wanted.shot.size[1] > 0.75 * self.face.height() * self.devicePixelRatioF():
            self._quick_ms = spent
        self._kept.put(wanted, picture)
        if self._from_kept:
            return  # what was wanted since is on the screen already
        size = self.face.width(), self.face.height()
        overlay = Overlay.of(wanted.sides, wanted.shot.camera, *size) if wanted.sides else None
        self.face.show_picture(picture, overlay, wanted.view)
        if wanted.since:
            timed = self.live_timed if wanted.live else self.timed
            timed.emit((time.perf_counter() - wanted.since) * 1e3)

    def _pick(self, at: QPointF) -> None:
        """Name the dot under the pointer, or else the vertex."""
        overlay = self.face.overlay
        if overlay is None:
            return
        index, dot = overlay.side_at(at.x()), overlay.dot_at(at.x(), at.y())
        side = overlay.sides[index]
        if side.pickable and side.weights is not None:
            head = side.head or bundled()
            vertex = vertex_under(head, side.weights, overlay.views[index], at.x(), at.y())
            if vertex is not None:
                self.picked.emit(index, vertex)
        elif dot is not None:
            self.dot_clicked.emit(side.dots[dot[1]].name)

    def _refused(self, wanted: Wanted, sentence: str, advice: str) -> None:
        self._off = True
        self.face.image = QImage()
        self.face.message = f"Preview off\n\n{plain(sentence, longest=SENTENCE_LENGTH)}"
        self.face.update()
        self.failed.emit(sentence, advice)

    def _on_change(self, change: Change) -> None:
        if change & Change.HEAD:
            self.face.head = self._session.view.head
        if change & (Change.TAKE | Change.MARKS | Change.PLAYHEAD):
            self._show_noted()
        if change & (Change.TAKE | Change.CURVES | Change.DRAFT | Change.PLAYHEAD | Change.HEAD):
            session = self._session
            self._show_frame()
            drafted = change & Change.DRAFT and session.document.draft is not None and self._inference.busy
            self.refresh(since=self._inference.since if drafted else 0.0)

    def showEvent(self, event: object) -> None:
        """Draw as soon as there is something to draw on."""
        QTimer.singleShot(0, self.refresh)
