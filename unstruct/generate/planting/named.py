"""Names of a domain on the leaves of a tree: the region of each, and which pieces meet it.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ..boundary.constrained import constrained_delaunay
from ..hexahedra.meeting import meetings
from ..hexahedra.regions import regions_of_leaves
from ..tree.cells import TreeCells
from ..tree.chords import straightened
from ..tree.contacts import ALL_INSIDE, ALL_OUTSIDE

__all__ = ["NO_REGION", "names_of_leaves"]

NO_REGION = -1  # of leaves that a facet or an inner piece enters


def names_of_leaves(tree: TreeCells) -> dict[str, NDArray[Any]]:
    """For each name of the domain which leaves its pieces meet, and "region" of each leaf: (n,) each.

    Leaves that touch pieces are met by these, too. Regions are those of leaves whose insides no facet and no
    inner piece (in space, no inner facet) meets, others have `NO_REGION`; only a domain with names of regions
    has them.
    """
    domain = tree.domain
    if domain is None or not (domain.markers or domain.regions):
        return {}
    shape: Domain = domain
    if tree.dimension == 2 and domain.curves:
        shape = straightened(domain, tree.boundary.deviation).domain if tree.boundary else domain
    points, blocks = _pieces(shape)
    present = np.asarray(tree.states) > ALL_OUTSIDE
    names: dict[str, NDArray[Any]] = {}
    if shape.markers:
        leaf, piece = _met(tree, present, points, blocks)
        for name, rows in shape.markers.items():
            names[name] = np.zeros(len(tree), dtype=np.int8)
            names[name][leaf[np.isin(piece, rows)]] = 1
    if shape.regions:
        chosen = np.asarray(tree.states) == ALL_INSIDE
        walls = blocks[0]  # triangles in space, segments in the plane: these divide
        inner = walls[0][walls[1] >= len(shape.facets)]
        chosen[meetings(tree, chosen, points, inner)[0]] = False
        found = _in_plane(tree, shape, chosen) if tree.dimension == 2 else regions_of_leaves(tree, chosen)
        names["region"] = found.astype(np.int32)
    return names


def _pieces(shape: Domain) -> tuple[NDArray[np.float64], list[tuple[NDArray[Any], NDArray[Any]]]]:
    """Points, and blocks of rows of vertices with the number of the piece of each."""
    if shape.dimension == 2:
        return shape.points, [(shape.pieces, np.arange(len(shape.pieces)))]
    shell = shape.triangulated
    return shell.points, [(shell.triangles, shell.piece), (shell.segments, shell.segment_piece)]


def _met(
    tree: TreeCells, present: NDArray[np.bool_], points: NDArray[np.float64], blocks: Any
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    found = []
    for rows, piece in blocks:
        leaf, which = meetings(tree, present, points, rows, touching=True)
        found.append((leaf, np.asarray(piece)[which].astype(np.int64)))
    leaf, piece = (np.concatenate(column) for column in zip(*found, strict=True))
    return leaf, piece


def _in_plane(tree: TreeCells, shape: Domain, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The regions of chosen leaves of a quadtree: those of the triangles at their centers."""
    mesh = constrained_delaunay(shape)
    region = np.full(len(tree), NO_REGION, dtype=np.int64)
    cell = np.asarray(mesh.find_simplex(np.asarray(tree.centers)[chosen]))
    region[chosen] = np.where(cell < 0, NO_REGION, np.asarray(mesh.markers["region"])[cell])
    return region
