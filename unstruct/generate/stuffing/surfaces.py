"""A closed surface in place of a function: exact signs, and cut points on its triangles.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.triangle_pairs import points_on_triangles
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField
from ..tree.balancing import balanced
from ..tree.contacts import CUT, boundary_of
from ..tree.criteria import Level, Rule, by_size
from ..tree.growing import Limits, grow
from ..tree.keys import DEEPEST_LEVEL
from ..tree.linear import Linear
from ..tree.lookup import Grid, located
from .ending import nearest_on
from .filling import lattice_vertices
from .lattice import frame_of
from .laying import Laid, coarse_places, grid_of, refused_leaves, smallest_size
from .warping import Edges

__all__ = ["laid_in_surface"]

Array = NDArray[np.float64]
# A vertex that may move is the end of a crossed edge, of the length of a side; the leaves of its tetrahedra
# are at most so many sides away from the surface, along each axis.
REACH_OF_MOVES = 1.51
TOUCH = 0.01  # the share of the smallest side by which the surface may be beside a leaf where sizes vary
CROSSING_ROUNDING = 1e-9  # by which a cut point may lie outside of a triangle, as a share of its height


class Crossings(NamedTuple):
    """Edges that meet triangles: rows of edges, where on them, and by how much inside of the triangles."""

    edge: NDArray[np.int64]
    share: Array
    inside: Array


def laid_in_surface(domain: Domain, field: SizeField, graded: bool, limits: tuple[int, bool]) -> Laid:
    """The tree for a domain; `limits` are the budget of leaves and whether progress is shown."""
    budget, progress = limits
    shell = domain.triangulated
    points, triangles = shell.points, shell.bounding.astype(np.int64)
    places = np.concatenate([points, points[triangles].mean(axis=1)])
    if field.constant is None:
        grid_places = coarse_places(domain.bounds)
        places = np.concatenate([places, grid_places[domain.contains(grid_places)]])
    cell = smallest_size(field, places)
    frame = frame_of(domain.bounds, cell, DEEPEST_LEVEL[3])
    boundary = boundary_of(points, triangles, frame.root, domain.contains)
    graded = graded and field.constant is None
    met: list[tuple[Array, NDArray[np.int64]]] = []
    rules: list[Rule] = [by_size(field), _collecting(met)]
    if graded:
        boundary = boundary._replace(margin=TOUCH * cell)
    else:
        boundary = boundary._replace(margin=REACH_OF_MOVES * cell)
        rules.append(_cut_above(frame.level))
    growth = grow(frame.root, rules, Limits(0, frame.level, budget), boundary=boundary, progress=progress)
    if growth.reason.startswith("budget"):
        raise InputError(
            f"size = {cell:.6g} needs more leaves of the octree than the budget of {budget:,}; take a "
            "larger size"
        )

    def over(tree: Linear) -> Laid:
        grid = grid_of(tree, frame.root)
        vertices = lattice_vertices(grid)
        sign = _signs(domain, points, triangles, vertices[0])

        def shares(edges: Edges) -> Array:
            return _shares(points[triangles], vertices[0][edges.inner], vertices[0][edges.outer])

        samples = _surface_samples(points[triangles], met, grid)
        refused = refused_leaves(growth, grid, field)
        return Laid(grid, vertices, sign, shares, refused, field, tree, over, samples)

    return over(balanced(growth.tree, "edges"))


def _cut_above(level: int) -> Rule:
    """Nodes above a level that the boundary cuts."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        assert nodes.contacts is not None
        return (nodes.contacts.state == CUT) & (nodes.level < level)

    return rule


def _collecting(met: list[tuple[Array, NDArray[np.int64]]]) -> Rule:
    """No nodes; collects the pairs of a node's center and a triangle that comes near the node."""

    def rule(nodes: Level) -> NDArray[np.bool_]:
        assert nodes.contacts is not None
        met.append((nodes.centers[nodes.contacts.node], nodes.contacts.piece))
        return np.zeros(len(nodes.keys), dtype=bool)

    return rule


def _surface_samples(
    corners: Array, met: list[tuple[Array, NDArray[np.int64]]], grid: Grid
) -> tuple[Array, Array]:
    """Points of the triangles, one for each leaf in which they lie, and the sides of these leaves."""
    center, piece = (np.concatenate(part) for part in zip(*met, strict=True))
    x = nearest_on(center, corners, piece)
    side = float(grid.side[0]) * 0.5 ** grid.levels[located(grid, x)].astype(np.float64)
    near = np.abs(x - center).max(axis=1) <= 0.5 * side
    return x[near], side[near]


def _signs(domain: Domain, points: Array, triangles: NDArray[np.int64], x: Array) -> NDArray[np.int8]:
    """1 inside, 0 on the surface, -1 outside; exact."""
    sign = np.where(domain.contains(x), 1, -1).astype(np.int8)
    rows = np.arange(len(points), len(points) + len(x))
    on, _, _ = points_on_triangles(np.concatenate([points, x]), rows, triangles)
    sign[on - len(points)] = 0
    equal = _same_places(x, points)
    sign[equal] = 0
    return sign


def _same_places(x: Array, points: Array) -> NDArray[np.int64]:
    """The rows of x that are equal to one of some points."""
    both = np.ascontiguousarray(np.concatenate([points, x]) + 0.0).view(np.dtype((np.void, 24))).ravel()
    return np.flatnonzero(np.isin(both[len(points) :], both[: len(points)]))


def _crossings(corners: Array, begin: Array, end: Array) -> Crossings:
    """Edges (e, 3) and the triangles (t, 3, 3) whose planes they meet near them."""
    factor = power_of_two(np.concatenate([corners.reshape(-1, 3), begin, end]))
    corners, begin, end = corners * factor, begin * factor, end * factor
    tree = BoxTree(*bounding_boxes(corners))
    edge, hit = tree.pairs(np.minimum(begin, end), np.maximum(begin, end))
    a, b, c = corners[hit, 0], corners[hit, 1], corners[hit, 2]
    p, q = begin[edge], end[edge]
    normal = _cross(b - a, c - a)
    one, two = (normal * (p - a)).sum(axis=1), (normal * (q - a)).sum(axis=1)
    meets = ((one <= 0.0) & (two >= 0.0)) | ((one >= 0.0) & (two <= 0.0))
    meets &= one != two
    edge, a, b, c, normal = edge[meets], a[meets], b[meets], c[meets], normal[meets]
    p, q, one, two = p[meets], q[meets], one[meets], two[meets]
    share = np.clip(one / (one - two), 0.0, 1.0)
    x = p + share[:, None] * (q - p)
    square = (normal * normal).sum(axis=1)
    weights = [(normal * _cross(v - u, x - u)).sum(axis=1) / square for u, v in ((a, b), (b, c), (c, a))]
    return Crossings(edge, share, np.minimum(np.minimum(weights[0], weights[1]), weights[2]))


def _cross(u: Array, v: Array) -> Array:
    parts = [u[:, a - 2] * v[:, a - 1] - u[:, a - 1] * v[:, a - 2] for a in range(3)]
    return np.stack(parts, axis=1)


def _shares(corners: Array, begin: Array, end: Array) -> Array:
    """For each edge the first crossing, from its beginning; that which is least outside, if none is
    inside."""
    found = _crossings(corners, begin, end)
    outside = np.where(found.inside >= -CROSSING_ROUNDING, 0.0, -found.inside)
    order = np.lexsort((found.share, outside, found.edge))
    edge, first = np.unique(found.edge[order], return_index=True)
    result = np.full(len(begin), 0.5)
    result[edge] = found.share[order][first]
    return result
