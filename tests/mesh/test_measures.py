"""Volumes of cells of all kinds at all scales."""

from __future__ import annotations

import numpy as np
import pytest
from mixed_cells import GOOD, cloud

from unstruct import Mesh


@pytest.mark.parametrize("kind", sorted(GOOD))
def test_volumes_at_any_scale(kind: str) -> None:
    """Scaling by powers of two changes no digit, and what overflows is infinite without a warning."""
    corners = np.array([GOOD[kind]], dtype=float)
    d = corners.shape[2]
    wanted = cloud(kind, corners).volumes
    with np.errstate(all="raise"):
        for powers in ([600, 200, 0], [330, 330, 330], [-300, -300, -300]):
            scale = np.ldexp(1.0, powers[:d])
            assert cloud(kind, corners * scale).volumes.tolist() == (wanted * np.prod(scale)).tolist()
    for powers in ([1000] * 3, [-1000] * 3):
        with np.errstate(all="raise", under="ignore"):
            mesh = cloud(kind, corners * np.ldexp(1.0, powers[:d]))
            assert mesh.volume == (np.inf if powers[0] > 0 else 0)
            assert mesh.summary()["volume"] == mesh.volume


def test_a_sum_of_volumes_that_overflows_is_infinite() -> None:
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * np.ldexp(1.0, 511)
    mesh = Mesh(np.vstack([corners] * 8), cells={"quad": np.arange(32).reshape(8, 4)})
    assert np.isfinite(mesh.volumes).all() and mesh.volume == np.inf
