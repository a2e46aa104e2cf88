"""Tree: a quadtree or an octree, as users have it: its cells, and the meshes made of them.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_flag
from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh
from ..hexahedra.cubes_cut import cut_cubes
from ..hexahedra.dominant import hexahedra_and_others
from ..hexahedra.inner import inner_hexahedra
from ..tree.cells import TreeCells
from ..tree.contacts import OUTSIDE
from ..tree.cubes import cubes_as_tetrahedra
from ..tree.templates import squares_as_triangles
from ..tree.vertices import numbered

__all__ = ["Tree"]

KINDS_OF_MESHES = ("cells", "conforming", "hexahedra", "hex-dominant", "cut")
# Bit a of a tree's corner tells on which side it lies along axis a; meshes go around a square.
AROUND = [0, 1, 3, 2, 4, 5, 7, 6]


class Tree(TreeCells):
    __doc__ = TreeCells.__doc__

    def mesh(self, kind: str = "cells", *, split_boundary: bool | None = None) -> DomainMesh:
        """The leaves as a mesh; those outside of the domain are left out.

        Parameters
        ----------
        kind : str
            - "cells": squares or cubes as they are, with hanging vertices.
            - "conforming": triangles with angles of 45 and 90 degrees, or tetrahedra with dihedral angles
              from 19.4 to 144.8 degrees.
            - "hexahedra": in space, the leaves inside of the domain as hexahedra, with pyramids and
              tetrahedra where levels change, so that all cells meet in whole faces. Leaves that touch others
              at edges or corners only are left out.
            - "hex-dominant": in space, a mesh of the whole body. Leaves far enough from the surface are
              hexahedra. Where levels change there are pyramids and tetrahedra, and tetrahedra to the surface,
              of which the triangles are kept, and polygons divided. All cells meet in whole faces.
            - "cut": in space, tetrahedra of which the boundary is near the surface, not on it: those of
              "conforming", cut where their edges first leave the body. Edges and corners of the body are cut
              off, inner pieces are passed over, and angles may be tiny (0.01 degrees have been seen).
        split_boundary : bool, optional
            For "hex-dominant": whether facets are divided to the sides of leaves, as in `tetrahedralize`: by
            default, polygons of more than three corners are.

        Returns
        -------
        DomainMesh
            A mesh "hex-dominant" has all that `tetrahedralize` tells, and in ``figures`` the "share of
            hexahedra" in the volume; "hexahedra" has the "share of volume" of all cells. Where a part of the
            body that is thinner than leaves is lost, the nearest cells of a mesh "cut" are in ``unrefined``;
            its faces have the names of the nearest pieces.

        Raises
        ------
        InputError
            If kind is unknown or none for this dimension, if a conforming mesh is asked of a tree that is
            not balanced across edges (in the plane, across faces), and if no leaf is inside.

        Notes
        -----
        O(n log n) for n leaves. In a mesh "hex-dominant" a leaf without hanging vertices is a hexahedron if
        all its neighbors are far enough from the surface, too; others that are so are fans about their
        centers. The space from these to the surface is filled as `tetrahedralize` does it, with sides of
        leaves for the size. If that fails, leaves farther from the surface are chosen, and in the end none.
        Every hexahedron is a box, and all cells are positive.

        Edges are cut at least 1/32 of their length from their ends. Source of "cut": M. A. Yerry, M. S.
        Shephard, *Automatic three-dimensional mesh generation by the modified-octree technique*, Int. J.
        Numer. Methods Eng. 20 (1984) 1965-1990. Book: 4a, 4c.
        """
        if kind not in KINDS_OF_MESHES:
            raise InputError(f"kind must be one of {', '.join(map(repr, KINDS_OF_MESHES))}, not {kind!r}")
        if split_boundary is not None:
            split_boundary = as_flag(split_boundary, "split_boundary")
            if kind != "hex-dominant":
                raise InputError(f'split_boundary goes with "hex-dominant", not with {kind!r}')
        if kind == "hex-dominant":
            return hexahedra_and_others(self, split_boundary)
        if kind in ("hexahedra", "cut"):
            return inner_hexahedra(self) if kind == "hexahedra" else cut_cubes(self)
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
