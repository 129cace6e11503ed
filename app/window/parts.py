"""The parts of the window: what works on the take, the panels that show it, and the actions."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QMainWindow

from app import theme
from app.actions.edit import EditActions
from app.actions.file import FileActions
from app.actions.flags import FlagActions
from app.actions.marks import MarkActions
from app.actions.media import MediaActions
from app.actions.menus import Menus
from app.actions.owners import owners_of
from app.actions.settings import SettingsActions
from app.actions.table import ACTIONS
from app.actions.time import TimeActions
from app.actions.view import ViewActions
from app.actions.viseme import VisemeActions
from app.clean.section import CleanSection
from app.curves.panel import CurvesPanel
from app.curves.places import GUTTER_PX
from app.importing.line import ImportLine
from app.inspector.brush import BrushSection
from app.inspector.facts import FactsSection
from app.inspector.flags import FlagsSection
from app.inspector.media import MediaSection
from app.inspector.panel import Inspector
from app.inspector.smooth import SmoothSection
from app.inspector.value import ValueSection
from app.live.section import LiveSection
from app.notes.section import NotesSection
from app.pins.section import PinsSection
from app.playback.media import Media
from app.playback.transport import Transport
from app.preview.panel import PreviewPanel
from app.preview.reference import ReferencePanel
from app.retarget.actions import RetargetActions
from app.review.actions import ReviewActions
from app.session import Session
from app.session.edits import Editing
from app.session.flagging import Flagging
from app.session.keeper import Keeper
from app.settings import Settings
from app.spans.filling import Filling
from app.spans.section import SpansSection
from app.timeline.panel import Timeline
from app.widgets.text import PlainText
from app.window.missing import MissingMedia
from app.window.notices import Notices
from app.window.status import StatusBar
from engine.take import Take


class WindowParts(QMainWindow):
    """A window with all its parts, each of which knows the session and no other panel.

    Parameters
    ----------
    take : what is open
    settings : what is remembered
    unsaved : the folder for unsaved work; the user's own without one
    """

    def __init__(self, take: Take, settings: Settings | None, unsaved: Path | None) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.colours = theme.palette(self.settings.theme)
        self.session = Session(take)
        self.keeper = Keeper(self.session, unsaved)
        self.inference = Editing(self.session)
        self.transport = Transport(self.session)
        self.media = Media(self.session, self.transport, settings=self.settings)
        self._make_panels()
        self._make_actions()
        self._make_sections()
        self._plain_text = PlainText(self)
        self._make_menus()

    def _make_panels(self) -> None:
        session = self.session
        self.files = FileActions(session, self.keeper, self.media, self.settings, self)
        self.sound = MediaActions(session, self.media, self)
        self.status = StatusBar(session, self.keeper, self.files.opener.opening, self.media)
        self.notices, self.missing = Notices(), MissingMedia()
        self.importing = ImportLine(session)
        self.preview, self.reference = PreviewPanel(session, self.inference), ReferencePanel(session)
        self.curves = CurvesPanel(session, self.inference, self.colours)
        self.timeline = Timeline(session, self.colours, gutter_px=GUTTER_PX)

    def _make_actions(self) -> None:
        session = self.session
        self.filling = Filling(session)
        self.edits = EditActions(session, self.inference, self.curves, self.filling)
        self.flagging = Flagging(session)
        self.visemes = VisemeActions(session, self.timeline.visemes, self)
        self.time = TimeActions(session, self.transport, self.filling)
        self.views = ViewActions(self.preview)

    def _make_sections(self) -> None:
        session = self.session
        self.brush, self.value = BrushSection(session), ValueSection(session)
        self.pins, self.clean = PinsSection(session, self.inference), CleanSection(session, self.inference)
        self.smoothing, self.facts = SmoothSection(session), FactsSection(session)
        self.spans = SpansSection(session, self.filling)
        self.live = LiveSection(session, self.keeper.folder)
        self.attached, self.notes, self.flags = MediaSection(session), NotesSection(session), FlagsSection(session)
        self.flagged = FlagActions(session, self.flags, self)
        self.marks = MarkActions(session, self.notes, self.spans)
        self.retarget, self.review = RetargetActions(session, self), ReviewActions(session, self.transport, self)
        review = self.review
        sections = (
            *(self.brush, self.value, self.clean, self.live, *self.retarget.sections),
            *(self.smoothing, self.spans, self.pins),  # the pose's sliders last: above Fill they hide it on low screens
            *(review.queue, review.section, review.handing_on),
            *(self.facts, self.flags, self.notes, review.verdict, self.attached),
        )
        self.inspector = Inspector(session, sections)

    def _make_menus(self) -> None:
        self.menus = Menus(self, self.settings, self.do, self.files.load)
        self.actions_by_name = self.menus.actions
        self.preferences = SettingsActions(self.settings, self.menus, self.media, self)
        tools = (self.edits, self.time, self.marks, self.views, self.visemes, self.flagged, self.retarget, self.review)
        owners = (self.files, self.sound, *tools, self.preferences, self)
        self._owners = owners_of((entry.name for entry in ACTIONS), owners)

    def do(self, name: str) -> None:
        """Perform an action of the table."""
        getattr(self._owners[name], name)()
