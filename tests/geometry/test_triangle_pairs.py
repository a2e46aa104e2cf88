"""Edges and triangles that meet, in every way there is, beside rational arithmetic that shares no code."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rational_space import cross, dot, in_triangle, minus, on_segment, rational, share_in_triangle

from unstruct import InputError
from unstruct.geometry.triangle_pairs import (
    EDGES_CROSS,
    OVERLAP,
    PIERCES,
    VERTEX_ON_EDGE,
    VERTEX_ON_TRIANGLE,
    clear_view,
    crossing_segments,
    edges_of,
    meetings_in_space,
    points_on_edges,
    points_on_triangles,
)

NUDGE = 2.0**-52
WIDE = [0.0, 1.0, -1.0, 2.0**-30, 2.0**-60, 3 * 2.0**-200, 1 - NUDGE, 1 + NUDGE]


@st.composite
def corners(draw: st.DrawFn) -> np.ndarray:
    """Five or six different points: of a small grid, beside one by the last bit, or of wide exponents."""
    many = draw(st.integers(5, 6))
    kind = draw(st.sampled_from(["grid", "bits", "tenths", "wide"]))
    if kind == "wide":
        numbers = st.sampled_from(WIDE)
        rows = draw(st.lists(st.tuples(numbers, numbers, numbers), min_size=many, max_size=many, unique=True))
        return np.array(rows)
    numbers = st.integers(0, 2)
    rows = draw(st.lists(st.tuples(numbers, numbers, numbers), min_size=many, max_size=many, unique=True))
    points = np.array(rows, dtype=float)
    if kind == "tenths":
        points = points * 0.1 + 0.3
    if kind == "bits":
        bits = draw(st.lists(st.sampled_from([-1, 0, 0, 1]), min_size=3 * many, max_size=3 * many))
        points = (points + 1) * (1 + NUDGE * np.array(bits).reshape(-1, 3))
    return points


def wanted(points: list, p: int, q: int, triangle: tuple[int, ...]) -> set[tuple[int, int]]:
    """The answers that are right: kind and vertex; none if they only meet in common vertices."""
    x, y, (a, b, c) = points[p], points[q], (points[v] for v in triangle)
    share = share_in_triangle(x, y, a, b, c)
    if share is None:
        return set()
    on_edge = {
        (VERTEX_ON_EDGE, v) for v in (p, q) if v not in triangle and in_triangle(points[v], a, b, c) == "edge"
    } | {(VERTEX_ON_EDGE, v) for v in triangle if v not in (p, q) and on_segment(points[v], x, y)}
    if share[0] < share[1]:
        if {p, q} <= set(triangle):
            return set()
        # between common vertices there is only an edge; all else has a vertex or a crossing
        return on_edge | {(OVERLAP, -1)}
    at = tuple(u + share[0] * (v - u) for u, v in zip(x, y))
    if any(points[v] == at for v in {p, q} & set(triangle)):
        return set()
    if on_edge:
        return on_edge
    for v in (p, q):
        if points[v] == at:
            return {(VERTEX_ON_TRIANGLE, v)}
    return {(PIERCES if in_triangle(at, a, b, c) == "inside" else EDGES_CROSS, -1)}


@settings(max_examples=25)
@given(corners())
def test_every_meeting_is_that_of_rational_arithmetic(points: np.ndarray) -> None:
    exact = [rational(row) for row in points.tolist()]
    triples = [
        t
        for t in combinations(range(len(points)), 3)
        if any(cross(minus(exact[t[1]], exact[t[0]]), minus(exact[t[2]], exact[t[0]])))
    ]
    if not triples:
        return
    rng = np.random.default_rng(len(triples))
    triangles = np.array([rng.permutation(t) for t in triples], dtype=np.int32)
    edges = np.array(list(combinations(range(len(points)), 2)), dtype=np.int32)
    met = meetings_in_space(points, triangles, edges)
    found = {(e, t): (k, v) for e, t, k, v in zip(*map(np.ndarray.tolist, met))}
    assert len(found) == len(met.edge)
    for e, (p, q) in enumerate(edges.tolist()):
        for t, triangle in enumerate(triangles.tolist()):
            right = wanted(exact, p, q, tuple(triangle))
            assert found[e, t] in right if right else (e, t) not in found


@settings(max_examples=25)
@given(corners())
def test_points_and_segments(points: np.ndarray) -> None:
    exact = [rational(row) for row in points.tolist()]
    rows = np.arange(len(points))
    edges = np.array(list(combinations(range(len(points)), 2)), dtype=np.int32)
    found = {*zip(*map(np.ndarray.tolist, points_on_edges(points, rows, edges)))}
    assert found == {
        (v, e)
        for v in range(len(points))
        for e, (p, q) in enumerate(edges.tolist())
        if on_segment(exact[v], exact[p], exact[q])
    }
    crossing = {*zip(*map(np.ndarray.tolist, crossing_segments(points, edges)))}
    assert crossing == {
        (s, t)
        for s, t in combinations(range(len(edges)), 2)
        if _cross(*(exact[v] for v in (*edges[s], *edges[t])))
    }
    for triangle in combinations(range(len(points)), 3):
        a, b, c = (exact[v] for v in triangle)
        flat = not any(cross(minus(b, a), minus(c, a)))
        assert (clear_view(points, *triangle) < 0) == flat
        if flat:
            continue
        on = points_on_triangles(points, rows, np.array([triangle]))
        places = {1: "inside", 2: "edge", 3: "edge", 4: "edge"}
        assert {v: places[k] for v, k in zip(on[0].tolist(), on[2].tolist())} == {
            v: in_triangle(exact[v], a, b, c)
            for v in range(len(points))
            if v not in triangle and in_triangle(exact[v], a, b, c)
        }
        for v, k in zip(on[0].tolist(), on[2].tolist()):
            if k > 1:
                assert on_segment(exact[v], *(exact[triangle[(k - 2 + m) % 3]] for m in (1, 2)))


def _cross(p: tuple, q: tuple, a: tuple, b: tuple) -> bool:
    """Whether two segments have one point in common that is inside of both."""
    normal = cross(minus(q, p), minus(b, a))
    if not any(normal) or dot(normal, minus(a, p)) != 0:
        return False
    one = dot(cross(minus(a, p), minus(b, a)), normal) / dot(normal, normal)
    two = dot(cross(minus(a, p), minus(q, p)), normal) / dot(normal, normal)
    return 0 < one < 1 and 0 < two < 1


def test_edges_are_found_once() -> None:
    assert edges_of(np.array([[0, 1, 2], [2, 1, 3]])).tolist() == [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    assert edges_of(np.empty((0, 3), dtype=np.int32)).shape == (0, 2)


def test_nothing_and_too_much() -> None:
    points = np.eye(3)
    met = meetings_in_space(points, np.empty((0, 3), dtype=np.int32), np.array([[0, 1]], dtype=np.int32))
    assert all(len(part) == 0 for part in met)
    with pytest.raises(InputError, match="300 orders of magnitude"):
        meetings_in_space(np.eye(3) * [1, 1e-310, 1], np.array([[0, 1, 2]]), np.array([[0, 1]]))


PLAIN = """
import numpy as np
from itertools import combinations
from unstruct.geometry.triangle_pairs import meetings_in_space, crossing_segments
points = np.random.default_rng(5).integers(0, 3, (40, 3)).astype(float)
points = np.unique(points, axis=0)[::2]
triangles = np.array(list(combinations(range(8), 3)), dtype=np.int32)
a, b, c = (points[triangles[:, k]] for k in range(3))
flat = np.cross(b - a, c - a)
triangles = triangles[flat.any(axis=1)]
edges = np.array(list(combinations(range(8), 2)), dtype=np.int32)
print(*(part.tolist() for part in meetings_in_space(points, triangles, edges)))
print(*(part.tolist() for part in crossing_segments(points, edges)))
"""


def test_without_a_compiler_the_same() -> None:
    def run(**switch: str) -> str:
        command = [sys.executable, "-c", PLAIN]
        return subprocess.run(
            command, env={**os.environ, **switch}, capture_output=True, text=True, check=True
        ).stdout

    assert run() == run(NUMBA_DISABLE_JIT="1") != ""
