"""A body as tetrahedra of cut cubes, by Yerry and Shephard. See the book, chapter 4c."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.space.cutting import Shell
from ...domain.space.parts import parts_in_space
from ...geometry.inside_shell import even_odd_in_space
from ...geometry.triangle_tree import TriangleTree
from ...mesh import topology
from ...mesh.domain_mesh import DomainMesh, noticed
from ..stuffing.account import lost_or_filled
from ..tree.cells import TreeCells
from ..tree.contacts import ALL_OUTSIDE, CUT
from ..tree.cubes import cubes_as_tetrahedra
from ..tree.vertices import numbered
from .choosing import must_be_octree
from .cutting import VERTEX_IN, VERTEX_ON, VERTEX_OUT, crossings, cut_cells, positive_places
from .missing import samples_of_surface
from .numbering import named_parts
from .pinches import pinched_vertices

__all__ = ["cut_cubes"]

Array = NDArray[np.float64]
VERTEX_UNKNOWN = 2  # the side of vertices at which all is inside


class _Kept(NamedTuple):
    """What is kept: all points, cells, on which side the tree's vertices are, and counts."""

    points: Array
    simplices: NDArray[np.int32]
    neighbors: NDArray[np.int32]
    border: NDArray[np.int32]
    side: NDArray[np.int8]
    counts: dict[str, int]


def cut_cubes(tree: TreeCells) -> DomainMesh:
    """Tetrahedra cut from the leaves of an octree; see `Tree.mesh`, "cut"."""
    must_be_octree(tree, "cut")
    domain = tree.domain
    if domain is None or len(domain.facets) == 0:
        raise InputError('"cut" needs the tree of a body with facets')
    found = _kept(tree, domain)
    region = _regions(domain, found)
    used = np.flatnonzero(flagged(len(found.points), found.simplices))
    number = np.full(len(found.points), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    x, border = found.points[used], number[found.border]
    shell = domain.triangulated
    cell = np.nonzero(found.neighbors < 0)[0]
    surface = (shell.points, shell.bounding)
    reasons, most = lost_or_filled(samples_of_surface(tree, *surface), surface, (x, border, cell), "leaf")
    rows = sorted(reasons)
    mesh = DomainMesh(
        x,
        number[found.simplices],
        neighbors=found.neighbors,
        origin=np.full(len(x), -1, dtype=np.int32),
        markers=_markers(domain, x, border) | {"region": region},
        regions={name: k for k, name in enumerate(domain.regions)},
        unrefined=np.array(rows, dtype=np.int32),
        reasons=[reasons[row] for row in rows],
        counts=found.counts,
        figures={"cells missed": most},
    )
    return noticed(mesh)


def _kept(tree: TreeCells, domain: Domain) -> _Kept:
    """The cells; vertices on the surface at which cells would touch without a common face are taken away."""
    shell = domain.triangulated
    points, cells, leaf = cubes_as_tetrahedra(tree.grid, numbered(tree.grid), tree.states > ALL_OUTSIDE)
    met = np.asarray(tree.states)[leaf] == CUT
    side = np.full(len(points), VERTEX_UNKNOWN, dtype=np.int8)
    while True:
        _look(shell, points, np.flatnonzero(flagged(len(points), cells[met])), side)
        whole, cut = _sorted_out(domain, points, cells[met], side)
        parts, edges = cut_cells(cut, side, len(points))
        simplices = np.concatenate([cells[~met], whole, parts])
        if len(simplices) == 0:
            raise InputError("no vertex of a leaf lies inside of the body; give a smaller size")
        place = crossings(points, edges, shell.points, shell.bounding)
        every, moved = positive_places(points, edges, place, simplices)
        neighbors = topology.neighbors(simplices)
        border = topology.boundary(simplices, neighbors)
        bad = pinched_vertices(simplices, border, len(every))
        bad = bad[bad < len(points)]
        _look(shell, points, bad, side)
        bad = bad[side[bad] == VERTEX_ON]
        if len(bad) == 0:
            counts = {"cut edges": len(edges), "cut in the middle": moved}
            return _Kept(every, simplices, neighbors, border, side, counts)
        side[bad] = VERTEX_OUT
        met |= (side[cells] == VERTEX_OUT).any(axis=1)


def _look(shell: Shell, points: Array, rows: NDArray[np.integer], side: NDArray[np.int8]) -> None:
    """Find on which side of the surface some vertices are that are not known yet; exact."""
    asked = rows[side[rows] == VERTEX_UNKNOWN]
    odd, on = even_odd_in_space(shell.points, shell.bounding, points[asked])
    side[asked] = np.where(on, VERTEX_ON, np.where(odd, VERTEX_IN, VERTEX_OUT))


def _sorted_out(
    domain: Domain, points: Array, cells: NDArray[np.int32], side: NDArray[np.int8]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The cells that stay whole, and those to be cut."""
    least, most = side[cells].min(axis=1), side[cells].max(axis=1)
    whole = (least >= VERTEX_ON) & (most > VERTEX_ON)
    flat = np.flatnonzero((least == VERTEX_ON) & (most == VERTEX_ON))  # all corners on the surface
    whole[flat] = domain.contains(points[cells[flat]].mean(axis=1))
    return cells[whole], cells[(least < VERTEX_ON) & (most > VERTEX_ON)]


def _regions(domain: Domain, found: _Kept) -> NDArray[np.int32]:
    """The number of each cell: that of the part of the body in which its first vertex inside lies."""
    shell = domain.triangulated
    parts = parts_in_space(shell.points, shell.triangles)
    inside = np.zeros(len(found.points), dtype=bool)
    inside[: len(found.side)] = (found.side == VERTEX_IN) | (found.side == VERTEX_UNKNOWN)
    corner = found.simplices[np.arange(len(found.simplices)), inside[found.simplices].argmax(axis=1)]
    asked = np.flatnonzero(flagged(len(found.points), corner))
    part = (
        np.zeros(len(asked), dtype=np.int64) if len(parts.walls) == 1 else parts.locate(found.points[asked])
    )
    seeds = np.concatenate([np.empty((0, 3)), *domain.regions.values()])
    of_seed = parts.locate(seeds)
    used = np.unique(part)
    place = np.searchsorted(used, of_seed).clip(max=len(used) - 1)
    numbers = named_parts(domain, np.arange(len(used)), place, used[place] == of_seed)
    of_vertex = np.full(len(found.points), -1, dtype=np.int32)
    of_vertex[asked] = numbers[np.searchsorted(used, part)]
    return of_vertex[corner]


def _markers(domain: Domain, points: Array, border: NDArray[np.int32]) -> dict[str, NDArray[np.int32]]:
    """The names of faces of the boundary: those of the pieces that are nearest to their middles."""
    markers = {"facets": border, "inner": np.empty((0, 3), dtype=np.int32)}
    if domain.markers:
        shell = domain.triangulated
        outer = np.flatnonzero(shell.piece < shell.facets)
        near, _ = TriangleTree(shell.points[shell.triangles[outer]]).nearest(points[border].mean(axis=1))
        piece = shell.piece[outer[near]]
        markers |= {name: border[np.isin(piece, rows)] for name, rows in domain.markers.items()}
    return markers
