"""Split vertices become one, and every vertex of the file is still known."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engine.character import bundled, load, save
from engine.formats.characters.assemble import assemble
from engine.formats.characters.colouring import colours_of
from engine.formats.characters.raw import RawCharacter
from engine.formats.characters.weld import welded
from engine.mesh import parts_of
from engine.take import SHAPES


def own() -> RawCharacter:
    head = bundled()
    shapes = dict(zip(SHAPES, head.deltas, strict=True))
    return RawCharacter("own", head.neutral.astype(float), head.triangles, shapes)


def flat(raw: RawCharacter, triangles: np.ndarray | None = None) -> RawCharacter:
    """Give each of some faces vertices of its own, as a flat-shaded export does; all of them by default."""
    corners = (raw.triangles if triangles is None else triangles).ravel()
    shapes = {name: delta[corners] for name, delta in raw.shapes.items()}
    return replace(
        raw,
        vertices=raw.vertices[corners],
        triangles=np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
        shapes=shapes,
    )


def test_a_flat_shaded_head_is_read_as_the_smooth_one() -> None:
    made, smooth = assemble(welded(flat(own()))).character, assemble(own()).character
    used = np.unique(smooth.triangles)
    assert len(made.neutral) == len(used)
    np.testing.assert_array_equal(made.neutral[made.split], smooth.neutral[smooth.triangles.ravel()])
    np.testing.assert_array_equal(made.deltas[:, made.split], smooth.deltas[:, smooth.triangles.ravel()])
    for name, vertex in smooth.landmarks.items():
        np.testing.assert_array_equal(made.neutral[made.landmarks[name]], smooth.neutral[vertex], err_msg=name)
    parts = parts_of(made.triangles, len(made.neutral))
    assert len(np.unique(parts)) == len(np.unique(parts_of(smooth.triangles, len(smooth.neutral))[used]))


def test_a_seam_is_closed_and_a_smooth_head_is_left_as_it_is() -> None:
    raw = own()
    assert welded(raw) is raw
    left = raw.vertices[raw.triangles].mean(axis=1)[:, 0] > 0
    number = np.arange(len(raw.vertices))
    seam = np.intersect1d(raw.triangles[left], raw.triangles[~left])
    number[seam] = len(number) + np.arange(len(seam))  # the left half has vertices of its own along the middle
    triangles = raw.triangles.copy()
    triangles[left] = number[triangles[left]]
    cut = replace(
        raw,
        vertices=np.concatenate([raw.vertices, raw.vertices[seam]]),
        triangles=triangles,
        shapes={name: np.concatenate([delta, delta[seam]]) for name, delta in raw.shapes.items()},
    )
    whole = welded(cut)
    assert len(whole.vertices) == len(raw.vertices) and len(whole.split) == len(cut.vertices)
    np.testing.assert_array_equal(whole.vertices[whole.split], cut.vertices)


def test_lips_that_touch_stay_two_where_they_move_apart_or_are_no_rim() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    both = RawCharacter("lips", np.concatenate([square, square]), np.concatenate([faces, faces + 4]), {})
    assert len(welded(both).vertices) == 4
    apart = np.zeros((8, 3), np.float32)
    apart[4:, 1] = -0.5
    assert welded(replace(both, shapes={"jawOpen": apart})).vertices.shape == (8, 3)
    fan = np.array([[4, 0, 1], [4, 1, 2], [4, 2, 3], [4, 3, 0]], np.int32)  # closed about its middle
    domes = np.concatenate([square, [[0.5, 0.5, 0.5]]])
    turned = np.concatenate([square + np.array([0, 0, 1]), [[0.5, 0.5, 0.5]]])
    touching = RawCharacter("domes", np.concatenate([domes, turned]), np.concatenate([fan, fan + 5]), {})
    assert welded(touching) is touching


def test_the_map_is_kept_in_a_file_and_leads_back_to_the_file_s_vertices(tmp_path: Path) -> None:
    raw = flat(own())
    made = assemble(welded(raw), landmarks={"chin": 300}).character
    assert made.landmarks["chin"] == made.split[300] == made.vertex_of(300)
    save(made, tmp_path / "head.npz")
    again = load(tmp_path / "head.npz")
    np.testing.assert_array_equal(again.split, made.split)
    np.testing.assert_array_equal(again.triangles_in_file, raw.triangles)
    posed = again.vertices(np.full(len(SHAPES), 0.3))
    file = again.as_in_file(posed)
    assert file.shape == raw.vertices.shape
    corners = bundled().triangles.ravel()
    for vertex in np.unique(corners)[::500]:  # no seam tears: what was one place moves as one
        assert not np.ptp(file[corners == vertex], axis=0).any()


@pytest.mark.parametrize("split", [np.array([0, 1, 99999999], np.int32), np.zeros((2, 2), np.int32)])
def test_a_map_that_leads_nowhere_is_refused(split: np.ndarray, tmp_path: Path) -> None:
    from engine.errors import AssetError

    made = assemble(welded(flat(own()))).character
    save(replace(made, split=split), tmp_path / "head.npz")
    with pytest.raises(AssetError):
        load(tmp_path / "head.npz")


def test_colouring_many_parts_costs_memory_by_vertex_not_by_part() -> None:
    raw = flat(own())
    landmarks = {
        name: int(np.flatnonzero(bundled().triangles.ravel() == v)[0]) for name, v in bundled().landmarks.items()
    }
    tracemalloc.start()
    colours_of(raw.vertices, raw.triangles, landmarks)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1_000 * len(raw.vertices)  # a mask for each of 21,000 parts took 21,000 bytes for each vertex


def test_eyes_that_touch_other_parts_at_their_rims_keep_their_colours() -> None:
    raw, smooth = own(), assemble(own()).character
    parts = parts_of(raw.triangles, len(raw.vertices))
    eye = np.flatnonzero(parts == parts[np.argmax((smooth.colours == smooth.colours.min(axis=0)).all(axis=1))])
    rim = eye[np.argmin(raw.vertices[eye, 2])]
    other = np.array([raw.vertices[rim], raw.vertices[rim] + [0, 0, -5], raw.vertices[rim] + [0, -5, -5]])
    shapes = {
        name: np.concatenate([delta, np.repeat(delta[rim, None], 3, axis=0)]) for name, delta in raw.shapes.items()
    }
    more = np.arange(3, dtype=np.int32)[None] + len(raw.vertices)
    touching = replace(
        raw,
        vertices=np.concatenate([raw.vertices, other]),
        triangles=np.concatenate([raw.triangles, more]),
        shapes=shapes,
    )
    made = assemble(welded(touching))
    assert len(made.character.split)
    np.testing.assert_array_equal(made.character.colours[made.character.split[eye]], smooth.colours[eye])
