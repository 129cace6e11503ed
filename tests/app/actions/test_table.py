from __future__ import annotations

from collections import Counter

import pytest

from app.actions.edit import EditActions
from app.actions.file import FileActions
from app.actions.media import MediaActions
from app.actions.settings import SettingsActions
from app.actions.table import ACTIONS, MENUS, TOOLBAR, keys_of
from app.actions.time import TimeActions
from app.actions.viseme import VisemeActions
from app.retarget.actions import RetargetActions
from app.review.actions import ReviewActions
from app.settings import PRESETS
from app.window.main_window import MainWindow

OWNERS = (
    MainWindow,
    FileActions,
    MediaActions,
    EditActions,
    TimeActions,
    VisemeActions,
    RetargetActions,
    ReviewActions,
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
