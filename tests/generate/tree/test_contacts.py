"""States of cells: where boundaries meet them, against clipping in rational numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from trees import in_order, leaves, planted, unpacked

from unstruct import Domain, octree, quadtree
from unstruct.generate.tree.contacts import ALL_INSIDE, ALL_OUTSIDE, CUT, boundary_of
from unstruct.plain.tree import box, center
from unstruct.plain.tree_states import meets, state

NAMES = {ALL_INSIDE: "inside", CUT: "cut", ALL_OUTSIDE: "outside"}
# corners on corners, edges and faces of cells; a hole that touches faces of cells; an island in it
OUTLINE = [(1, 1), (15, 1), (15, 4), (8, 4), (8, 11), (13, 8), (12, 15), (4, 15), (4, 12), (1, 12)]
HOLE = [(2, 2), (6, 2), (6, 8), (2, 8)]
ISLAND = [(3, 3), (5, 4), (4, 7)]


def region(unit: float = 1 / 16, shift: float = 0.0) -> Domain:
    rings = [np.array(ring) * unit + shift for ring in (OUTLINE, HOLE, ISLAND)]
    ends, start = [], 0
    for ring in rings:
        rows = start + np.arange(len(ring))
        ends += list(zip(rows, np.roll(rows, -1), strict=True))
        start += len(ring)
    return Domain(np.concatenate(rings), ends)


def rational(domain: Domain) -> list:
    return [[tuple(map(Fraction, p)) for p in row] for row in domain.points[domain.facets].tolist()]


def within(tree, domain: Domain):
    straight = domain.triangulated if domain.dimension == 3 else domain
    pieces = straight.bounding if domain.dimension == 3 else domain.facets
    tree.domain, tree.boundary = domain, boundary_of(straight.points, pieces, tree.box, domain.contains)
    return tree


@settings(max_examples=30)
@given(leaves(2))
def test_planar_states(cells: frozenset) -> None:
    domain = region()
    tree = within(planted(cells, 2), domain)
    pieces = rational(domain)
    order = {cell: NAMES[int(s)] for cell, s in zip(in_order(tree), tree.states, strict=True)}
    assert order == {cell: state(pieces, cell) for cell in unpacked(tree)}


@pytest.mark.parametrize("shift", [0.0, 0.1, 1e8])
def test_states_of_a_grown_tree(shift: float) -> None:
    """Boxes of any corners, also far from the origin: the cells have rounded corners."""
    domain = region(0.3, shift)
    tree = quadtree(domain, boundary_size=0.2)
    low, high = tree.corners
    pieces = rational(domain)
    for row in range(0, len(tree), 7):
        cut = any(meets(piece, low[row].tolist(), high[row].tolist()) for piece in pieces)
        assert cut == (tree.states[row] == CUT)
    inside = domain.contains(tree.centers)
    whole = tree.states != CUT
    assert (inside[whole] == (tree.states[whole] == ALL_INSIDE)).all()
    assert {*tree.states.tolist()} == {-1, 0, 1}


def notched() -> Domain:
    around = [(2, 2), (14, 2), (14, 14), (10, 14), (8, 6), (6, 14), (2, 14)]
    points = [(x / 16, y / 16, z / 16) for z in (4, 12) for x, y in around]
    n = len(around)
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    return Domain(points, [list(range(n))[::-1], list(range(n, 2 * n)), *sides])


@settings(max_examples=15)
@given(leaves(3, deepest=4, targets=2))
def test_states_in_space(cells: frozenset) -> None:
    domain = notched()
    tree = within(planted(cells, 3), domain)
    shell = domain.triangulated
    pieces = [[tuple(map(Fraction, p)) for p in row] for row in shell.points[shell.bounding].tolist()]
    for cell, found in zip(in_order(tree), tree.states, strict=True):
        cut = any(meets(piece, *box(cell)) for piece in pieces)
        assert cut == (found == CUT)
        if not cut:
            assert bool(domain.contains(np.array(center(cell), dtype=float))) == (found == ALL_INSIDE)


def test_a_body_far_away_and_flat() -> None:
    """Extents of 1 and of a thousandth, at coordinates of 1e6."""
    domain = Domain.box((1e6, 1e6, 1e6), (1e6 + 1, 1e6 + 2, 1e6 + 1e-3))
    tree = octree(domain, boundary_size=0.3)
    assert (tree.states >= 0).any() and tree.complete
    low, high = tree.corners
    touching = ((low < domain.bounds[1]) & (high > domain.bounds[0])).all(axis=1)
    assert (touching == (tree.states >= 0)).all()


def test_pieces_on_faces_of_cells_meet_no_inside() -> None:
    """The four cells of a square in a box of twice its side: one is inside, none is cut."""
    domain = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
    tree = quadtree(domain, box=[(0, 0), (2, 2)], min_level=1)
    assert tree.states.tolist() == [1, -1, -1, -1]
    tree = quadtree(domain, box=[(0, 0), (2, 2)], min_level=1, size=0.25)
    assert (tree.states == 1).sum() == 16 and (tree.states == 0).sum() == 0


def test_one_leaf_is_cut() -> None:
    tree = quadtree(region())
    assert len(tree) == 1 and tree.states.tolist() == [CUT]
    assert quadtree([(0, 0), (1, 1)]).states.tolist() == [ALL_INSIDE]


def test_refined_and_balanced_trees_keep_the_boundary() -> None:
    domain = region()
    tree = quadtree(domain, boundary_size=0.1, balance=None)
    for other in (tree.balanced(), tree.refined(tree.states == CUT), tree.prefix(3), tree.coarsened([])):
        pieces = rational(domain)
        low, high = other.corners
        cut = [any(meets(p, a, b) for p in pieces) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
        assert cut == (other.states == CUT).tolist() and other.domain is domain
