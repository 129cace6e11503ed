from __future__ import annotations

from collections import Counter

import pytest

from app.actions import ACTIONS, MENUS, PRESETS, TOOLBAR, keys_of
from app.edit_actions import EditActions
from app.file_actions import FileActions
from app.main_window import MainWindow
from app.media_actions import MediaActions
from app.retarget.actions import RetargetActions
from app.settings_actions import SettingsActions
from app.time_actions import TimeActions
from app.viseme_actions import VisemeActions

OWNERS = (
    MainWindow,
    FileActions,
    MediaActions,
    EditActions,
    TimeActions,
    VisemeActions,
    RetargetActions,
    SettingsActions,
)


@pytest.mark.parametrize("preset", list(PRESETS))
def test_no_shortcut_stands_twice(preset: str) -> None:
    assert set(PRESETS[preset]) <= {entry.name for entry in ACTIONS}
    keys = Counter(key.lower() for entry in ACTIONS for key in keys_of(entry, preset))
    assert [key for key, count in keys.items() if count > 1] == []


def test_each_action_can_be_done_has_a_menu_and_a_twin_or_a_reason() -> None:
    for entry in ACTIONS:
        assert sum(entry.name in vars(owner) for owner in OWNERS) == 1, entry.name
        assert entry.menu in MENUS
        assert entry.twin


def test_the_toolbar_shows_actions_with_a_short_text() -> None:
    shorts = {entry.name: entry.short for entry in ACTIONS}
    assert all(shorts[name] for group in TOOLBAR for name in group)
