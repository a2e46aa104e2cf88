"""Hexahedra where there is room, pyramids and tetrahedra between them and the surface of a body: conforming.

Leaves of an octree far enough from the surface make the *kernel*, which ends in triangles: those of fans
about the centers of its outermost leaves. Between these and the surface lies a body with a cavity, the
*strip*, which is filled with tetrahedra. Both keep the triangles between them, so that they fit. See the
book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.telling import tell
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.field import SizeField, as_size
from ..bodies.dividing import divided
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE, CUT
from ..tree.lookup import located
from ..tree.vertices import numbered
from ..volume.coarse import CoarseFacets, coarse_facets
from ..volume.lacking import what_is_missing
from .choosing import clear_leaves, must_be_octree, with_hexahedra
from .pattern import NOT_CHOSEN, cubes_as_cells
from .strip import strip_of
from .together import of_cubes, together

__all__ = ["hexahedra_and_others"]

MARGINS = (
    0.5,
    1.0,
    2.0,
)  # sides of a leaf from it to the surface; the next if the strip cannot be filled
STRIP_EDGES = 1.1  # the wanted length of edges in the strip; unit: the side of the leaf there
NO_HEXAHEDRA = (
    "all cells are tetrahedra: no leaf is so far from the surface that it can be a hexahedron; a smaller "
    "size helps, and where facets are larger than leaves split_boundary=True"
)
MUCH_LARGER_CELLS = 1.5  # the size near a coarse facet over the side of leaves, from which these are no cubes


def hexahedra_and_others(tree: TreeCells, split_boundary: bool | None = None) -> DomainMesh:
    """A mesh of the whole body, or of the box, mostly of hexahedra; see `Tree.mesh`, "hex-dominant".

    Parameters
    ----------
    tree : TreeCells
        An octree that is balanced across edges.
    split_boundary : bool, optional
        As for `tetrahedralize`, with the sides of leaves for the size.
    """
    must_be_octree(tree, "hex-dominant")
    vertices = numbered(tree.grid)
    if tree.domain is None:
        every = np.ones(len(tree), dtype=bool)
        kinds = with_hexahedra(tree, vertices, every, bare=True)
        return of_cubes(cubes_as_cells(tree.grid, vertices, kinds.kind, bare=True))
    if len(tree.domain.facets) == 0:
        raise InputError("the domain has no facets, so nothing is inside")
    field = _sides_as_size(tree)
    parts = None if split_boundary is False else divided(tree.domain, field, bool(split_boundary))
    body = tree.domain if parts is None else parts.domain
    coarse = coarse_facets(body.triangulated, field)
    for margin in (*MARGINS, np.inf):
        chosen = clear_leaves(tree, body, margin) if np.isfinite(margin) else np.zeros(len(tree), dtype=bool)
        if coarse is not None:
            chosen &= _as_fine(tree, coarse)
        kinds = with_hexahedra(tree, vertices, chosen, bare=False)
        cubes = cubes_as_cells(tree.grid, vertices, kinds.kind, bare=False)
        strip = strip_of(body, cubes, parts, field)
        last = not (kinds.kind != NOT_CHOSEN).any()
        if last or (strip.mesh.complete and strip.keeps_kernel):
            break
    if last:
        tell(NO_HEXAHEDRA)
    lacking = what_is_missing(strip.domain, strip.mesh, "another size may help")
    return noticed(together(tree, parts, strip, cubes, kinds), lacking)


def _sides_as_size(tree: TreeCells) -> SizeField:
    """The sides of leaves as a size; a constant if those at the surface are equal, and none is smaller."""
    sides = np.asarray(tree.sides)
    here, inside = np.unique(sides[tree.states == CUT]), sides[tree.states > ALL_OUTSIDE]
    if len(here) == 1 and (inside >= here[0]).all():
        return as_size(STRIP_EDGES * float(here[0]))
    grid, (low, high) = tree.grid, tree.box

    def size(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return STRIP_EDGES * sides[located(grid, np.clip(x, low, high))]

    return SizeField(size, name="sides of leaves")


def _as_fine(tree: TreeCells, coarse: CoarseFacets) -> NDArray[np.bool_]:
    """Leaves that are as large as tetrahedra there will be, because of facets that stay and are larger."""
    sides = np.asarray(tree.sides)
    return coarse.least(tree.centers, sides) <= MUCH_LARGER_CELLS * sides
