"""Tree: a quadtree or an octree, as users have it: its cells, and the meshes made of them.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh, noticed
from ..tree.cells import TreeCells
from ..tree.contacts import OUTSIDE
from ..tree.cubes import cubes_as_tetrahedra
from ..tree.templates import squares_as_triangles
from ..tree.vertices import numbered
from ..tree_regions.fitted import fitted
from ..tree_regions.quads import quads
from ..tree_regions.warped import warped

__all__ = ["Tree"]

IN_THE_PLANE = {"fitted": fitted, "quads": quads, "warped": warped}  # of a quadtree over a domain
KINDS_OF_MESHES = ("cells", "conforming", *IN_THE_PLANE)
# Bit a of a tree's corner tells on which side it lies along axis a; meshes go around a square.
AROUND = [0, 1, 3, 2, 4, 5, 7, 6]


class Tree(TreeCells):
    __doc__ = TreeCells.__doc__

    def mesh(self, kind: str = "cells") -> DomainMesh:
        """The leaves as a mesh; those outside of the domain are left out.

        Parameters
        ----------
        kind : "cells", "conforming", "fitted", "quads" or "warped"
            "cells": squares or cubes as they are, with hanging vertices. "conforming": triangles with angles
            of 45 and 90 degrees, or tetrahedra with dihedral angles from 19.4 to 144.8 degrees.

            "fitted", for a quadtree over a domain: triangles of the domain itself, with its vertices, pieces,
            markers and regions. Its pieces are cut by the leaves, on their true curves; inside are the
            triangles of "conforming". Those along the pieces are improved as `voronoi_segment` does: their
            angles are at least 25 degrees, except in those that ``unrefined`` lists, with the reason.

            "quads", for the same and as complete: those triangles paired to convex quadrilaterals with angles
            from 39 to 141 degrees, squares inside; a few triangles remain.

            "warped", for the same and as complete: vertices near pieces move onto them, edges that still
            cross them are cut. The classical way, with poor angles (some 24 degrees in circles, 3 along rough
            boundaries); ``steps`` says what moved and what was cut.

        Returns
        -------
        DomainMesh

        Raises
        ------
        InputError
            If kind is unknown, or "conforming" is asked of a tree that is not balanced, or "fitted",
            "quads" or "warped" of a tree over a box, or in space.
        """
        if kind not in KINDS_OF_MESHES:
            raise InputError(f"kind must be one of {', '.join(map(repr, KINDS_OF_MESHES))}, not {kind!r}")
        if kind in IN_THE_PLANE:
            if self.dimension != 2:
                raise InputError(f"{kind!r} meshes are made from quadtrees, not in space")
            if self.domain is None:
                raise InputError(
                    f"a {kind!r} mesh is one of a domain, but this tree is over a box: quadtree(domain, ...)"
                )
            return noticed(IN_THE_PLANE[kind](self, self.domain))
        wanted = self.states > OUTSIDE
        vertices = numbered(self.grid)
        if kind == "cells":
            return self._as_cells(vertices.points, vertices.corners[wanted])
        across = "faces" if self.dimension == 2 else "edges"
        if not self.is_balanced(across):
            raise InputError(f"a conforming mesh needs a tree that is balanced across {across}")
        pattern = squares_as_triangles if self.dimension == 2 else cubes_as_tetrahedra
        points, cells, _ = pattern(self.grid, vertices, wanted)
        used = np.unique(cells)
        return DomainMesh(points[used], np.searchsorted(used, cells))

    def _as_cells(self, points: NDArray[np.float64], corners: NDArray[Any]) -> DomainMesh:
        used = np.unique(corners)
        name = "quad" if self.dimension == 2 else "hexahedron"
        cells = np.searchsorted(used, corners)[:, AROUND[: 1 << self.dimension]]
        return DomainMesh(points[used], None, cells={name: cells})
