"""Meshes of several kinds of cells, for tests: lattices whose cells are cut in random ways, and moved."""

from __future__ import annotations

import numpy as np

from unstruct import Mesh

# One good cell of each kind, on a few integers.
GOOD = {
    "triangle": [[0, 0], [4, 0], [0, 4]],
    "quad": [[0, 0], [4, 0], [5, 5], [0, 4]],
    "polygon": [[0, 0], [4, 0], [5, 4], [2, 2], [0, 5]],
    "tetra": [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]],
    "pyramid": [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [2, 2, 4]],
    "wedge": [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [4, 0, 4], [0, 4, 4]],
    "hexahedron": [
        *([0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]),
        *([0, 0, 4], [4, 0, 4], [4, 4, 4], [0, 4, 4]),
    ],
}


def cloud(kind: str, corners: np.ndarray) -> Mesh:
    """Separate cells of one kind, from their corners (m, c, d)."""
    m, c, d = corners.shape
    return Mesh(corners.reshape(-1, d), cells={kind: np.arange(m * c).reshape(m, c)})


def _renumbered(points: np.ndarray, cells: dict[str, list[list[int]]], rng: np.random.Generator) -> Mesh:
    """Vertices and cells in random order: nothing may depend on it."""
    place = rng.permutation(len(points))
    moved = np.empty_like(points)
    moved[place] = points
    shuffled = {}
    for kind in rng.permutation(sorted(cells)).tolist():
        rows = [place[row] for row in cells[kind]]
        shuffled[kind] = [rows[i] for i in rng.permutation(len(rows))]
    return Mesh(moved, cells={k: v if k == "polygon" else np.array(v) for k, v in shuffled.items()})


def planar(n: int = 4, *, jitter: float = 0.0, seed: int = 0) -> Mesh:
    """A square of n x n lattice squares: quadrilaterals, triangles, polygons, pairs joined to hexagons."""
    rng = np.random.default_rng(seed)
    points = np.array([[i, j] for i in range(n + 1) for j in range(n + 1)], dtype=float)
    inner = ((points > 0) & (points < n)).all(axis=1)
    points[inner] += jitter * rng.uniform(-1, 1, (inner.sum(), 2))
    cells: dict[str, list[list[int]]] = {"quad": [], "triangle": [], "polygon": []}

    def at(i: int, j: int) -> int:
        return i * (n + 1) + j

    for j in range(n):
        i = 0
        while i < n:
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            way = rng.integers(5)
            if way == 4 and i + 1 < n:
                cells["polygon"].append([a, b, at(i + 2, j), at(i + 2, j + 1), c, d])
                i += 2
                continue
            if way <= 1:
                cells["quad"].append([a, b, c, d])
            elif way == 2:
                cells["triangle"] += [[a, b, c], [c, d, a]]
            else:
                cells["polygon"].append([b, c, d, a])
            i += 1
    return _renumbered(points, {kind: rows for kind, rows in cells.items() if rows}, rng)


def spatial(n: int = 3, *, jitter: float = 0.0, seed: int = 0) -> Mesh:
    """A cube of n^3 lattice cubes: hexahedra, wedges, pyramids and tetrahedra about centers of such cells.

    Columns of cubes or of pairs of wedges fit each other; some cells become pyramids over their
    quadrilaterals and tetrahedra over their triangles, with a common apex.
    """
    rng = np.random.default_rng(seed)
    side = range(n + 1)
    points = np.array([[i, j, k] for i in side for j in side for k in side], dtype=float) * 4
    inner = ((points > 0) & (points < 4 * n)).all(axis=1)
    points[inner] += 4 * jitter * rng.uniform(-1, 1, (inner.sum(), 3))
    number = np.arange(len(points)).reshape(n + 1, n + 1, n + 1)
    cells: dict[str, list[list[int]]] = {"hexahedron": [], "wedge": [], "pyramid": [], "tetra": []}
    more: list[np.ndarray] = []
    facets = {
        "hexahedron": [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
        "wedge": [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
    }
    for i in range(n):
        for j in range(n):
            cut = rng.random() < 0.5
            for k in range(n):
                low, high = ([int(number[i + a, j + b, k + c]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                             for c in (0, 1))  # fmt: skip
                parts = [("hexahedron", [*low, *high])]
                if cut:
                    parts = [("wedge", [*(low[v] for v in t), *(high[v] for v in t)])
                             for t in ((0, 1, 2), (2, 3, 0))]  # fmt: skip
                for kind, row in parts:
                    if rng.random() < 0.6:
                        cells[kind].append(row)
                        continue
                    apex = len(points) + len(more)
                    more.append(points[row].mean(axis=0))
                    for facet in facets[kind]:
                        over = [row[v] for v in facet][::-1]
                        cells["pyramid" if len(over) == 4 else "tetra"].append([*over, apex])
    every = np.vstack([points, *more]) if more else points
    return _renumbered(every, {kind: rows for kind, rows in cells.items() if rows}, rng)
