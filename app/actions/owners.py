"""Which object carries out which action of the table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def owners_of(names: Iterable[str], owners: Sequence[object]) -> dict[str, object]:
    """Return the owner of each action: the first that has a method of its name.

    Raises `LookupError` for an action that nobody carries out, so that a window with one does not open.
    """
    found = {}
    for name in names:
        owner = next((each for each in owners if callable(getattr(each, name, None))), None)
        if owner is None:
            raise LookupError(f"no part of the window carries out {name!r}")
        found[name] = owner
    return found
