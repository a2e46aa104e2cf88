"""Closed surfaces for tests of recovery: points and triangles, from formulas."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Surface = tuple[NDArray[np.float64], NDArray[np.int32]]


def schoenhardt() -> Surface:
    """Schoenhardt's twisted prism: no tetrahedron of its six vertices is inside."""
    low, high = np.deg2rad([0, 120, 240]), np.deg2rad([30, 150, 270])
    points = [(np.cos(a), np.sin(a), z) for angles, z in ((low, 0.0), (high, 1.0)) for a in angles]
    sides = [t for i in range(3) for t in ((i, (i + 1) % 3, 3 + (i + 1) % 3), (i, 3 + (i + 1) % 3, 3 + i))]
    return np.array(points), np.array([(0, 2, 1), (3, 4, 5), *sides], dtype=np.int32)


def six_points() -> Surface:
    """Integer points without tetrahedra: each four have one of three diagonals that are outside."""
    points = np.array([(6, 0, 0), (-3, 5, 0), (-3, -5, 0), (5, 3, 8), (-5, 3, 8), (0, -6, 8)], dtype=float)
    faces = [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]
    return points, np.array(faces, dtype=np.int32)


def cube(n: int, seed: int = 0) -> Surface:
    """A cube whose sides are n by n squares, each with one of its diagonals, by chance."""
    rng = np.random.default_rng(seed)
    number: dict[tuple[int, ...], int] = {}
    faces = []
    for axis in range(3):
        for end in (0, n):
            for i, j in np.ndindex(n, n):
                square = []
                for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    row = [0, 0, 0]
                    row[axis], row[(axis + 1) % 3], row[(axis + 2) % 3] = end, i + di, j + dj
                    square.append(number.setdefault(tuple(row), len(number)))
                if end == 0:
                    square.reverse()
                k = int(rng.integers(2))
                a, b, c, d = square[k], square[k + 1], square[(k + 2) % 4], square[(k + 3) % 4]
                faces += [(a, b, c), (a, c, d)]
    return np.array(list(number), dtype=float), np.array(faces, dtype=np.int32)


def torus(n: int, m: int) -> Surface:
    """A torus of n by m quadrilaterals, all with the same diagonal."""
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    radius = 1 + 0.35 * np.cos(v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), 0.35 * np.sin(v)], axis=-1).reshape(-1, 3)
    faces = []
    for i, j in np.ndindex(n, m):
        a, b = i * m + j, (i + 1) % n * m + j
        c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
        faces += [(a, b, c), (a, c, d)]
    return points, np.array(faces, dtype=np.int32)


def twisted_star(n: int, layers: int, turn: float) -> Surface:
    """A prism over a star of n corners, turned by ``turn`` half turns from bottom to top."""
    points, faces = [], []
    for layer in range(layers + 1):
        for i in range(n):
            angle, radius = 2 * np.pi * i / n + np.pi * turn * layer / layers, 1.0 if i % 2 else 0.45
            points.append((radius * np.cos(angle), radius * np.sin(angle), 3 * layer / layers))
    for layer in range(layers):
        for i in range(n):
            a, b = layer * n + i, layer * n + (i + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    low, high = len(points), len(points) + 1
    points += [(0.0, 0.0, 0.0), (0.0, 0.0, 3.0)]
    for i in range(n):
        faces += [(low, (i + 1) % n, i), (high, layers * n + i, layers * n + (i + 1) % n)]
    return np.array(points), np.array(faces, dtype=np.int32)


def saddle_lines(n: int, gap: float) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Chazelle's lines: n along x on the saddle z = x y, n along y on z = x y + gap; points and segments."""
    ticks = np.arange(1, n + 1)
    first = [((0, y, 0), (n + 1, y, (n + 1) * y)) for y in ticks]
    second = [((x, 0, gap), (x, n + 1, x * (n + 1) + gap)) for x in ticks]
    ends = np.array(first + second, dtype=float).reshape(-1, 3)
    return ends, np.arange(len(ends), dtype=np.int32).reshape(-1, 2)
