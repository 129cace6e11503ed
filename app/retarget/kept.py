"""The heads that kept retargets put the take on, by their files and by what was corrected when they were read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from app.retarget.carry import Target, opened
from app.session import Session
from engine.character import Character
from engine.formats.characters.reading import Reading


class KeptHeads:
    """Puts the take on the head of a kept retarget; reads it where it is not known yet.

    Parameters
    ----------
    session : whose take it is
    submit : has work done off the GUI thread and hands on what it returns
    found : is called when a head was read
    """

    def __init__(
        self,
        session: Session,
        submit: Callable[[Callable[[], Any], Callable[[Any], None]], None],
        found: Callable[[], None],
    ) -> None:
        self._session, self._submit, self._found = session, submit, found
        self.forget()

    def forget(self) -> None:
        """Know the bundled head alone, as in a program that was just started."""
        self._heads: dict[tuple[str, str], Character | None] = {_key({}): None}

    def know(self, inputs: Mapping[str, Any], head: Character | None) -> None:
        """Remember the head of a retarget by what the edit stores; None is the bundled one."""
        self._heads[_key(inputs)] = head

    def follow(self, inputs: Mapping[str, Any]) -> None:
        """Show the take on the head of the edit that stores these inputs."""
        key = _key(inputs)
        if key not in self._heads:
            self._heads[key] = None  # where it cannot be read, once is enough
            path, reading = Path(key[0]), Reading.restored(inputs.get("reading"))
            self._submit(lambda: opened(path, reading), lambda target: self._take(key, target))
        elif self._heads[key] is not self._session.document.character:
            self._session.document.play_on(self._heads[key])

    def _take(self, key: tuple[str, str], target: Target) -> None:
        self._heads[key] = target.head
        self._found()


def _key(inputs: Mapping[str, Any]) -> tuple[str, str]:
    reading = Reading.restored(inputs.get("reading")).stored()
    return str(inputs.get("target", "")), json.dumps(reading, sort_keys=True)
