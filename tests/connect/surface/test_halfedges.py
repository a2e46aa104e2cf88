"""Half-edges of surfaces: random splits, flips and collapses beside counting of all sides."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain
from unstruct.connect.insertion.halfedges import UNUSED, next_edge, prev_edge
from unstruct.connect.surface.complex import SurfaceComplex
from unstruct.connect.surface.halfedges import (
    ALONG_CURVE,
    CORNER,
    SURFACE_SLOTS,
    can_collapse,
    can_flip,
    collapse_edge,
    flip_edge,
    split_edge,
    split_triangle,
)

NO_EDGES, NONE = np.empty((0, 2), dtype=np.int32), np.empty(0, dtype=np.int32)


def surface(kind: str) -> tuple[np.ndarray, np.ndarray]:
    body = Domain.torus(size=0.6) if kind == "torus" else Domain.ball(size=0.6)
    points, triangles = np.array(body.points), np.array(body.triangulated.triangles)
    if kind == "open":
        triangles = triangles[points[triangles][:, :, 2].mean(axis=1) > -0.2]
    return points, triangles


def made(points: np.ndarray, triangles: np.ndarray) -> SurfaceComplex:
    return SurfaceComplex(points, triangles, NO_EDGES, NONE, NONE)


def shape_of(triangles: np.ndarray) -> tuple[int, int, int, int]:
    """By counting alone: Euler characteristic, boundary edges, edges not of one or two sides, bad links."""
    sides: Counter = Counter()
    link: dict[int, Counter] = {}
    for row in triangles.tolist():
        assert len(set(row)) == 3
        for k in range(3):
            sides[frozenset((row[k], row[k - 1]))] += 1
            ends = link.setdefault(row[k], Counter())
            ends[row[k - 1]] += 1
            ends[row[k - 2]] += 1
    assert len({frozenset(row) for row in triangles.tolist()}) == len(triangles)
    directed = Counter((row[k], row[k - 2]) for row in triangles.tolist() for k in range(3))
    assert max(directed.values()) == 1
    bad = sum(1 for ends in link.values() if max(ends.values()) > 2 or sum(n == 1 for n in ends.values()) > 2)
    euler = len(link) - len(sides) + len(triangles)
    return euler, sum(n == 1 for n in sides.values()), sum(n > 2 for n in sides.values()), bad


def is_consistent(complex: SurfaceComplex) -> bool:
    s = complex.sheets
    for e in range(3 * int(s.state[SURFACE_SLOTS])):
        if s.vertex[e - e % 3] == UNUSED:
            continue
        f = s.twin[e]
        if s.vertex[s.at[s.vertex[e]]] != s.vertex[e]:
            return False
        if f >= 0 and (
            s.twin[f] != e
            or s.vertex[next_edge(f)] != s.vertex[prev_edge(e)]
            or s.vertex[prev_edge(f)] != s.vertex[next_edge(e)]
            or s.curve[e] != s.curve[f]
        ):
            return False
    return True


@pytest.mark.parametrize("kind", ["ball", "torus", "open"])
@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 6))
def test_changes_keep_the_surface(kind: str, seed: int, collapses: int) -> None:
    complex = made(*surface(kind))
    before = shape_of(complex.taken().triangles)
    rng = np.random.default_rng(seed)
    for i in range(300):
        complex.grow(1, 2)
        s = complex.sheets
        e = int(rng.integers(3 * int(s.state[SURFACE_SLOTS])))
        if s.vertex[e - e % 3] == UNUSED:
            continue
        what = int(rng.integers(3 + collapses))
        if what == 0:
            split_edge(s, e)
        elif what == 1:
            split_triangle(s, e // 3)
        elif what == 2 and can_flip(s, e):
            flip_edge(s, e)
        elif what > 2 and can_collapse(s, e):
            collapse_edge(s, e)
        if i % 60 == 0:
            assert is_consistent(complex)
    assert is_consistent(complex)
    after = shape_of(complex.taken().triangles)
    assert (after[0], after[2], after[3]) == (before[0], 0, 0)
    assert (after[1] > 0) == (before[1] > 0)


def test_a_tetrahedron_is_not_collapsed() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    complex = made(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32))
    for e in range(12):
        assert not can_collapse(complex.sheets, e)
        assert not can_flip(complex.sheets, e)


def test_a_single_triangle_is_not_collapsed() -> None:
    complex = made(np.eye(3), np.array([[0, 1, 2]], dtype=np.int32))
    assert not any(can_collapse(complex.sheets, e) for e in range(3))


def test_copies_of_a_vertex_are_corners_and_one_again() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    complex = made(points, np.array([[0, 1, 2], [0, 3, 4]], dtype=np.int32))
    assert len(complex.master) == 6 and complex.master[5] == 0
    assert complex.sheets.kind[0] == CORNER and complex.sheets.kind[5] == CORNER
    assert complex.sheets.kind[1] == ALONG_CURVE
    taken = complex.taken()
    assert len(taken.points) == 5 and (taken.triangles == [[0, 1, 2], [0, 3, 4]]).all()


def test_three_sheets_are_three_parts_of_boundaries() -> None:
    points = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    complex = made(points, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], dtype=np.int32))
    assert (complex.sheets.twin < 0).all()
    assert sorted(complex.master[5:].tolist()) == [0, 0, 1, 1]
    assert len(complex.taken().points) == 5


def test_features_keep_their_curves() -> None:
    points, triangles = surface("ball")
    edges = np.array([triangles[0, :2], triangles[0, 1:]], dtype=np.int32)
    complex = SurfaceComplex(points, triangles, edges, np.array([3, 7], dtype=np.int32), edges[:1, 0])
    complex.grow(2, 4)
    s = complex.sheets
    for curve in (3, 7):
        split_edge(s, int(np.flatnonzero(s.curve == curve)[0]))
    taken = complex.taken()
    assert Counter(taken.curves.tolist()) == {3: 2, 7: 2}
    assert s.kind[edges[0, 0]] == CORNER and s.kind[len(points)] == ALONG_CURVE and s.on[len(points)] == 3
