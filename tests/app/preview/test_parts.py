from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.preview.parts import eyeballs, part_of, shell_and_rest
from engine.character import bundled


def test_the_bundled_head_is_split_into_its_parts() -> None:
    head = bundled()
    part = part_of(head)
    assert (part[head.triangles] == part[head.triangles[:, :1]]).all()  # no triangle joins two
    wet = eyeballs(head, part)
    assert len(np.unique(part[wet])) == 2
    sides = [head.neutral[wet[part[wet] == label], 0].mean() for label in np.unique(part[wet])]
    assert min(sides) < -20 and max(sides) > 20  # mm; one eye on either side
    shell, rest = shell_and_rest(head, part)
    assert len(shell) + len(rest) == len(head.triangles)
    assert not np.isin(wet, shell).any()


def test_balls_of_another_size_are_no_eyes() -> None:
    head = bundled()
    small = replace(head, neutral=head.neutral * np.float32(0.4))
    assert len(eyeballs(small, part_of(small))) == 0
