from __future__ import annotations

from types import SimpleNamespace

import pytest

from app.session.sound import SLACK_S, beyond_the_take


def told(*, begins_s: float, sound_s: float, take_s: float = 10.0) -> str:
    document = SimpleNamespace(
        audio=SimpleNamespace(duration_s=sound_s),
        take=SimpleNamespace(duration_s=take_s),
        offset_s=lambda kind: {"audio": begins_s}[kind],
    )
    return beyond_the_take(SimpleNamespace(document=document))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("begins_s", "sound_s", "sentence"),
    [
        (0.0, 10.0, ""),
        (2.0, 3.0, ""),
        (-SLACK_S, 10.0 + 2 * SLACK_S, ""),
        (-0.2, 5.0, "The sound begins 0.2 s before the take; that is not heard."),
        (8.0, 5.0, "The sound goes on 3.0 s after the take's end; that is not heard."),
        (
            -1.0,
            14.0,
            "The sound begins 1.0 s before the take and goes on 3.0 s after the take's end; that is not heard.",
        ),
        (-20.0, 5.0, "The sound begins 5.0 s before the take; that is not heard."),
        (30.0, 5.0, "The sound goes on 5.0 s after the take's end; that is not heard."),
        (-59.9, 65.0, "The sound begins 59.9 s before the take; that is not heard."),
        (-125.0, 130.0, "The sound begins 2 min 05 s before the take; that is not heard."),
        (-60.0, 65.0, "The sound begins 1 min 00 s before the take; that is not heard."),
    ],
)
def test_what_lies_beyond_the_take_is_told_with_its_length(begins_s: float, sound_s: float, sentence: str) -> None:
    assert told(begins_s=begins_s, sound_s=sound_s) == sentence


def test_without_sound_nothing_is_told() -> None:
    assert beyond_the_take(SimpleNamespace(document=SimpleNamespace(audio=None))) == ""  # type: ignore[arg-type]
