"""Surfaces of triangles for tests: round, flat, with boundary, nasty."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from unstruct import DomainMesh, remesh, surface_delaunay
from unstruct.errors import IncompleteWarning
from unstruct.mesh.mesh import Mesh

GOLDEN = (1 + 5**0.5) / 2


def icosphere(level: int, stretch=(1.0, 1.0, 1.0)) -> Mesh:
    """A sphere of 20 * 4^level triangles, stretched along the axes."""
    points = [(s, t * GOLDEN, 0) for s in (-1, 1) for t in (-1, 1)]
    points += [(0, s, t * GOLDEN) for s in (-1, 1) for t in (-1, 1)]
    points += [(t * GOLDEN, 0, s) for s in (-1, 1) for t in (-1, 1)]
    p = np.array(points, dtype=float)
    rows = []
    for i in range(12):
        for j in range(12):
            for k in range(12):
                a, b, c = p[i], p[j], p[k]
                sides = [((a - b) ** 2).sum(), ((b - c) ** 2).sum(), ((c - a) ** 2).sum()]
                if i < j and i < k and np.allclose(sides, 4.0) and np.linalg.det([a, b, c]) > 0:
                    rows.append((i, j, k))
    t = np.array(rows)
    for _ in range(level):
        ends = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
        edges, number = np.unique(ends, axis=0, return_inverse=True)
        ab, bc, ca = number.reshape(3, -1) + len(p)
        p = np.concatenate([p, p[edges].mean(axis=1)])
        a, b, c = t.T
        t = np.concatenate(
            [np.stack(r, axis=1) for r in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
        p = p / np.sqrt((p**2).sum(axis=1))[:, None]
    p = p / np.sqrt((p**2).sum(axis=1))[:, None]
    return Mesh(p * np.array(stretch), t.astype(np.int32))


def grid(n: int, m: int, place, *, around: tuple[bool, bool] = (False, False)) -> Mesh:
    """A grid of (n, m) squares, each cut in two, carried into space by ``place(u, v)``, u, v in [0, 1]."""
    nu, nv = (n if around[0] else n + 1), (m if around[1] else m + 1)
    u, v = np.meshgrid(np.arange(nu) / n, np.arange(nv) / m, indexing="ij")
    points = np.stack(np.broadcast_arrays(*place(u.ravel(), v.ravel())), axis=1).astype(float)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    at = lambda i, j: (i % nu) * nv + j % nv  # noqa: E731
    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    return Mesh(
        points, np.concatenate([np.stack(r, axis=1) for r in ((a, b, c), (a, c, d))]).astype(np.int32)
    )


def torus(n: int, m: int, large: float = 1.0, small: float = 0.4) -> Mesh:
    """Outward oriented."""

    def place(u, v):
        u, v = 2 * np.pi * u, 2 * np.pi * v
        return (
            (large + small * np.cos(v)) * np.cos(u),
            (large + small * np.cos(v)) * np.sin(u),
            small * np.sin(v),
        )

    return grid(n, m, place, around=(True, True))


def cylinder(n: int, m: int, radius: float = 1.0, height: float = 2.0) -> Mesh:
    """Open at both ends, outward oriented."""
    turn = lambda u: 2 * np.pi * u  # noqa: E731
    return grid(
        n,
        m,
        lambda u, v: (radius * np.cos(turn(u)), radius * np.sin(turn(u)), height * v),
        around=(True, False),
    )


def saddle(n: int, bend: float = 1.0) -> Mesh:
    """z = bend (x^2 - y^2) / 2 over the square of side 2 around the origin."""
    return grid(n, n, lambda u, v: (2 * u - 1, 2 * v - 1, bend * ((2 * u - 1) ** 2 - (2 * v - 1) ** 2) / 2))


def bipyramid(n: int, up: float, down: float, seed: int = 0) -> Mesh:
    """Two tips over a ring of n points at random angles and radii: needles if the tips are far."""
    rng = np.random.default_rng(seed)
    turn = np.sort((np.arange(n) + 0.6 * rng.random(n)) * 2 * np.pi / n)
    radius = 0.5 + rng.random(n)
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn), 0.2 * rng.random(n)], axis=1)
    points = np.concatenate([ring, [[0, 0, up], [0, 0, -down]]])
    k = np.arange(n)
    after = (k + 1) % n
    upper, lower = np.stack([k, after, 0 * k + n], axis=1), np.stack([after, k, 0 * k + n + 1], axis=1)
    return Mesh(points, np.concatenate([upper, lower]).astype(np.int32))


def random_surface(seed: int) -> Mesh:
    """One of all of these, spoiled."""
    rng = np.random.default_rng(seed)
    stretch = 10.0 ** rng.uniform(-2, 0, 3)
    kind = rng.integers(6)
    if kind == 0:
        mesh = icosphere(int(rng.integers(3)))
    elif kind == 1:
        mesh = torus(*rng.integers(3, 9, 2))
    elif kind == 2:
        mesh = cylinder(*rng.integers(3, 9, 2))
    elif kind == 3:
        mesh = saddle(int(rng.integers(1, 8)), 3 * rng.random())
    elif kind == 4:
        mesh = bipyramid(int(rng.integers(3, 9)), 10 ** rng.uniform(-1, 2), 10 ** rng.uniform(-1, 2), seed)
    else:
        return bipyramid(3, 10 ** rng.uniform(-1, 3), 10 ** rng.uniform(-1, 3), seed)
    noise = 0.2 * rng.random() * rng.standard_normal(mesh.points.shape) * stretch / len(mesh.points) ** 0.5
    return Mesh(mesh.points * stretch + noise, mesh.simplices)


def joined(*parts: tuple[np.ndarray, np.ndarray]) -> Mesh:
    """Several surfaces, each of points and triangles, as one mesh."""
    start = np.cumsum([0] + [len(points) for points, _ in parts])
    rows = [triangles + first for (_, triangles), first in zip(parts, start)]
    return Mesh(np.concatenate([points for points, _ in parts]), np.concatenate(rows))


def remeshed(surface: Mesh, size: Any, **options: Any) -> DomainMesh:
    """`remesh` without the warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        return remesh(surface, size, **options)


def surface_delaunay_of(surface: Mesh, size: Any = None, **options: Any) -> DomainMesh:
    """`surface_delaunay` without the warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        return surface_delaunay(surface, size, **options)
