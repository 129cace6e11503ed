from __future__ import annotations

import pytest

from app.actions.owners import owners_of


class First:
    def both(self) -> None: ...

    field = 3


class Second:
    def both(self) -> None: ...

    def field(self) -> None: ...


def test_an_action_belongs_to_the_first_owner_with_its_method() -> None:
    owners = First(), Second()
    assert owners_of(("both", "field"), owners) == {"both": owners[0], "field": owners[1]}


def test_an_action_without_an_owner_is_found_at_the_start() -> None:
    with pytest.raises(LookupError, match="fly"):
        owners_of(("fly",), (First(), Second()))
