"""The line that says how a take was read, and reads it otherwise: each choice is a step that can be undone."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QComboBox, QFrame, QHBoxLayout, QSizePolicy, QToolButton

from app.session import Change, Session
from app.session.commands import ReadingCommand
from app.theme import GRID
from app.widgets.text import Label, Name, tip
from engine.errors import EngineError
from engine.formats import livelink
from engine.formats.base.reading import AUTOMATIC, SIDES, SIDES_IN_WORDS, ReadAs, Reading
from engine.formats.livelink.importing import Imported, in_words
from engine.words import NAME_LENGTH, plain

RATES = ("23.976", "24", "25", "29.97", "30", "48", "50", "59.94", "60", "120")
RATE_PX, SIDES_PX = 132, 230
HIDE = "Hide this line; File, How this take was read shows it again"


class ImportLine(QFrame):
    """Rate, sides and what was noticed of the open take.

    Parameters
    ----------
    session : whose take
    """

    refused = Signal(str, str)  # sentence, advice
    chosen = Signal()  # the keys belong to the curves again

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.setProperty("panel", True)
        self._session = session
        self._imported: Imported | None = None
        self.name, self.rate_reason, self.sides_reason = Name(longest=NAME_LENGTH // 2), _quiet(), _quiet()
        self.rate, self.sides = _Choice(), _Choice()
        self.rate.setEditable(True)
        self.rate.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.rate.setFixedWidth(RATE_PX)
        self.sides.setFixedWidth(SIDES_PX)
        self.notices = _Elided()
        self.hide_button = QToolButton()
        self.hide_button.setText("×")
        self.hide_button.setToolTip(HIDE)
        self.hide_button.setAccessibleName("Hide")
        self.hide_button.clicked.connect(self.hide)
        self._lay_out()
        self.rate.activated.connect(self._choose_rate)
        typed = self.rate.lineEdit()
        assert typed is not None  # it is editable
        typed.editingFinished.connect(self._type_rate)
        self.sides.activated.connect(self._choose_sides)
        session.changed.connect(self._on_change)
        self.hide()

    def _lay_out(self) -> None:
        row = QHBoxLayout(self)
        row.setContentsMargins(GRID + 2, 3, GRID - 4, 3)
        row.setSpacing(GRID)
        row.addWidget(self.name)
        for title, choice, reason in (
            ("Rate", self.rate, self.rate_reason),
            ("Sides", self.sides, self.sides_reason),
        ):
            row.addSpacing(GRID)
            label = _quiet(title)
            label.setBuddy(choice)
            choice.setAccessibleName(title)
            for widget in (label, choice, reason):
                row.addWidget(widget)
        row.addSpacing(GRID)
        row.addWidget(self.notices, 1)
        row.addWidget(self.hide_button)

    def show_reading(self, imported: Imported | None, *, shown: bool) -> None:
        """Say what the file of the open take says of itself, and show it where there is anything."""
        self._imported = imported
        self._show()
        self.setVisible(shown and imported is not None)

    @property
    def there(self) -> bool:
        """Whether there is anything to say of the open take."""
        return self._imported is not None

    # --- showing

    def _on_change(self, change: Change) -> None:
        if change & Change.TAKE:
            self.show_reading(None, shown=False)
        elif change & Change.READING:
            self._show()

    def _show(self) -> None:
        if self._imported is None:
            return
        take, reading = self._session.document.take, self._session.document.reading
        first = livelink.read_as(self._session.document.recorded)
        self.name.setText(take.name)
        with QSignalBlocker(self.rate), QSignalBlocker(self.sides):
            self.rate.clear()
            self.rate.addItems([f"automatic: {first.fps:.5g}", *RATES])
            self.rate.setEditText(f"{take.fps:.5g} fps")
            self.sides.clear()
            self.sides.addItem(f"automatic: {in_words(first.swapped)}")
            self.sides.addItems([SIDES_IN_WORDS[sides] for sides in SIDES[1:]])
            self.sides.setCurrentIndex(SIDES.index(reading.chosen.sides))
        rate = self._imported.rate_reason(take.fps, reading.chosen)
        self.rate_reason.setText(rate.partition(" that ")[0].partition(";")[0])
        sides = self._imported.sides_reason(swapped=reading.swapped)
        self.sides_reason.setText(self._confidence(sides))
        for widget, text in (
            (self.rate, rate),
            (self.rate_reason, rate),
            (self.sides, sides),
            (self.sides_reason, sides),
        ):
            widget.setToolTip(f"{text[0].upper()}{text[1:]}.")
        self.notices.show_sentences(take.notices)

    def _confidence(self, reason: str) -> str:
        judged = self._imported.judged if self._imported is not None else None
        if judged is None or judged.agreement is None:
            return "no motion to tell by"
        return reason.partition(";")[0] if reason.startswith("as asked") else judged.confidence

    # --- choosing

    def _choose_rate(self, index: int) -> None:
        self._ask_rate(None if index == 0 else self.rate.itemText(index))

    def _type_rate(self) -> None:
        text = self.rate.currentText()
        if text not in (f"{self._session.document.take.fps:.5g} fps", self.rate.itemText(0)):
            self._ask_rate(text)

    def _ask_rate(self, text: str | None) -> None:
        chosen = self._session.document.reading.chosen
        try:
            fps = None if text is None else float(text.lower().removesuffix("fps").strip().replace(",", "."))
            self._read(Reading(fps, chosen.sides))
        except ValueError:
            self.refused.emit(f"{text!r:.40} is not a frame rate.", "Type a number, such as 30 or 29.97.")
        except EngineError as error:
            self.refused.emit(error.sentence, error.advice)
        self._show()
        self.chosen.emit()

    def _choose_sides(self, index: int) -> None:
        self._read(Reading(self._session.document.reading.chosen.fps, SIDES[index]))
        self.chosen.emit()

    def _read(self, chosen: Reading) -> None:
        """Read the take as chosen, as one step; nothing where it is read so already."""
        now, first = self._session.document.reading, livelink.read_as(self._session.document.recorded)
        if chosen == now.chosen:
            return
        swapped = first.swapped if chosen.sides == AUTOMATIC.sides else chosen.sides == "recorded"
        wanted = ReadAs(chosen, chosen.fps or first.fps, swapped)
        words = SIDES_IN_WORDS[chosen.sides]
        title = f"sides {words}" if chosen.sides != now.chosen.sides else f"rate {wanted.fps:.5g} fps"
        self._session.document.undo.push(ReadingCommand.of(self._session.document, wanted, title))


class _Choice(QComboBox):
    """A list to choose from that a turn of the wheel over it does not change."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Leave the wheel to what lies around."""
        event.ignore()


class _Elided(Label):
    """Sentences in one line, cut off at its end; the tip has all of them."""

    def __init__(self) -> None:
        super().__init__()
        self._text = ""
        self.setProperty("quiet", True)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def show_sentences(self, sentences: Sequence[str]) -> None:
        """Show sentences."""
        self._text = plain(" ".join(sentences))
        self.setToolTip(tip("\n".join(sentences)))
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show more or less of them."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        self.ensurePolished()  # the style sheet's font is not there before
        self.setText(self.fontMetrics().elidedText(self._text, Qt.TextElideMode.ElideRight, self.width()))


def _quiet(text: str = "") -> Label:
    label = Label(text)
    label.setProperty("quiet", True)
    return label
