"""The trees under the background: fine at the surface, as coarse inside as the size wants.

See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...sizing.field import SizeField
from ..tree.balancing import balanced
from ..tree.criteria import Level, Rule, by_size
from ..tree.growing import Growth, Limits, grow
from ..tree.keys import DEEPEST_LEVEL, Keys, coordinates_of
from ..tree.linear import Linear, leaves_of
from ..tree.lookup import Grid, corners, table_of
from ..tree.vertices import Vertices
from .filling import lattice_vertices
from .lattice import Frame, Samples, frame_of, marked_cells, samples_of
from .sampling import LevelSet
from .warping import Edges

__all__ = ["Laid", "coarse_places", "grid_of", "laid_in_level_set", "refused_leaves", "smallest_size"]

Array = NDArray[np.float64]
LatticeVertices = tuple[Array, NDArray[np.int64], Vertices]
SIZE_SLACK = 1.1  # a size may be so much smaller than a cell that nothing is told
COARSE_GRID = 33  # vertices along each side of a box, where a size is asked before there is a lattice


class Laid(NamedTuple):
    """An octree with the signs of its vertices.

    Attributes
    ----------
    grid : Grid
    vertices : tuple
        As `lattice_vertices` returns them.
    sign : (n,) int8
    shares : callable
        Where the surface cuts edges.
    refused : (k,) int64
        Leaves that the size would have divided.
    field : SizeField
    tree : Linear
    over : callable
        The same over another tree, from this one by further divisions.
    samples : (x, side), optional
        Points of the surface (q, 3), and the sides of the leaves there (q,).
    """

    grid: Grid
    vertices: LatticeVertices
    sign: NDArray[np.int8]
    shares: Callable[[Edges], Array]
    refused: NDArray[np.int64]
    field: SizeField
    tree: Linear
    over: Callable[[Linear], Laid]
    samples: tuple[Array, Array] | None = None


def _with_keys(keys: Keys, level: int) -> Rule:
    """Nodes above a level that contain one of its cells, given by their sorted keys."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        if nodes.level >= level:
            return np.zeros(len(nodes.keys), dtype=bool)
        return _holding(nodes, keys, level)

    return rule


def _holding(nodes: Level, keys: Keys, level: int) -> NDArray[np.bool_]:
    """Which nodes contain a cell of a deeper level, or are one."""
    shift = np.uint64(3 * (level - nodes.level))
    begin = np.searchsorted(keys, nodes.keys << shift)
    return begin < np.searchsorted(keys, (nodes.keys + np.uint64(1)) << shift)


def grid_of(tree: Linear, root: Array) -> Grid:
    """The leaves of a tree."""
    leaves = leaves_of(tree)
    entry = table_of(leaves.first, tree.depth, 3)
    return Grid(leaves.first, leaves.levels, entry, root[0], root[1] - root[0], tree.depth)


def refused_leaves(growth: Growth, grid: Grid, field: SizeField) -> NDArray[np.int64]:
    """The leaves in which the size asks for more than there is room for, by more than a tenth."""
    if not growth.refused:
        return np.empty(0, dtype=np.int64)
    first = [keys << np.uint64(3 * (grid.depth - level)) for level, keys in growth.refused.items()]
    rows = np.flatnonzero(np.isin(grid.first, np.concatenate(first)))
    side = float(grid.side[0]) * 0.5 ** grid.levels[rows].astype(np.float64)
    low = corners(grid.low, grid.side, coordinates_of(grid.first[rows], 3), grid.depth)
    return rows[side > SIZE_SLACK * field(low + 0.5 * side[:, None])]


def smallest_size(field: SizeField, places: Array) -> float:
    """The least size at some places, and at landmarks."""
    if field.constant is not None:
        return float(field.constant)
    marks = field.landmarks if field.landmarks.shape[1] == 3 else np.empty((0, 3))
    return float(field(np.concatenate([places, marks])).min())


def coarse_places(box: Array) -> Array:
    """A grid over a box: (k, 3)."""
    axes = [np.linspace(box[0, a], box[1, a], COARSE_GRID) for a in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _within_budget(cells: float, budget: int, size: float) -> None:
    if cells > budget:
        raise InputError(
            f"a lattice with cells of size {size:.6g} has about {cells:,.0f} cells in the box, more than the "
            f"budget of {budget:,}; take a larger size or a smaller box"
        )


def laid_in_level_set(
    body: LevelSet, field: SizeField, graded: bool, tolerance: float | None, limits: tuple[int, bool]
) -> Laid:
    """The tree for a level set; `limits` are the budget of leaves and whether progress is shown."""
    budget, progress = limits
    cell = _cell_of_level_set(body, field)
    frame = frame_of(body.box, cell, DEEPEST_LEVEL[3])
    if graded and field.constant is None:
        growth = grow(
            frame.root,
            [_meeting(body.box, by_size(field))],
            Limits(0, frame.level, budget),
            progress=progress,
        )

        def asked(grid: Grid, vertices: LatticeVertices) -> tuple[Array, NDArray[np.int8]]:
            return _asked_at(body, vertices[0])

    else:
        _within_budget(float(np.prod(frame.cells.astype(np.float64))), budget, cell)
        samples = samples_of(body, frame)
        wanted, inside = marked_cells(frame, samples, field.constant is not None)
        rules = [_with_keys(wanted, frame.level)]
        if field.constant is None:
            rules.append(_inner(inside, frame.level, by_size(field)))
        growth = grow(frame.root, rules, Limits(0, frame.level, budget), progress=progress)

        def asked(grid: Grid, vertices: LatticeVertices) -> tuple[Array, NDArray[np.int8]]:
            return _looked_up(frame, samples, grid, vertices[1])

    def over(tree: Linear) -> Laid:
        grid = grid_of(tree, frame.root)
        vertices = lattice_vertices(grid)
        points, (values, sign) = vertices[0], asked(grid, vertices)
        _refuse_masses_of_zeros(points, vertices[2].corners, sign)

        def shares(edges: Edges) -> Array:
            ends = points[edges.inner], points[edges.outer]
            return body.zeros(*ends, values[edges.inner], values[edges.outer], tolerance)

        return Laid(grid, vertices, sign, shares, refused_leaves(growth, grid, field), field, tree, over)

    return over(balanced(growth.tree, "edges"))


def _refuse_masses_of_zeros(points: Array, corners: NDArray[np.int32], sign: NDArray[np.int8]) -> None:
    """Raise if a function is zero in whole leaves beside the body, and negative nowhere near.

    Zeros are taken to be on the surface, so that the body would grow by up to a cell. Zeros that are on a
    surface have negative neighbors; those between two parts of the body fill no leaf; and a function may be
    zero far from the body.
    """
    centers = len(sign) - len(corners)
    low = np.minimum(sign[corners].min(axis=1), sign[centers:])
    high = np.maximum(sign[corners].max(axis=1), sign[centers:])
    zero = (low == 0) & (high == 0)
    if not zero.any():
        return
    flags = np.zeros((3, centers), dtype=bool)  # of corners: in a leaf of zeros, by a positive, by a negative
    for flag, leaves in zip(flags, (zero, high > 0, low < 0), strict=True):
        flag[corners[leaves].ravel()] = True
    bad = np.flatnonzero(flags[0] & flags[1] & ~flags[2])
    if len(bad):
        raise InputError(
            f"the function of the body is exactly 0 at {points[bad[0]].tolist()} and in a whole cell beside "
            "it, next to the body: it must be negative outside, and 0 on the surface only; of a function "
            "that is 1 inside and 0 outside, subtract 0.5"
        )


def _cell_of_level_set(body: LevelSet, field: SizeField) -> float:
    """The least size in the body or near it."""
    if field.constant is not None:
        return float(field.constant)
    places = coarse_places(body.box)
    inside = (body(places) >= 0.0).reshape((COARSE_GRID,) * 3)
    near = inside.copy()
    for axis in range(3):  # and the neighbors, between which the surface lies
        moved = np.moveaxis(near, axis, 0)
        grown = moved.copy()
        grown[1:] |= moved[:-1]
        grown[:-1] |= moved[1:]
        near = np.moveaxis(grown, 0, axis)
    chosen = near.ravel()
    return smallest_size(field, places[chosen] if chosen.any() else places)


def _meeting(box: Array, rule: Rule) -> Rule:
    """The rule, for nodes that meet a box."""

    def both(nodes: Level) -> NDArray[np.bool_]:
        low, high = nodes.boxes
        return rule(nodes) & ((low <= box[1]) & (high >= box[0])).all(axis=1)

    return both


def _inner(keys: Keys, level: int, rule: Rule) -> Rule:
    """The rule, for nodes with a vertex inside."""
    return lambda nodes: rule(nodes) & _holding(nodes, keys, level)


def _asked_at(body: LevelSet, points: Array) -> tuple[Array, NDArray[np.int8]]:
    """Values and signs at the vertices of a tree; those outside of the box are outside of the body.

    Raises
    ------
    InputError
        If the function is positive on the boundary of the box.
    """
    values = np.full(len(points), -1.0)
    far = np.abs(points - np.clip(points, *body.box)).max(axis=1)
    asked = np.flatnonzero(far <= 0.5 * float((body.box[1] - body.box[0]).max()))
    values[asked] = body(points[asked])
    beyond = ((points <= body.box[0]) | (points >= body.box[1])).any(axis=1) & (values > 0.0)
    if beyond.any():
        row = int(np.argmax(beyond))
        place = np.clip(points[row], *body.box).tolist()
        raise InputError(
            f"the function is positive at {place}, on the boundary of the box: take a larger box, or cap=True"
        )
    return values, np.sign(values).astype(np.int8)


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
