"""Tree: a quadtree or an octree, as users have it: its cells, and the meshes made of them.

See the book, chapter 4a.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_flag
from ...base.arrays import flagged, frozen
from ...base.doors import door
from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh, noticed
from ..hexahedra.cubes_cut import cut_cubes
from ..hexahedra.dominant import hexahedra_and_others
from ..hexahedra.inner import inner_hexahedra
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE
from ..tree.cubes import cubes_as_tetrahedra
from ..tree.hanging import Hanging, hanging_of
from ..tree.templates import squares_as_triangles
from ..tree.vertices import Vertices, numbered
from ..tree_regions.fitted import fitted
from ..tree_regions.quads import quads
from ..tree_regions.warped import warped
from . import card
from .named import names_of_leaves
from .pinched import pinches

__all__ = ["Tree"]

FROM_QUADTREES = {"fitted": fitted, "quads": quads, "warped": warped}  # of a quadtree over a domain
FROM_OCTREES = ("hexahedra", "hex-dominant", "cut")  # of an octree over a domain
KINDS_OF_MESHES = ("cells", "conforming", *FROM_QUADTREES, *FROM_OCTREES)
# Bit a of a tree's corner tells on which side it lies along axis a; meshes go around a square.
AROUND_CELL = [0, 1, 3, 2, 4, 5, 7, 6]

_plot = door("unstruct.view:plot_tree")


class Tree(TreeCells):
    __doc__ = TreeCells.__doc__

    def mesh(self, kind: str = "cells", *, split_boundary: bool | None = None) -> DomainMesh:
        """The leaves as a mesh; those outside of the domain are left out.

        Parameters
        ----------
        kind : str
            - "cells": squares or cubes as they are, with hanging vertices.
            - "conforming": triangles, with angles of 45 and 90 degrees if the box is a square, or tetrahedra,
              with dihedral angles from 19.4 to 144.8 degrees if it is a cube; a longer box stretches them.
              Where leaves meet at a corner only (or at an edge, in space), the mesh touches itself: these
              cells are in ``unrefined``, with the place. Smaller leaves part them, unless the domain touches
              itself there.
            - "fitted", for a quadtree over a domain: triangles of the domain itself, with its vertices,
              pieces, markers and regions. Its pieces are cut by the leaves, on their true curves; inside are
              the triangles of "conforming". Those along the pieces are improved as `voronoi_segment` does:
              their angles are at least 25 degrees, except in those that ``unrefined`` lists, with the reason.
            - "quads", for the same and as complete: those triangles paired to convex quadrilaterals with
              angles from 39 to 141 degrees, squares inside; a few triangles remain.
            - "warped", for the same and as complete: vertices near pieces move onto them, edges that still
              cross them are cut. The classical way, with poor angles (some 24 degrees in circles, 3 along
              rough boundaries); ``steps`` says what moved and what was cut.
            - "hexahedra": in space, the leaves inside of the domain as hexahedra, with pyramids and
              tetrahedra where levels change, so that all cells meet in whole faces. Leaves that touch others
              at edges or corners only are left out.
            - "hex-dominant": in space, a mesh of the whole body. Leaves far enough from the surface are
              hexahedra. Where levels change there are pyramids and tetrahedra, and tetrahedra to the surface,
              of which the triangles are kept, and polygons divided. All cells meet in whole faces. Where the
              faces of leaves lie exactly in polygons of the surface, hexahedra reach these: a box is nothing
              else, if the tree's root is ``body.bounds``.
            - "cut": in space, tetrahedra of which the boundary is near the surface, not on it: those of
              "conforming", cut where their edges first leave the body. Edges and corners of the body are cut
              off, inner pieces are passed over, and angles may be tiny (0.01 degrees have been seen).
        split_boundary : bool, optional
            For "hex-dominant": whether facets are divided to the sides of leaves, as in `tetrahedralize`: by
            default, polygons of more than three corners are.

        Returns
        -------
        DomainMesh
            Markers of "cells" and "conforming" tell of each cell the number of its "leaf", its "level", and
            its "state": 1 inside of the domain, 0 if the boundary meets the leaf. If regions have names,
            "region" has the number of that in which the leaf lies, and -1 if a facet or an inner piece, in
            space an inner facet, enters the leaf. Each name of pieces has 1 for cells whose leaf one of these
            meets or touches, else 0. Of "cells", the marker "hanging" has the vertices that hang, as rows of
            one. Other kinds have the markers of the domain.

            A mesh "hex-dominant" has all that `tetrahedralize` tells, in ``counts`` the "faces of leaves on
            facets", and in ``figures`` the "share of hexahedra" in the volume. If there are quadrilaterals on
            facets, ``faces`` has rows of four. "hexahedra" has the "share of volume" of all cells.

            Cells of a mesh "cut" are in ``unrefined`` beside parts of the body, or gaps, that are thinner
            than leaves and lost or filled by more than 0.8 of a leaf; and one for each component of the
            surface beside which the boundary is not connected as it is (by components and Euler
            characteristic). ``figures`` has the largest distance of a place of the surface, "cells missed".
            Faces have the names of the nearest pieces.

        Raises
        ------
        InputError
            If kind is unknown or none for this dimension, if a conforming mesh is asked of a tree that is not
            balanced across edges (in the plane, across faces), if a mesh of a domain is asked of a tree over
            a box, if nothing is inside of the domain, and if no leaf is for "hexahedra".

        Notes
        -----
        O(n log n) for n leaves. In a mesh "hex-dominant" a leaf without hanging vertices is a hexahedron if
        all its neighbors are far enough from the surface, too, or a facet covers its face there; others that
        are so are fans about their centers. Facets in planes between those of the lattice, turned facets, and
        walls (unless all facets and walls lie in faces of leaves) are half a leaf away at least. Triangles
        that are joined to others are kept and reached by no hexahedron: the flat sides of a surface of
        triangles are polygons in ``body.simplified()``. The space from all these to the surface is filled as
        `tetrahedralize` does it, with sides of leaves for the size. If that fails, leaves farther from the
        surface are chosen, and in the end none. Every hexahedron is a box, and all cells are positive.

        Edges are cut at least 1/32 of their length from their ends. Source of "cut": M. A. Yerry, M. S.
        Shephard, *Automatic three-dimensional mesh generation by the modified-octree technique*, Int. J.
        Numer. Methods Eng. 20 (1984) 1965-1990. Book: 4a, 4c.
        """
        if not isinstance(kind, str) or kind not in KINDS_OF_MESHES:
            raise InputError(f"kind must be one of {', '.join(map(repr, KINDS_OF_MESHES))}, not {kind!r}")
        if split_boundary is not None:
            split_boundary = as_flag(split_boundary, "split_boundary")
            if kind != "hex-dominant":
                raise InputError(f'split_boundary goes with "hex-dominant", not with {kind!r}')
        if kind in (FROM_OCTREES if self.dimension == 2 else FROM_QUADTREES):
            places = "octrees; this is a quadtree" if kind in FROM_OCTREES else "quadtrees, not in space"
            raise InputError(f"{kind!r} meshes are made from {places}")
        if kind in FROM_QUADTREES:
            if self.domain is None:
                raise InputError(
                    f"a {kind!r} mesh is one of a domain, but this tree is over a box: quadtree(domain, ...)"
                )
            return noticed(FROM_QUADTREES[kind](self, self.domain))
        if kind == "hex-dominant":
            return hexahedra_and_others(self, split_boundary)
        if kind in ("hexahedra", "cut"):
            return inner_hexahedra(self) if kind == "hexahedra" else cut_cubes(self)
        wanted = self.states > ALL_OUTSIDE
        if not wanted.any():
            raise InputError("the domain has no facets, so nothing is inside")
        vertices = self._vertices
        if kind == "cells":
            block = vertices.corners[wanted][:, AROUND_CELL[: 1 << self.dimension]]
            hung = self._hanging.vertices[:, None]
            return self._as_mesh(vertices.points, block, np.flatnonzero(wanted), {}, hanging=hung)
        across = "faces" if self.dimension == 2 else "edges"
        if not self.is_balanced(across):
            raise InputError(
                f"a conforming mesh needs a tree that is balanced across {across}: tree.balanced({across!r})"
            )
        pattern = squares_as_triangles if self.dimension == 2 else cubes_as_tetrahedra
        points, block, leaf = pattern(self.grid, vertices, wanted)
        return noticed(self._as_mesh(points, block, leaf, pinches(points, block)))

    def _as_mesh(
        self,
        points: NDArray[np.float64],
        block: NDArray[Any],
        leaf: NDArray[np.int64],
        reasons: dict[int, str],
        **faces: NDArray[Any],
    ) -> DomainMesh:
        """The mesh of the cells `block` of leaves, with those points only that it uses."""
        used = flagged(len(points), block)
        number = np.cumsum(used, dtype=np.int32) - np.int32(1)
        cells: dict[tuple[int, int], str] = {(2, 4): "quad", (3, 8): "hexahedron"}
        name = cells.get((self.dimension, block.shape[1]))
        markers = {key: values[leaf] for key, values in self._names.items()}
        markers |= {"leaf": leaf, "level": self.levels[leaf], "state": self.states[leaf]}
        regions = {} if self.domain is None else {name: k for k, name in enumerate(self.domain.regions)}
        return DomainMesh(
            points[used],
            None if name else number[block],
            cells={name: number[block]} if name else None,
            origin=np.full(int(used.sum()), -1, dtype=np.int32),
            markers=markers | {key: number[rows] for key, rows in faces.items()},
            regions=regions,
            unrefined=list(reasons) if reasons else None,
            reasons=list(reasons.values()) if reasons else None,
        )

    @cached_property
    def _names(self) -> dict[str, NDArray[Any]]:
        return names_of_leaves(self)

    @cached_property
    def _vertices(self) -> Vertices:
        return numbered(self.grid)

    @cached_property
    def _hanging(self) -> Hanging:
        return hanging_of(self.grid, self._vertices, self.states > ALL_OUTSIDE)

    @property
    def hanging(self) -> Hanging:
        """The hanging vertices of ``mesh("cells")``: numbers, parents and weights.

        The value of a continuous function at ``vertices[i]`` is the sum of ``weights[i]`` times its values at
        ``parents[i]``: the ends of the edge, or the corners of the face, on which the vertex hangs.
        """
        used = flagged(len(self._vertices.points), self._vertices.corners[self.states > ALL_OUTSIDE])
        number = np.cumsum(used, dtype=np.int32) - np.int32(1)
        found = self._hanging
        parents = np.where(found.parents < 0, np.int32(-1), number[found.parents])
        return Hanging(frozen(number[found.vertices]), frozen(parents), frozen(found.weights))

    def plot(
        self,
        ax: Any = None,
        *,
        values: Any = None,
        label: str = "",
        boundary: bool = True,
        azimuth: float | None = None,
        elevation: float | None = None,
        section: Any = None,
    ) -> Any:
        """Draw with matplotlib, leaves colored by level; see `unstruct.view.plot_tree` for the options."""
        view = {"azimuth": azimuth, "elevation": elevation, "section": section}
        return _plot(self, ax, values=values, label=label, boundary=boundary, **view)

    def _repr_html_(self) -> str:
        return card.html(self)
