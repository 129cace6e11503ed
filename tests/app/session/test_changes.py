from __future__ import annotations

from app.session.changes import Change


def test_each_kind_of_change_is_a_bit_of_its_own() -> None:
    values = [change.value for change in Change]
    assert sorted(values) == [1 << bit for bit in range(len(values))]
    assert not Change.CURVES & Change.DRAFT and Change.TAKE & (Change.TAKE | Change.CHARACTER)
