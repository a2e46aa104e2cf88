"""The leaves inside of a body as hexahedra, with pyramids and tetrahedra where levels change.

See the book, chapter 4c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.space.parts import parts_in_space
from ...mesh.domain_mesh import DomainMesh
from ...mesh.split import simplices_of_cells
from ..tree.cells import TreeCells
from ..tree.vertices import Vertices, numbered
from .choosing import clear_leaves, must_be_octree
from .numbering import named_parts
from .pattern import NOT_CHOSEN, Cubes, cubes_as_cells, kinds_of_leaves, leaves_at_ends, linked
from .pinches import pinched_vertices
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
    region = _regions(tree, chosen)[cubes.leaf].astype(np.int32)
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


def _regions(tree: TreeCells, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """For each leaf the number of the part of the body that it lies in; -1 if it is not chosen."""
    shell = tree.domain.triangulated
    parts = parts_in_space(shell.points, shell.triangles)
    root = linked(tree.grid, chosen)
    heads = np.flatnonzero(chosen & (root == np.arange(len(root))))
    part = np.full(len(root), -1, dtype=np.int64)
    part[heads] = parts.locate(np.asarray(tree.centers)[heads])
    seeds = np.concatenate([np.empty((0, 3)), *tree.domain.regions.values()])
    of_seed = parts.locate(seeds)
    used = np.unique(part[heads])
    place = np.searchsorted(used, of_seed).clip(max=len(used) - 1)
    numbers = named_parts(tree.domain, np.arange(len(used)), place, used[place] == of_seed)
    return np.where(chosen, numbers[np.searchsorted(used, part[root]).clip(max=len(used) - 1)], -1)
