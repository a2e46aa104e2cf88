"""A domain for meshes from quadtrees, with everything that a domain can have, and angles of meshes."""

from __future__ import annotations

import numpy as np

from unstruct import Arc, Domain

__all__ = ["angles", "everything"]


def angles(mesh):
    """The least angle of each triangle, in degrees."""
    x = mesh.points[mesh.simplices]
    u, v = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    cross = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return np.degrees(np.arctan2(cross, (u * v).sum(axis=2))).min(axis=1)


def everything(offset: float = 0.0) -> Domain:
    """Two regions, a hole, an interface, a crack, loose vertices, a curve, names."""
    points = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 0], [2, 4], [0.5, 0.5], [1, 0.5], [1, 1], [0.5, 1]]
    points += [[2.5, 1], [3.5, 2], [3, 3], [1, 3], [1.25, 3]]
    facets = [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0], [6, 7], [7, 8], [8, 9], [9, 6]]
    return Domain(
        [[x + offset, y] for x, y in points],
        facets,
        inner=[[4, 5], [10, 11]],
        curves={2: Arc.through((4 + offset, 0), (4.5 + offset, 2), (4 + offset, 4))},
        markers={"bottom": [0, 1], "hole": [6, 7, 8, 9], "crack": [11]},
        regions={"left": [[offset + 1.5, 2]], "right": [[offset + 3, 1]]},
    )
