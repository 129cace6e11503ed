"""The house is as ARCHITECTURE.md draws it, and no room grows too long."""

from __future__ import annotations

import re

from tests import house


def test_the_picture_is_the_one_that_the_imports_draw() -> None:
    page = (house.ROOT / "ARCHITECTURE.md").read_text()
    shown = page[page.index(house.BEGIN) + len(house.BEGIN) : page.index(house.END)]
    assert shown == house.picture(house.reduced(house.rooms())), "python -m tests.house --write"


def test_every_file_that_the_page_names_is_there() -> None:
    page = (house.ROOT / "ARCHITECTURE.md").read_text()
    named = {
        name
        for name in re.findall(r"`((?:app|engine|tests|assets)/[\w/.]+)", page)
        if "<" not in name and "/x/" not in name
    }
    assert len(named) > 30
    assert [name for name in sorted(named) if not (house.ROOT / name).exists()] == []


def test_arrows_that_follow_from_others_are_left_out_and_those_into_a_circle_stay() -> None:
    assert house.reduced({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {"a": {"b"}, "b": {"c"}, "c": set()}
    circle = {"a": {"b", "c"}, "b": {"c"}, "c": {"b", "d"}, "d": set()}
    assert house.reduced(circle) == circle
    assert house.reduced(circle | {"a": {"b", "c", "d"}})["a"] == {"b", "c"}


def test_no_file_is_too_long() -> None:
    paths = house.modules(house.ROOT, ("app", "engine")).values()
    assert [str(path) for path in paths if path.read_text().count("\n") > house.LONG_FILE] == []


def test_the_program_imports_no_method() -> None:
    assert "imports of methods in app: 1 ['app.cli.training" in house.figures()
