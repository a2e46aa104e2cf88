"""Which cells are inside when facets are missing."""

from __future__ import annotations

import numpy as np
from solids import cube

from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.flood import is_flat


def test_flat_cells() -> None:
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    cells = np.stack([corner, corner * [1, 1, 1e-8], corner * 1e-5, corner * [1, 1, 0]])
    assert is_flat(cells).tolist() == [False, True, False, True]


def test_what_is_inside_without_a_facet() -> None:
    """A facet that is not asked for leaves a hole; the cells are then judged by their centers."""
    points, triangles = cube(4)
    whole, holed = SpatialComplex(points), SpatialComplex(points)
    for complex_, rows in ((whole, triangles), (holed, triangles[1:])):
        complex_.recover(rows)
        complex_.flood(len(rows))
    volumes = []
    for complex_ in (whole, holed):
        made = complex_.inside()
        corners = made.points[made.simplices]
        volumes.append(np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum() / 6)
    assert np.isclose(volumes[0], volumes[1], rtol=1e-12) and volumes[0] > 0
