"""Where the source's markers are on the target: chosen one by one, placed by clicks, read and written."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from app.retarget.retargeting import Retargeting
from app.retarget.target import Target, with_markers, with_place
from engine.formats.markers import layout as markers_layout


class Placing:
    """Changes the target's markers, each change one undo step.

    Parameters
    ----------
    retargeting : whose target it is

    Attributes
    ----------
    chosen : the marker that the next click on the target places
    """

    def __init__(self, retargeting: Retargeting) -> None:
        self._retargeting = retargeting
        self._chosen = ""

    @property
    def chosen(self) -> str:
        """The marker that the next click on the target places; empty where there is none."""
        return self._chosen if self._chosen in self._retargeting.names else ""

    def choose(self, name: str) -> None:
        """Let the next click on the target place a marker."""
        self._chosen = name
        self._retargeting.changed.emit()

    def place(self, vertex: int) -> None:
        """Put the chosen marker on a vertex, and choose the next that has no place yet."""
        state, name = self._retargeting, self.chosen
        if state.target.head is None or not name:
            return
        new = name not in state.target.places
        state.change_target(with_place(state.target, name, vertex), f"place {name}")
        if new:
            self.choose(next((each for each in state.names if each not in state.target.places), name))

    def unplace(self) -> None:
        """Take the chosen marker off the target."""
        state, name = self._retargeting, self.chosen
        if name in state.target.places:
            state.change_target(with_place(state.target, name, None), f"remove {name}")

    def mean(self, landmark: str) -> None:
        """Say which landmark the chosen marker is, or with nothing that it is left out; the others are placed anew."""
        state, name = self._retargeting, self.chosen
        capture, target = state.capture, state.target
        if capture is None or not name or target.markers.landmarks.get(name, "") == landmark != "":
            return
        free = replace(target, by_hand=target.by_hand - {name})

        def work() -> Target:
            return with_markers(free, capture, target.markers.corrected({name: landmark}))

        title = f"set {name} to {landmark}" if landmark else f"leave {name} out"
        state.submit(work, lambda changed: state.change_target(changed, title))

    def place_rest(self) -> None:
        """Let the markers that were not placed by hand follow those that were."""
        from engine.formats.characters.placing import place_rest

        state = self._retargeting
        performance, target, head = state.performance, state.target, state.target.head
        if head is None:
            return

        def work() -> Target:
            source = performance.source
            given = {name: target.places[name] for name in source.names if name in target.by_hand}
            return replace(target, places=place_rest(source.neutral, source.names, head, given))

        state.submit(work, lambda placed: state.change_target(placed, "place the other markers"))

    def read(self, path: Path) -> None:
        """Read where the markers are from a landmark file; raises `EngineError`."""
        state = self._retargeting
        if state.target.head is not None:
            places = markers_layout.read(path, head=state.target.head)
            target = replace(state.target, places=places, by_hand=frozenset(places))
            state.change_target(target, f"read {path.name}")

    def write(self, path: Path) -> None:
        """Write where the markers are to a landmark file; raises `EngineError`."""
        target = self._retargeting.target
        if target.head is not None:
            markers_layout.write(target.places, path, head=target.head)
