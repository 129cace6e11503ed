from __future__ import annotations

from collections import Counter

from app.actions import ACTIONS, MENUS, TOOLBAR
from app.main_window import MainWindow


def test_no_shortcut_stands_twice() -> None:
    keys = Counter(key.lower() for entry in ACTIONS for key in entry.keys)
    assert [key for key, count in keys.items() if count > 1] == []


def test_each_action_can_be_done_has_a_menu_and_a_twin_or_a_reason() -> None:
    for entry in ACTIONS:
        assert callable(getattr(MainWindow, entry.name)), entry.name
        assert entry.menu in MENUS
        assert entry.twin


def test_the_toolbar_shows_actions_with_a_short_text() -> None:
    shorts = {entry.name: entry.short for entry in ACTIONS}
    assert all(shorts[name] for group in TOOLBAR for name in group)
