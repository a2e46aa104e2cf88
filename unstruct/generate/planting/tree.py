"""Tree: a quadtree or an octree, as users have it: its cells, and the meshes made of them.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh
from ..tree.cells import TreeCells
from ..tree.contacts import OUTSIDE
from ..tree.cubes import cubes_as_tetrahedra
from ..tree.templates import squares_as_triangles
from ..tree.vertices import numbered

__all__ = ["Tree"]

KINDS_OF_MESHES = ("cells", "conforming")
# Bit a of a tree's corner tells on which side it lies along axis a; meshes go around a square.
AROUND = [0, 1, 3, 2, 4, 5, 7, 6]


class Tree(TreeCells):
    __doc__ = TreeCells.__doc__

    def mesh(self, kind: str = "cells") -> DomainMesh:
        """The leaves as a mesh; those outside of the domain are left out.

        Parameters
        ----------
        kind : "cells" or "conforming"
            "cells": squares or cubes as they are, with hanging vertices. "conforming": triangles with angles
            of 45 and 90 degrees, or tetrahedra with dihedral angles from 19.4 to 144.8 degrees.

        Returns
        -------
        DomainMesh

        Raises
        ------
        InputError
            If kind is unknown, or "conforming" is asked of a tree that is not balanced.
        """
        if kind not in KINDS_OF_MESHES:
            raise InputError(f"kind must be one of {', '.join(map(repr, KINDS_OF_MESHES))}, not {kind!r}")
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
