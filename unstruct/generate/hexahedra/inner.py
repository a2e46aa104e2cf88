"""The leaves inside of a body as hexahedra, with pyramids and tetrahedra where levels change.

See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh
from ...mesh.split import simplices_of_cells
from ..tree.cells import TreeCells
from ..tree.vertices import Vertices, numbered
from .choosing import clear_leaves, must_be_octree
from .pattern import NOT_CHOSEN, Cubes, cubes_as_cells, kinds_of_leaves, leaves_at_ends
from .pinches import pinched_vertices
from .regions import regions_of_leaves
from .together import KINDS_OF_CELLS, of_cubes

__all__ = ["inner_hexahedra"]


def inner_hexahedra(tree: TreeCells) -> DomainMesh:
    """A mesh of the leaves inside; see `Tree.mesh`, "hexahedra"."""
    must_be_octree(tree, "hexahedra")
    vertices = numbered(tree.grid)
    chosen = clear_leaves(tree, tree.domain, 0.0)
    many = int(chosen.sum())
    chosen, cubes = _apart(tree, vertices, chosen)
    if not chosen.any():
        raise InputError("no leaf lies inside of the body; give a smaller size")
    counts = {"left out where leaves touch at edges or corners only": many - int(chosen.sum())}
    low, high = tree.corners
    along = (high - low)[chosen]
    whole = tree.box[1] - tree.box[0]
    volume = float(whole[0] * whole[1] * whole[2]) if tree.domain is None else tree.domain.volume
    figures = {"share of volume": float((along[:, 0] * along[:, 1] * along[:, 2]).sum() / volume)}
    if tree.domain is None:
        return of_cubes(cubes, counts=counts, figures=figures)
    region = regions_of_leaves(tree, chosen)[cubes.leaf].astype(np.int32)
    names = {name: k for k, name in enumerate(tree.domain.regions)}
    return of_cubes(cubes, {"region": region}, names, counts, figures)


def _apart(tree: TreeCells, vertices: Vertices, chosen: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], Cubes]:
    """Without leaves that touch others at edges or corners only."""
    chosen = chosen.copy()
    while True:
        kind = kinds_of_leaves(tree.grid, vertices, chosen, bare=True)
        cubes = cubes_as_cells(tree.grid, vertices, kind, bare=True)
        if not (kind != NOT_CHOSEN).any():
            return chosen, cubes
        near = leaves_at_ends(tree.grid, chosen)
        cells, rest = _cells_of_leaves(cubes, near), _cells_of_leaves(cubes, ~near)
        many = len(cubes.points)  # all cells at a vertex of the boundary are of leaves at ends
        border = flagged(many, *cells.values()) & ~flagged(many, *rest.values())
        bad = pinched_vertices(simplices_of_cells(cells)[0], np.flatnonzero(border), many)
        pinched = np.zeros(len(cubes.points), dtype=bool)
        pinched[bad] = True
        drop = chosen & pinched[vertices.corners].any(axis=1)
        if not drop.any():
            return chosen, cubes
        chosen &= ~drop


def _cells_of_leaves(cubes: Cubes, which: NDArray[np.bool_]) -> dict[str, NDArray[np.int32]]:
    """The cells by kind of some leaves, (n,) bool."""
    cells, begin = {}, 0
    blocks = (cubes.hexahedra, cubes.pyramids, cubes.tetrahedra)
    for name, rows in zip(KINDS_OF_CELLS, blocks, strict=True):
        cells[name] = rows[which[cubes.leaf[begin : begin + len(rows)]]]
        begin += len(rows)
    return cells
