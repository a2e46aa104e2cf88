"""isosurface_stuffing: tetrahedra with bounded dihedral angles in what a function bounds.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flag, positive
from ...base.errors import InputError
from ...mesh.domain_mesh import DomainMesh
from ...sizing.field import SizeField, as_size
from ..tree.balancing import balanced
from ..tree.criteria import Level, Rule, by_size
from ..tree.growing import MOST_LEAVES, Growth, Limits, as_box, grow
from ..tree.keys import DEEPEST_LEVEL, Keys
from ..tree.linear import Linear, leaves_of
from ..tree.lookup import Grid, table_of
from .filling import Background, background_of, filled_background, lattice_vertices
from .lattice import Frame, Samples, frame_of, marked_cells, samples_of
from .sampling import LevelSet
from .warping import Edges

__all__ = ["isosurface_stuffing"]

Array = NDArray[np.float64]
TOLERANCE = 1e-10  # of the zeros on edges, as a share of the edge


def isosurface_stuffing(
    body: Any,
    size: Any,
    *,
    box: ArrayLike | None = None,
    tolerance: float | None = TOLERANCE,
    budget: int = MOST_LEAVES,
    progress: bool = False,
) -> DomainMesh:
    """Fill what a function bounds with tetrahedra whose dihedral angles are bounded."""
    root = as_box(box, 3)
    level_set = LevelSet(body, root)
    field, budget = as_size(size), as_count(budget, "budget")
    progress = as_flag(progress, "progress")
    cell = field.constant
    frame = frame_of(root, cell, DEEPEST_LEVEL[3])
    samples = samples_of(level_set, frame)
    wanted, inside = marked_cells(frame, samples, True)
    growth = grow(frame.root, [_with_keys(wanted, frame.level)], Limits(0, frame.level, budget))
    grid = _grid(balanced(growth.tree, "edges"), frame.root)
    vertices = lattice_vertices(grid)
    values, sign = _looked_up(frame, samples, grid, vertices[1])
    background = background_of(grid, vertices, sign)

    def shares(edges: Edges) -> Array:
        p = background.points
        return level_set.zeros(
            p[edges.inner], p[edges.outer], values[edges.inner], values[edges.outer], tolerance
        )

    filling = filled_background(background, shares)
    return DomainMesh(
        filling.points,
        filling.cells,
        counts={"moved": filling.moved, "cut points": filling.cut, "values": level_set.called},
    )


def _with_keys(keys: Keys, level: int) -> Rule:
    """Nodes that contain one of the cells of a level, given by their sorted keys."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        if nodes.level >= level:
            return np.zeros(len(nodes.keys), dtype=bool)
        shift = np.uint64(3 * (level - nodes.level))
        begin = np.searchsorted(keys, nodes.keys << shift)
        return begin < np.searchsorted(keys, (nodes.keys + np.uint64(1)) << shift)

    return rule


def _grid(tree: Linear, root: Array) -> Grid:
    leaves = leaves_of(tree)
    entry = table_of(leaves.first, tree.depth, 3)
    return Grid(leaves.first, leaves.levels, entry, root[0], root[1] - root[0], tree.depth)


def _looked_up(
    frame: Frame, samples: Samples, grid: Grid, place: NDArray[np.int64]
) -> tuple[Array, NDArray[np.int8]]:
    """Values and signs of the vertices of a tree; those far from the box are outside."""
    at = place * (1 << (frame.level - grid.depth)) - 2 * (frame.first - 1)
    values, signs = np.full(len(at), -1.0), np.full(len(at), -1, dtype=np.int8)
    for half, known, known_signs in (
        (0, samples.corner_values, samples.corner_signs),
        (1, samples.center_values, samples.center_signs),
    ):
        i = (at - half) >> 1
        here = ((at & 1) == half).all(axis=1) & (i >= 0).all(axis=1) & (i < known.shape).all(axis=1)
        x, y, z = i[here].T
        values[here], signs[here] = known[x, y, z], known_signs[x, y, z]
    return values, signs
