"""Meshes of triangles and quadrilaterals in rational numbers, for tests of what changes them."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np

import unstruct
from unstruct.generate.quads.linked import linked
from unstruct.generate.quads.pairing import pairs_of_triangles


def turn(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = (tuple(map(Fraction, map(float, p))) for p in (a, b, c))
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def rows_of(cells):
    return [[int(v) for v in row if v >= 0] for row in cells if row[0] >= 0]


def judged(xy, cells):
    """The boundary (directed edges) and twice the area of a mesh, after a check of every cell and edge."""
    edges, area = Counter(), Fraction(0)
    for row in rows_of(cells):
        n = len(row)
        for k in range(n):
            assert turn(xy[row[k - 1]], xy[row[k]], xy[row[(k + 1) % n]]) > 0, row
            edges[row[k], row[(k + 1) % n]] += 1
        for k in range(1, n - 1):
            area += turn(xy[row[0]], xy[row[k]], xy[row[k + 1]])
    assert max(edges.values()) == 1
    return {e for e in edges if e[::-1] not in edges}, area


def same_boundary(before, after):
    assert before[0] == after[0]
    assert before[1] == after[1]


def consistent(m):
    """The cells at each vertex are those that name it."""
    for v in range(len(m.xy)):
        held = sorted(m.at[m.place[v] : m.place[v] + m.degree[v]].tolist())
        assert held == sorted(np.flatnonzero((m.cells == v).any(axis=1)).tolist())


def of_triangles(n, seed, pair=True):
    """A square of random points, its triangles partly paired: a record, ready to be changed."""
    rng = np.random.default_rng(seed)
    side = np.arange(5) / 4
    ring = np.concatenate([[(x, 0), (1, x), (1 - x, 1), (0, 1 - x)] for x in side[:-1]])
    points = np.concatenate([ring, 0.08 + 0.84 * rng.random((n, 2))])
    mesh = unstruct.delaunay(points)
    rows, neighbors = np.asarray(mesh.simplices), np.asarray(mesh.neighbors)
    closed = neighbors < 0
    single, quads, _ = pairs_of_triangles(mesh.points, rows, neighbors, closed, 0.97 if pair else -1.0)
    alone = np.column_stack([rows[single], np.full(len(single), -1)])
    cells = np.concatenate([alone, quads]).astype(np.int64)
    t, i = np.nonzero(closed)
    sides = np.column_stack([rows[t, (i + 1) % 3], rows[t, (i + 2) % 3]]).astype(np.int64)
    fixed = np.zeros(len(points), dtype=bool)
    fixed[sides.ravel()] = True
    xy = np.concatenate([mesh.points, 0.5 * (mesh.points[sides[:, 0]] + mesh.points[sides[:, 1]])])
    fixed = np.concatenate([fixed, np.ones(len(sides), dtype=bool)])
    return linked(xy, cells, fixed, sides, len(points) + np.arange(len(sides)))
