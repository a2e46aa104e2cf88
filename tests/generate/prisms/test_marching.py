"""Rays whose directions are computed anew on each layer."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, Layers, check, prismatic_layers
from unstruct.generate.prisms.heights import placed
from unstruct.generate.prisms.marching import marched
from unstruct.generate.prisms.walls import base_of


def test_equal_directions_give_straight_rays() -> None:
    walls = base_of(Domain.box(), None, "outside").walls
    first, height = np.sqrt(1 / 3) * np.sign(walls.points - 0.5), np.full(8, 0.5)
    height[2] = 0.0
    shares = np.array([[0.0, 0.3, 1.0]])
    found = marched(walls, lambda w: (first, np.ones(8, dtype=bool)), first, height, shares)
    assert found == pytest.approx(placed(walls.points, first, height, shares), abs=1e-15)
    unseen = marched(walls, lambda w: (np.zeros((8, 3)), np.zeros(8, dtype=bool)), first, height, shares)
    assert (unseen == found).all()


def test_recomputed_layers_are_valid() -> None:
    rng = np.random.default_rng(5)
    shell = Domain.ball(size=0.4).triangulated
    rough = Domain(shell.points * (1 + 0.1 * rng.standard_normal((len(shell.points), 1))), shell.triangles)
    for side in ("inside", "outside"):
        layers = Layers(thickness=0.3, growth=1.1, count=6)
        bent = prismatic_layers(rough, layers=layers, side=side, recompute=True)
        straight = prismatic_layers(rough, layers=layers, side=side)
        assert check(bent) and check(straight)
        assert (bent.points != straight.points).any()
