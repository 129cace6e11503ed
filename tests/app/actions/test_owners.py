from __future__ import annotations

import pytest

from app.actions.owners import owners_of


class First:
    def both(self) -> None: ...

    field = 3


class Second:
    def both(self) -> None: ...

    def field(self) -> None: ...


def test_the_first_that_has_such_a_method_carries_an_action_out() -> None:
    owners = First(), Second()
    assert owners_of(("both", "field"), owners) == {"both": owners[0], "field": owners[1]}


def test_an_action_that_nobody_carries_out_is_found_at_the_start() -> None:
    with pytest.raises(LookupError, match="fly"):
        owners_of(("fly",), (First(), Second()))
