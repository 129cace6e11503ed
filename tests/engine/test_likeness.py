from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from engine.errors import AssetError
from engine.likeness import MOUTH, recorded, recorded_of
from engine.regress.prior import bundled_prior


def test_the_distance_is_that_of_the_learned_prior() -> None:
    """The same as joint limits of a drag are taken by: of the whitened controls, and of the furthest recorded face."""
    prior, known = bundled_prior(), recorded()
    mean, whiten, furthest = prior.ball(MOUTH, 1.0)
    plain = np.linalg.norm((prior.faces[:, MOUTH] - mean) @ whiten.T, axis=1)
    np.testing.assert_allclose(known.distance(prior.faces), plain, atol=1e-5)
    assert known.furthest == pytest.approx(furthest, abs=1e-5) and len(known.distances) == len(prior.faces)


def test_the_share_that_is_nearer_is_counted() -> None:
    known = recorded_of(np.random.default_rng(0).normal(size=(500, 16)))
    distances = known.distances
    assert known.nearer(0.0) == 0.0 and known.nearer(distances[-1] + 1) == 1.0
    assert known.nearer(float(np.median(distances))) == pytest.approx(0.5, abs=0.01)


def test_rows_are_measured_alike_wherever_they_stand() -> None:
    faces = np.random.default_rng(1).normal(size=(400, 16)) * 5
    known = recorded()
    parts = [known.distance(faces[start : start + 7]) for start in range(0, 400, 7)]
    np.testing.assert_array_equal(np.concatenate(parts), known.distance(faces))


@pytest.mark.parametrize("content", [None, b"", b"\x08" + b"\0" * 7 + b"{}      ", b"no model"])
def test_a_missing_or_damaged_prior_is_a_sentence(tmp_path: Path, content: bytes | None) -> None:
    if content is not None:
        (tmp_path / "prior.safetensors").write_bytes(content)
    with pytest.raises(AssetError, match="missing or damaged"):
        recorded(tmp_path)
