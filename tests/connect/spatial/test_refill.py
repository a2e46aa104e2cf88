"""Refilling compared with all triangulations of the cavity, and exact tests of segments and triangles."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from unstruct.connect.spatial.arrays import CellArrays
from unstruct.connect.spatial.cavity import beside, commit, corner, grow, load
from unstruct.connect.spatial.costs import ANY, DEGREE, EDGE, NEVER
from unstruct.connect.spatial.held import hold, holds, new_held
from unstruct.connect.spatial.records import (
    COST_KIND,
    HASH,
    LOCALS,
    NEW_CELLS,
    NODES,
    OLD_CELLS,
    TARGET,
    new_local,
)
from unstruct.connect.spatial.refill import refill
from unstruct.connect.spatial.signs import DISJOINT, meets
from unstruct.plain import refilling as plain
from unstruct.plain.predicates import orient

GRID = st.lists(
    st.tuples(*[st.integers(0, 3)] * 3), min_size=5, max_size=9, unique=True
)  # many coplanar, collinear and cospherical points


def cells_of(c: CellArrays, slots: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(c.vertex[4 * t : 4 * t + 4].tolist()) for t in slots}


def test_faces_are_positive() -> None:
    faces = plain.faces_of((0, 1, 2, 3))
    for k in range(4):
        x, y, z = (int(corner(k, i)) for i in range(3))
        assert {(x, y, z), (y, z, x), (z, x, y)} & faces


@settings(deadline=None, max_examples=80)
@given(GRID, st.integers(0, 1000), st.integers(5, 7))
def test_the_cheapest_refill(points: list[tuple[int, int, int]], choice: int, wanted: int) -> None:
    c, r, held = CellArrays(np.array(points, dtype=float)), new_local(), new_held(4)
    n = len(points)
    exact = [tuple(map(float, row)) for row in c.xyz[: c.size]]
    a, b = choice % n, (choice // n + choice % n + 1) % n
    assume(a != b)
    r.size[COST_KIND], r.size[TARGET], r.size[TARGET + 1] = EDGE, a, b
    assume(beside(c.solid(), r, choice % (4 * c.slots)) and grow(c.solid(), r, 2, wanted, 2))
    faces, cost = load(c.solid(), held, r)
    old = cells_of(c, r.cells[: r.size[OLD_CELLS]])
    used = {v for cell in old for v in cell}
    assert r.size[LOCALS] == len(used) and cost == price(exact, old, a, b)
    r.size[HASH] = -1
    found = refill(c.xyz, r, c.state, faces, NEVER, -1.0, 10**6)
    every = [
        new for new in plain.refills(exact, plain.walls_of(old), inner=used)
        if {v for cell in new for v in cell} == used
    ]  # fmt: skip
    assert found == min(price(exact, new, a, b) for new in every)
    new = {tuple(r.label[r.best[i]].tolist()) for i in range(r.size[NEW_CELLS])}
    assert plain.walls_of(new) == plain.walls_of(old)
    assert all(orient([exact[v] for v in cell]) > 0 for cell in new)
    assert frozenset(map(frozenset, new)) in {frozenset(map(frozenset, cells)) for cells in every}


def price(points: list, cells: set, a: int, b: int) -> int:
    """How many triangles between the cells meet the segment."""
    inner = {face for cell in cells for face in plain.faces_of(cell)} - plain.walls_of(cells)
    return len({frozenset(face) for face in inner if plain.meets(points, a, b, face)})


@settings(deadline=None, max_examples=300)
@given(st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=5, max_size=5, unique=True))
def test_segments_and_triangles(points: list[tuple[int, int, int]]) -> None:
    xyz = np.array(points, dtype=float) / 8
    for a, b, u, v, w in [(0, 1, 2, 3, 4), (0, 1, 0, 2, 3), (3, 1, 2, 3, 4), (0, 1, 0, 1, 2)]:
        if not any(e not in (u, v, w) and in_triangle(points, e, u, v, w) for e in (a, b)):
            assert (meets(xyz, a, b, u, v, w) != DISJOINT) == plain.meets(points, a, b, (u, v, w))


def in_triangle(points: list[tuple[int, int, int]], e: int, u: int, v: int, w: int) -> bool:
    """Whether vertex e is on the triangle, as in no triangulation, or the triangle is flat."""
    p, x = np.array(points[e]), np.array([points[u], points[v], points[w]])
    normal = np.cross(x[1] - x[0], x[2] - x[0])
    if not normal.any():
        return True
    sides = [np.cross(x[(k + 1) % 3] - x[k], p - x[k]) @ normal for k in range(3)]
    return bool((p - x[0]) @ normal == 0 and min(sides) >= 0)


def test_held_edges_stay() -> None:
    """Two cells at a face become three around an edge between the tips, and back, unless it is held."""
    points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 3], [1, 1, -3], [1, 1, 0.5]])[:5]
    c, r, held = CellArrays(points), new_local(), new_held(8)
    r.size[COST_KIND] = ANY
    rows = c.vertex[: 4 * c.slots].reshape(-1, 4)
    (face,) = [
        4 * t + k for t in range(c.slots) for k in range(4)
        if set(np.delete(rows[t], k)) == {0, 1, 2} and rows[t, k] == 3
    ] or [-1]  # fmt: skip
    if face < 0:  # the Delaunay triangulation has the edge already
        assert any({3, 4} <= set(row) for row in rows.tolist())
        face = next(
            4 * t + k
            for t, row in enumerate(rows.tolist())
            for k in range(4)
            if row[k] == 0 and {3, 4} < set(row)
        )
    assert beside(c.solid(), r, face) and grow(c.solid(), r, 2, 5, 0)
    faces, cost = load(c.solid(), held, r)
    assert cost == 0
    assert refill(c.xyz, r, c.state, faces, 1.0, 0.0, 1000) == 0.0  # another one than is there
    hold(held, 3, 4, 1)
    assert holds(held, 4, 3) and not holds(held, 0, 1)
    if any({3, 4} <= set(row) for row in rows.tolist()):
        faces, _ = load(c.solid(), held, r)
        assert refill(c.xyz, r, c.state, faces, 1.0, 0.0, 1000) == NEVER
    hold(held, 3, 4, 0)
    assert not holds(held, 3, 4)


def test_fewer_cells_at_a_vertex() -> None:
    """Refills that lower the degree of a point in the middle of a cloud end with a valid complex."""
    rng = np.random.default_rng(5)
    c, r, held = (
        CellArrays(np.concatenate([[[0.5, 0.5, 0.5]], rng.random((40, 3))])),
        new_local(),
        new_held(4),
    )
    c.reserve(c.size, 4 * c.slots)
    r.size[COST_KIND], r.size[TARGET], r.size[TARGET + 1] = DEGREE, 0, -1
    before = int((c.cells() == 0).any(axis=1).sum())
    for wanted in (5, 6, 7):
        for t in range(c.slots):
            for face in range(4 * t, 4 * t + 4):
                if c.vertex[4 * t] >= 0 and beside(c.solid(), r, face) and grow(c.solid(), r, 2, wanted, 0):
                    faces, cost = load(c.solid(), held, r)
                    if cost < NEVER and refill(c.xyz, r, c.state, faces, cost, 0.0, 300) < NEVER:
                        commit(c.solid(), r)
    assert int((c.cells() == 0).any(axis=1).sum()) < before and r.size[NODES] > 0
    c.validate()
