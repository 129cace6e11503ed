"""The actions that change the preview's view; none changes the take."""

from __future__ import annotations

from PySide6.QtCore import QObject

from app.preview.panel import PreviewPanel


class ViewActions(QObject):
    """Each method is an action of the table.

    Parameters
    ----------
    preview : the panel that shows the face
    """

    def __init__(self, preview: PreviewPanel) -> None:
        super().__init__()
        self._preview = preview

    def view_before(self) -> None:
        """See the face as it was recorded."""
        self._preview.show_view("Before")

    def view_after(self) -> None:
        """See the face as edited."""
        self._preview.show_view("After")

    def view_wipe(self) -> None:
        """See the face as recorded left of a line and as edited right of it."""
        self._preview.show_view("Wipe")

    def wipe_left(self) -> None:
        """Move the line between before and after to the left."""
        self._preview.step_wipe(-1)

    def wipe_right(self) -> None:
        """Move the line between before and after to the right."""
        self._preview.step_wipe(1)

    def view_split(self) -> None:
        """See the face as recorded and as edited, side by side."""
        self._preview.show_view("Split")

    def view_difference(self) -> None:
        """See how far each part of the face moved by the edits."""
        self._preview.show_view("Difference")

    def frame_head(self) -> None:
        """Look at the whole head from the front."""
        self._preview.face.frame_head()
