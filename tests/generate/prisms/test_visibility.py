"""Visibility of triangles, exactly; more of it beside directions in `test_directions`."""

from __future__ import annotations

import numpy as np

from unstruct import Domain
from unstruct.generate.prisms.visibility import visible
from unstruct.generate.prisms.walls import base_of


def test_directions_in_the_plane_of_a_triangle_see_it_not() -> None:
    walls = base_of(Domain.box(), None, "outside").walls
    out = np.sign(walls.points - 0.5)
    assert visible(walls, out).all() and not visible(walls, -out).any()
    for tiny in (1e-17, 1e-300, 5e-324):
        grazing = out.copy()
        grazing[:, 0] *= tiny
        assert visible(walls, grazing).all()
        grazing[3, 0] = 0.0
        assert visible(walls, grazing).tolist() == [v != 3 for v in range(8)]
