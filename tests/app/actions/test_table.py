from __future__ import annotations

from collections import Counter

import pytest

from app.actions.edit import EditActions
from app.actions.file import FileActions
from app.actions.flags import FlagActions
from app.actions.marks import MarkActions
from app.actions.media import MediaActions
from app.actions.settings import SettingsActions
from app.actions.table import ACTIONS, CONTEXT, MENUS, TOOLBAR, all_keys, keys_of
from app.actions.time import TimeActions
from app.actions.view import ViewActions
from app.actions.viseme import VisemeActions
from app.retarget.actions import RetargetActions
from app.review.actions import ReviewActions
from app.settings import PRESETS
from app.window.main_window import MainWindow

OWNERS = (
    MainWindow,
    FileActions,
    FlagActions,
    MediaActions,
    EditActions,
    TimeActions,
    MarkActions,
    ViewActions,
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


def test_context_menus_offer_actions_of_the_table_each_once() -> None:
    names = {entry.name for entry in ACTIONS}
    assert set(CONTEXT) >= {"face", "curve", "lane", "label", "span", "flag", "note", "pin"}
    for kind, listed in CONTEXT.items():
        offered = [name for name in listed if name]
        assert set(offered) <= names and len(offered) == len(set(offered)), kind
        assert listed[0] and listed[-1], kind


@pytest.mark.parametrize("preset", list(PRESETS))
def test_space_and_k_play_in_every_preset_of_an_editor_of_sound_or_film(preset: str) -> None:
    keys = all_keys(preset, {})
    assert "Space" in keys["play"]
    if preset in ("Retake", "Premiere / Resolve", "Audacity"):
        assert ("K" in keys["play"], "J" in keys["play_backwards"], "L" in keys["play_forwards"]) == (True, True, True)


@pytest.mark.parametrize("preset", list(PRESETS))
def test_keys_of_ones_own_are_taken_from_the_preset_s_action(preset: str) -> None:
    own = {"smooth": ("V",), "drag_tool": (), "no such action": ("Q",)}
    keys = all_keys(preset, own)
    assert keys["smooth"] == ("V",) and keys["drag_tool"] == () and set(keys) == {entry.name for entry in ACTIONS}
    assert [name for name, has in keys.items() if "V" in has] == ["smooth"]
