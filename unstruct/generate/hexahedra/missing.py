"""Places of a body's surface that are compared with the boundary of a mesh of cut cubes.

See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangle_tree import TriangleTree
from ..stuffing.ending import nearest_on
from ..tree.cells import TreeCells
from ..tree.contacts import CUT
from ..tree.lookup import located

__all__ = ["samples_of_surface"]

Array = NDArray[np.float64]
PLACES_IN_LEAF = (0.25, 0.75)  # of a leaf along each axis: together a lattice of half the side


def samples_of_surface(tree: TreeCells, points: Array, triangles: NDArray[np.integer]) -> tuple[Array, Array]:
    """Places of a surface, and the sides of the leaves that they are in.

    They are all vertices, and the places nearest to 8 places of each leaf that the surface meets.
    """
    met = tree.states == CUT
    low, high = (np.asarray(ends)[met] for ends in tree.corners)
    steps = np.stack(np.meshgrid(*[PLACES_IN_LEAF] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    lattice = (low[:, None] + steps * (high - low)[:, None]).reshape(-1, 3)
    corners = points[triangles]
    which, _ = TriangleTree(corners).nearest(lattice)
    x = np.concatenate([points[np.unique(triangles)], nearest_on(lattice, corners, which)])
    leaf = located(tree.grid, np.clip(x, tree.box[0], np.nextafter(tree.box[1], tree.box[0])))
    return x, np.asarray(tree.sides)[leaf]
