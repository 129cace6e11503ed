from __future__ import annotations

from pathlib import Path

import pytest

from app.session.keeping import as_unsaved_work
from engine.errors import FormatError


def test_an_error_speaks_of_unsaved_work_and_keeps_its_advice() -> None:
    path = Path("folder") / "20250102-030405-77.retake"
    with pytest.raises(FormatError.__bases__[0]) as told, as_unsaved_work(path):
        raise FormatError(f"{path.name} is full.", "Save it elsewhere.")
    assert (told.value.sentence, told.value.advice) == ("unsaved work is full.", "Save it elsewhere.")
    assert isinstance(told.value.__cause__, FormatError)


def test_what_is_no_sentence_of_ours_passes() -> None:
    with pytest.raises(ZeroDivisionError), as_unsaved_work(Path("a")):
        raise ZeroDivisionError
    with as_unsaved_work(Path("a")):
        pass
