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
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.field import SizeField, as_size
from ..bodies.dividing import Divided, divided
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE, CUT
from ..tree.lookup import located
from ..tree.vertices import Vertices, numbered
from ..volume.coarse import CoarseFacets, coarse_facets
from ..volume.lacking import what_is_missing
from .choosing import clear_leaves, must_be_octree, with_hexahedra
from .pattern import NOT_CHOSEN, cubes_as_cells, kinds_of_leaves
from .planes import NO_AXIS, Planes, faces_in_planes, planes_of
from .regions import regions_of_leaves
from .skin import NO_SKIN, cover_of, skin_of
from .strip import strip_around, strip_of
from .together import of_cubes, of_cubes_alone, together

__all__ = ["hexahedra_and_others"]

MARGINS = (
    0.5,
    1.0,
    2.0,
)  # sides of a leaf from it to the surface; the next if the strip cannot be filled
STRIP_EDGES = 1.1  # the wanted length of edges in the strip; unit: the side of the leaf there
NO_HEXAHEDRA = (
    "all cells are tetrahedra: no leaf is so far from the surface that it can be a hexahedron; a smaller "
    "size helps, and where facets are larger than leaves split_boundary=True, or body.simplified() if sides "
    "are flat"
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
    whole = _of_leaves(tree, vertices, split_boundary)
    if whole is not None:
        return noticed(whole)
    field = _sides_as_size(tree)
    parts = None if split_boundary is False else divided(tree.domain, field, bool(split_boundary))
    body = tree.domain if parts is None else parts.domain
    coarse = coarse_facets(body.triangulated, field)
    planes = planes_of(tree, split_boundary, False)
    for margin in (*MARGINS, np.inf):
        chosen, bare = _chosen(tree, body, parts, planes, margin)
        if coarse is not None:
            chosen &= _as_fine(tree, coarse)
        kinds = with_hexahedra(tree, vertices, chosen, bare=bare)
        cubes = cubes_as_cells(tree.grid, vertices, kinds.kind, bare=bare)
        last = not (kinds.kind != NOT_CHOSEN).any()
        skin, place = NO_SKIN, None
        if not last and bare[kinds.kind != NOT_CHOSEN].any():
            skin = skin_of(cubes, tree.domain, planes)
            cover, place = cover_of(tree.domain, planes, cubes, skin)
            strip = strip_around(tree.domain, cubes, (cover, place), field, bool(split_boundary))
        else:
            strip = strip_of(body, cubes, parts, field, len(tree.domain.points))
        if last or (strip.mesh.complete and strip.keeps_kernel):
            break
    if last:
        tell(NO_HEXAHEDRA)
    lacking = what_is_missing(strip.domain, strip.mesh, "another size may help")
    return noticed(together(tree, strip, cubes, kinds, skin, place), lacking)


def _chosen(
    tree: TreeCells, body: Domain, parts: Divided | None, planes: Planes, margin: float
) -> tuple[NDArray[np.bool_], NDArray[np.int8]]:
    """The leaves far enough from the surface, or with faces in its planes, and the bits of these faces."""
    bare = np.zeros(len(tree), dtype=np.int8)
    if not np.isfinite(margin):
        return np.zeros(len(tree), dtype=bool), bare
    if (planes.axis == NO_AXIS).all():
        return clear_leaves(tree, body, margin), bare
    own = planes if parts is None else Planes(planes.axis[parts.parent], planes.at[parts.parent])
    chosen = clear_leaves(tree, body, margin, own)
    bare, partly = faces_in_planes(tree, tree.domain, planes, chosen)
    return chosen & ~partly, bare


def _of_leaves(tree: TreeCells, vertices: Vertices, split_boundary: bool | None) -> DomainMesh | None:
    """The mesh of a body whose facets, and walls, all lie in faces of leaves; None of another one."""
    domain, inside = tree.domain, np.asarray(tree.states) > ALL_OUTSIDE
    planes = planes_of(tree, split_boundary, True)
    if (planes.axis == NO_AXIS).any() or len(domain.loose) or (tree.states == CUT).any():
        return None
    chosen = clear_leaves(tree, domain, 0.0, planes)
    bare, partly = faces_in_planes(tree, domain, planes, chosen)
    if not np.array_equal(chosen & ~partly, inside):
        return None
    kind = kinds_of_leaves(tree.grid, vertices, chosen, bare=bare)
    cubes = cubes_as_cells(tree.grid, vertices, kind, bare=bare)
    return of_cubes_alone(tree, cubes, skin_of(cubes, domain, planes), regions_of_leaves(tree, chosen))


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
