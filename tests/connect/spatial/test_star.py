"""Stars in a complex with marked faces and numbered edges: found, judged, made, or nothing changed."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import torus

from unstruct.connect.spatial.complex import SpatialComplex
from unstruct.connect.spatial.numbered import forget_edge, new_numbered, number_edge, number_of_edge
from unstruct.connect.spatial.opening import (
    FACES_OPEN,
    STAR_CELLS,
    STAR_SEEDS,
    close_faces,
    new_star,
    open_face,
    walk_within,
)
from unstruct.connect.spatial.star import commit_star, room_for_star, search_star


def in_sphere(corners: list, p: list) -> bool:
    """Whether p is strictly inside the sphere of a positive tetrahedron, in rational numbers."""
    rows = [[Fraction(float(x)) - Fraction(float(y)) for x, y in zip(row, p)] for row in corners]
    matrix = [[*row, sum(x * x for x in row)] for row in rows]
    return det(matrix) < 0


def det(m: list) -> Fraction:
    if len(m) == 1:
        return m[0][0]
    minors = ([row[:j] + row[j + 1 :] for row in m[1:]] for j in range(len(m)))
    return sum(((-1) ** j * m[0][j] * det(minor) for j, minor in enumerate(minors)), Fraction(0))


def spheres_with(cells: SpatialComplex, p: int) -> set[int]:
    """The slots whose open sphere contains vertex p."""
    slots = np.flatnonzero(cells.used())
    rows = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[slots]
    x = cells.xyz
    return {int(t) for t, row in zip(slots, rows) if in_sphere(x[row].tolist(), x[p].tolist())}


def edges_of(cells: SpatialComplex):
    return new_numbered(64, len(cells.xyz))


@settings(deadline=None, max_examples=30)
@given(st.lists(st.tuples(*[st.integers(0, 6)] * 3), min_size=6, max_size=14, unique=True))
def test_without_marks_the_cavity_is_that_of_bowyer_and_watson(points: list) -> None:
    rows = np.array(points, dtype=float)
    if np.linalg.matrix_rank(rows[2:] - rows[0]) < 3:
        return
    cells = SpatialComplex(rows[1:])
    cells.reserve(cells.size + 1, cells.slots + 200)
    p = cells.size
    cells.xyz[p] = rows[0] * cells.factor
    star, edges = new_star(len(cells.stamp), len(cells.xyz)), edges_of(cells)
    found = walk_within(cells.solid(), int(np.flatnonzero(cells.used())[0]), p)
    assert found >= 0
    star.cells[0], star.sizes[STAR_SEEDS], star.sizes[FACES_OPEN] = found, 1, 0
    assert search_star(cells.solid(), star, edges, p, -1)
    assert set(star.cells[: star.sizes[STAR_CELLS]].tolist()) == spheres_with(cells, p)
    assert room_for_star(cells.solid(), star)
    commit_star(cells.solid(), star, p)
    cells.size += 1
    cells.validate()


def test_a_walk_stops_at_marked_faces_and_opened_faces_are_closed_again() -> None:
    points, faces = torus(12, 6)
    cells = SpatialComplex(points)
    assert cells.recover(faces).exact
    cells.flood()
    cells.reserve(cells.size + 1, cells.slots + 500)
    p, solid = cells.size, cells.solid()
    inside = int(np.flatnonzero(cells.used() & (cells.region[: cells.slots] >= 0))[0])
    cells.xyz[p] = 0.0  # in the hole
    found = walk_within(solid, inside, p)
    assert found < 0 and cells.mark[-1 - found] >= 0
    star, before = new_star(len(cells.stamp), len(cells.xyz)), cells.mark[: 4 * cells.slots].copy()
    star.sizes[FACES_OPEN] = 0
    assert open_face(solid, star, -1 - found) and (cells.mark[: 4 * cells.slots] <= -2).sum() == 2
    star.cells[0], star.sizes[STAR_SEEDS] = inside, 1
    assert not search_star(solid, star, edges_of(cells), p, -1)
    close_faces(solid, star)
    assert np.array_equal(cells.mark[: 4 * cells.slots], before)
    cells.validate()


def test_numbered_edges() -> None:
    edges = new_numbered(8, 10)
    number_edge(edges, 3, 1, 5)
    number_edge(edges, 1, 4, 6)
    assert number_of_edge(edges, 1, 3) == 5 and number_of_edge(edges, 4, 1) == 6
    forget_edge(edges, 1, 3)
    assert number_of_edge(edges, 3, 1) == -1 and edges.degree.tolist()[:5] == [0, 1, 0, 0, 1]
    assert number_of_edge(edges, 0, 9) == -1
