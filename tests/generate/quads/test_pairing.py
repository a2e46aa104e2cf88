"""Pairs of triangles: convex in rational numbers, across open sides only, none left that could be."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import delaunay
from unstruct.generate.quads.pairing import MOST_COSINE, pairs_of_triangles

places = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=5, max_size=30, unique=True)


def turn(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = (tuple(map(Fraction, p.tolist())) for p in (a, b, c))
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def cosines(x):
    u, v = np.roll(x, 1, axis=0) - x, np.roll(x, -1, axis=0) - x
    return (u * v).sum(axis=1) / np.sqrt((u * u).sum(axis=1) * (v * v).sum(axis=1))


@settings(max_examples=60, deadline=None)
@given(rows=places, seed=st.integers(0, 99))
def test_pairs(rows, seed):
    points = np.array(rows, dtype=float)
    if np.linalg.matrix_rank(points - points[0]) < 2:
        return
    mesh = delaunay(points)
    triangles, neighbors = np.asarray(mesh.simplices), np.asarray(mesh.neighbors)
    closed = np.random.default_rng(seed).random(triangles.shape) < 0.2
    for t, i in zip(*np.nonzero(closed)):
        if neighbors[t, i] >= 0:
            closed[neighbors[t, i], neighbors[neighbors[t, i]] == t] = True
    single, quads, both = pairs_of_triangles(points, triangles, neighbors, closed)
    assert sorted([*single, *both.ravel()]) == list(range(len(triangles)))
    for quad, (t, o) in zip(quads, both):
        assert set(quad) == set(triangles[t]) | set(triangles[o])
        assert not closed[t, neighbors[t] == o].any()
        x = points[quad]
        assert all(turn(x[k - 1], x[k], x[(k + 1) % 4]) > 0 for k in range(4))
        assert np.abs(cosines(x)).max() <= MOST_COSINE + 1e-12
    alone = set(single.tolist())
    for t in alone:
        for i in range(3):
            o = int(neighbors[t, i])
            if o in alone and not closed[t, i]:
                rest = triangles[o][~np.isin(triangles[o], triangles[t])]
                x = points[[triangles[t, i], triangles[t, (i + 1) % 3], rest[0], triangles[t, (i + 2) % 3]]]
                convex = all(turn(x[k - 1], x[k], x[(k + 1) % 4]) > 0 for k in range(4))
                assert not convex or np.abs(cosines(x)).max() > MOST_COSINE - 1e-12


@pytest.mark.parametrize("n", [2, 7])
def test_a_lattice_becomes_squares(n):
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    mesh = delaunay(np.column_stack([x.ravel(), y.ravel()]).astype(float))
    single, quads, _ = pairs_of_triangles(
        mesh.points, mesh.simplices, mesh.neighbors, np.zeros(mesh.simplices.shape, dtype=bool)
    )
    assert len(single) == 0 and len(quads) == (n - 1) ** 2
    assert np.abs([cosines(mesh.points[quad]) for quad in quads]).max() < 1e-12


def test_exchanges_pair_what_the_greedy_choice_leaves():
    """Four triangles in a row, of which the middle two make a square: greedy leaves the outer two alone."""
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [-0.5, 0.5], [1.5, 0.5]])
    triangles = np.array([[4, 0, 3], [0, 1, 3], [1, 2, 3], [1, 5, 2]], dtype=np.int32)
    neighbors = np.array([[1, -1, -1], [2, 0, -1], [-1, 1, 3], [-1, 2, -1]], dtype=np.int32)
    single, _, both = pairs_of_triangles(points, triangles, neighbors, np.zeros((4, 3), dtype=bool))
    assert len(single) == 0 and both.tolist() == [[0, 1], [2, 3]]


def most_pairs(sides):
    """The largest number of disjoint pairs, by trying all."""
    if not sides:
        return 0
    (t, o), rest = sides[0], sides[1:]
    return max(most_pairs(rest), 1 + most_pairs([s for s in rest if not {t, o} & set(s)]))


def adjacent(neighbors):
    found = np.zeros((len(neighbors), len(neighbors)), dtype=bool)
    t, i = np.nonzero(neighbors >= 0)
    found[t, neighbors[t, i]] = True
    return found


@settings(max_examples=40, deadline=None)
@given(rows=st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=5, max_size=9, unique=True))
def test_nearly_as_many_pairs_as_there_can_be(rows):
    points = np.array(rows, dtype=float)
    if np.linalg.matrix_rank(points - points[0]) < 2:
        return
    mesh = delaunay(points)
    triangles, neighbors = np.asarray(mesh.simplices), np.asarray(mesh.neighbors)
    _, quads, _ = pairs_of_triangles(points, triangles, neighbors, neighbors < 0, 0.97)
    sides = []
    for t, o in zip(*(rows.tolist() for rows in np.nonzero(np.triu(adjacent(neighbors))))):
        i = int(np.flatnonzero(neighbors[t] == o)[0])
        rest = triangles[o][~np.isin(triangles[o], triangles[t])]
        x = points[[triangles[t, i], triangles[t, (i + 1) % 3], rest[0], triangles[t, (i + 2) % 3]]]
        if (
            all(turn(x[k - 1], x[k], x[(k + 1) % 4]) > 0 for k in range(4))
            and np.abs(cosines(x)).max() < 0.97
        ):
            sides.append((t, o))
    best = most_pairs(sides)
    assert best - 1 <= len(quads) <= best  # odd cycles can hide one exchange
