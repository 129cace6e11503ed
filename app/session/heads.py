"""The heads that a take can be shown on: reading them, and following the head of the last kept retarget."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.session.session import Session
from engine.character import Character
from engine.formats.characters.reading import Reading

if TYPE_CHECKING:
    from engine.formats.characters.assemble import Import


@dataclass(frozen=True, eq=False)
class HeadFile:
    """A head that was read from a file.

    Attributes
    ----------
    head : the head, named after its file
    imported : the meaning of its file's shapes, and its frame; None for a head of ours
    """

    head: Character
    imported: Import | None = None


def read_head(path: Path, reading: Reading) -> HeadFile:
    """Return the head of a file, a folder or the name `second`, read as corrected; raises `EngineError`."""
    from engine.formats.characters.opening import character_of, is_own, title_of
    from engine.formats.characters.reading import import_head

    if is_own(path):
        return HeadFile(replace(character_of(path), name=title_of(path)))
    imported = import_head(path, reading)
    return HeadFile(replace(imported.character, name=title_of(path)), imported)


class KeptHeads:
    """Sets the head of a kept retarget as the take's; reads its file where it is not known yet.

    Parameters
    ----------
    session : whose take it is
    submit : runs work off the GUI thread and passes its result on
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
        """Set the head of the edit that stores these inputs as the take's, and show it."""
        key = _key(inputs)
        if key not in self._heads:
            self._heads[key] = None  # where it cannot be read, once is enough
            path, reading = Path(key[0]), Reading.restored(inputs.get("reading"))
            self._submit(lambda: read_head(path, reading), lambda read: self._remember(key, read))
        elif self._heads[key] is not self._session.document.character:
            self._session.play_on(self._heads[key])

    def _remember(self, key: tuple[str, str], read: HeadFile) -> None:
        self._heads[key] = read.head
        self._found()


def _key(inputs: Mapping[str, Any]) -> tuple[str, str]:
    reading = Reading.restored(inputs.get("reading")).stored()
    return str(inputs.get("target", "")), json.dumps(reading, sort_keys=True)
