"""The actions that change the take."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from app.curves.brush import eased_to
from app.curves.panel import CurvesPanel
from app.inspector.value import closes
from app.session import Session
from app.session.commands import EditCommand
from app.session.curve_table import CURVES
from app.session.edits import Editing
from app.spans.filling import Filling
from engine.controls import CONTROLS
from engine.editing import DEFAULT_BELIEVABILITY, PasteRequest, SmoothRequest
from engine.errors import EngineError
from engine.project.records import FILL
from engine.take import Array
from engine.words import counted

EASE_S = 0.16  # beside a selection that is set to a value
CLOSE_S, OPEN_S = 0.08, 0.14  # of a blink: lids fall faster than they rise
RADIUS_STEP = 1.25


class EditActions(QObject):
    """Each method is an action of the table.

    Parameters
    ----------
    session, inference, curves, filling : what they work on
    """

    message = Signal(str)  # a short remark for the status bar

    def __init__(self, session: Session, inference: Editing, curves: CurvesPanel, filling: Filling) -> None:
        super().__init__()
        self._session, self._inference, self._curves, self._filling = session, inference, curves, filling
        self._copied: Array | None = None
        self.cutoff_hz: Callable[[], float] = lambda: 6.0
        self.cancel_move: Callable[[], bool] = lambda: False  # cancels a move on the timeline; whether there was any
        self.hide_notice: Callable[[], bool] = lambda: False  # the notice that is shown; whether there was any
        self.stop_else: Callable[[], bool] = lambda: False  # stops other work under way; whether there was any

    def undo(self) -> None:
        """Take back the last step."""
        if not self._inference.busy:
            self._filling.drop()
            self._session.document.undo.undo()

    def redo(self) -> None:
        """Do the step that was taken back again."""
        if not self._inference.busy:
            self._filling.drop()
            self._session.document.undo.redo()

    def cancel(self) -> None:
        """Cancel the gesture, the fill or the preview; with none, hide a notice, then clear the selection."""
        tool = self._curves.tool
        if tool.busy:
            tool.cancel()
        elif self._filling.variants or self._filling.busy:
            self._filling.drop()
        elif self._inference.busy:
            self._inference.cancel()
        elif not (self.cancel_move() or self.stop_else() or self.hide_notice()):
            self._session.view.select(None)

    def close_here(self) -> None:
        """Bring lips or eyelids together on the selection, or around the playhead."""
        lane = self._session.view.lane
        if closes(lane):
            blinks = CONTROLS[CURVES[lane].column].area == "eyelids"
            self._set_curve(0.0, f"close {CURVES[lane].title}", eases_s=(CLOSE_S, OPEN_S) if blinks else None)

    def set_value(self, value: float) -> None:
        """Set the active curve at the playhead, or over the selection, to a value."""
        curve = CURVES[self._session.view.lane]
        self._set_curve(value, f"set {curve.title} to {curve.shown(value)}")

    def _set_curve(self, value: float, title: str, eases_s: tuple[float, float] | None = None) -> None:
        session = self._session
        if self._inference.busy:
            return
        frames = session.view.selection or (session.view.playhead, session.view.playhead + 1)
        ease_s = EASE_S if session.view.selection else session.view.radius_s
        before, after = (seconds * session.document.take.fps for seconds in eases_s or (ease_s, ease_s))
        curve = session.document.curve(session.view.lane)
        start, asked = eased_to(curve, frames, value, before_frames=before, after_frames=after)
        self._curves.tool.ask(session.view.lane, start, asked)
        self._inference.finish(title, kind="set", inputs={"value": value, "frames": list(frames)})

    def hit_exactly(self) -> None:
        """Let edits hit their curve, believable or not; or let them be believable again."""
        believability = 0.0 if self._session.view.believability else DEFAULT_BELIEVABILITY
        self._session.view.set_brush(believability=believability)

    def go_there(self) -> None:
        """Make the last edit again so that it goes where it was pulled, believable or not."""
        self._session.view.set_brush(believability=0.0)
        self.again()

    def again(self) -> None:
        """Take the last edit back and make it again with the settings as they are now; a fill, as it was made."""
        session = self._session
        step = session.document.undo.command(session.document.undo.index() - 1)
        if isinstance(step, EditCommand) and step.edit.kind == FILL and not self._inference.busy:
            self._fill_again(step)
            return
        if not isinstance(step, EditCommand) or step.asked is None or self._inference.busy:
            self.message.emit("the last step set no curve")
            return
        start, asked = step.asked
        self.undo()
        self._inference.ask(start, asked)
        self._inference.finish(step.text(), kind=step.edit.kind, inputs=step.edit.inputs)

    def _fill_again(self, step: EditCommand) -> None:
        self.undo()
        try:
            self._filling.make_again(step.edit.inputs)
        except EngineError as error:
            self._session.document.undo.redo()
            self._filling.failed.emit(error.sentence, error.advice)

    def copy(self) -> None:
        """Remember the weights of the selection, or of the frame at the playhead."""
        session = self._session
        start, stop = session.view.selection or (session.view.playhead, session.view.playhead + 1)
        self._copied = session.document.take.weights[start:stop]
        self.message.emit(f"copied {counted(stop - start, 'frame')}")

    def paste(self) -> None:
        """Put what was copied in place from the playhead on."""
        copied, start = self._copied, self._session.view.playhead
        if copied is None or self._inference.busy:
            return
        self._inference.run(PasteRequest(start, copied))
        self._inference.finish(f"paste {counted(len(copied), 'frame')}", kind="paste", inputs={"start": start})

    def preview_smoothing(self, cutoff_hz: float) -> None:
        """Show what a Butterworth filter does to the selection, or the whole take."""
        frames = self._session.view.selection or (0, len(self._session.document.take))
        self._inference.run(SmoothRequest(frames, cutoff_hz))

    def smooth(self) -> None:
        """Smooth at the cutoff that the inspector shows."""
        cutoff_hz = self.cutoff_hz()
        self.preview_smoothing(cutoff_hz)
        self._inference.finish(f"smooth at {cutoff_hz:g} Hz", kind="smooth")

    def accept(self) -> None:
        """Keep the fill that is shown."""
        self._filling.accept()

    def wider_brush(self) -> None:
        """Let the brush move more frames."""
        self._session.view.set_brush(radius_s=self._session.view.radius_s * RADIUS_STEP)

    def narrower_brush(self) -> None:
        """Let the brush move fewer frames."""
        self._session.view.set_brush(radius_s=self._session.view.radius_s / RADIUS_STEP)

    def drag_tool(self) -> None:
        """Work with the Drag tool."""
        self._session.view.choose_tool("drag")

    def draw_tool(self) -> None:
        """Work with the Draw tool."""
        self._session.view.choose_tool("draw")

    def scale_tool(self) -> None:
        """Work with the Scale tool."""
        self._session.view.choose_tool("scale")

    def pin_tool(self) -> None:
        """Work with the Pin tool."""
        self._session.view.choose_tool("pin")

    def mark_tool(self) -> None:
        """Work with the Mark tool."""
        self._session.view.choose_tool("mark")

    def live_tool(self) -> None:
        """Work with a phone's stream."""
        self._session.view.choose_tool("live")

    def show_removed(self) -> None:
        """Draw what the Clean tool would remove, or not."""
        self._session.view.show_removed(shown=not self._session.view.shows_removed)

    def clean_tool(self) -> None:
        """Work with the Clean tool."""
        self._session.view.choose_tool("clean")
