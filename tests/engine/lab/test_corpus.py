from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from engine.lab.corpus import SHORTEST, Piece, recorded_seconds, rest_of, split
from engine.lab.performer import demo
from engine.take import SHAPES


def _piece(first: int, frames: int, source: str = "a") -> Piece:
    """A piece whose every weight is the number of its frame."""
    return Piece(np.repeat(np.arange(first, first + frames)[:, None], len(SHAPES), axis=1) * 1.0, True, source, first)


def test_a_card_counts_all_pieces_of_a_take() -> None:
    assert recorded_seconds([_piece(0, 31), _piece(0, 60, "b"), _piece(40, 29)]) == {"a": 2.0, "b": 2.0}


def test_the_rest_of_a_take_is_all_but_the_hole_and_no_other_take() -> None:
    pieces = [_piece(0, 100), _piece(0, 100, "b"), _piece(150, 80)]
    rest = rest_of(pieces, pieces[2], 30, 50)  # frames 180 to 200 of the take
    told = [(int(one[0, 0]), int(one[-1, 0]) + 1) for one in rest]
    assert told == [(0, 100), (150, 180), (200, 230)]


def test_a_rest_too_short_to_tell_of_motion_is_left_out() -> None:
    piece = _piece(0, 3 * SHORTEST)
    assert rest_of([piece], piece, SHORTEST - 1, 2 * SHORTEST + 1) == []
    assert len(rest_of([piece], piece, SHORTEST, 2 * SHORTEST)) == 2


def test_a_take_kept_for_trial_alone_is_in_no_part(tmp_path: Path) -> None:
    shutil.copy(demo.BUNDLED, tmp_path / "slate_3.csv")
    shutil.copy(demo.BUNDLED, tmp_path / "other.csv")
    assert {piece.source for part in split(tmp_path) for piece in part} == {"other"}
