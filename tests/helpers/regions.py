"""Nasty small regions, at random: ``random_region(rng, kind)`` for each kind of ``KINDS``.

Every one is a valid `Domain` by construction or by its own validation; the same generator state gives the
same region. Sizes are about 1, counts small, so that a mesh takes a few milliseconds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from unstruct.base.errors import UnstructError
from unstruct.connect.insertion.delaunay import delaunay
from unstruct.domain.arguments import around
from unstruct.domain.domain import Domain
from unstruct.geometry.curves import Arc, Curve

__all__ = ["KINDS", "random_region", "sector"]

Rng = np.random.Generator


def random_region(rng: Rng | int, kind: str | None = None) -> Domain:
    """A random region of this kind (of any kind, if None)."""
    rng = np.random.default_rng(rng)
    if kind is None:
        kind = list(KINDS)[rng.integers(len(KINDS))]
    return KINDS[kind](rng)


def wide(rng: Rng) -> Domain:
    """Three to eight corners whose coordinates span very many exponents; sometimes a loose vertex."""

    def coordinate() -> float:
        choice = rng.integers(4)
        if choice == 0:
            return float(rng.integers(-2, 3))
        sign = rng.choice([-1.0, 1.0])
        if choice == 1:
            return float(rng.choice([0.0, sign * 10.0 ** -rng.uniform(0, 200)]))
        exponent = rng.uniform(0, 30 if choice == 2 else 6)
        return float(rng.integers(-2, 3)) + float(sign * 10.0**-exponent)

    while True:
        ring = [[coordinate(), coordinate()] for _ in range(int(rng.integers(3, 9)))]
        try:
            domain = Domain.polygon(ring)
        except UnstructError:
            continue
        scale = 2.0 ** float(rng.choice([0, 0, 40, -300]))
        if rng.random() < 0.2:
            points = np.concatenate([domain.points, [[coordinate(), coordinate()]]])
            try:
                domain = Domain(points, domain.facets)
            except UnstructError:
                continue
        return Domain(domain.points * scale, domain.facets)


def _between(cells: np.ndarray, neighbors: np.ndarray, take: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sides between chosen and other triangles, and sides between two chosen ones."""
    facets, inside = [], []
    for t in range(len(cells)):
        for i in range(3):
            u = neighbors[t, i]
            side = cells[t, (i + 1) % 3], cells[t, (i + 2) % 3]
            if take[t] and (u < 0 or not take[u]):
                facets.append(side)
            elif take[t] and u > t:
                inside.append(side)
    return np.array(facets, dtype=int).reshape(-1, 2), np.array(inside, dtype=int).reshape(-1, 2)


def _shuffled(rng: Rng, points: np.ndarray, facets: np.ndarray, inner: np.ndarray) -> Domain:
    """The same region with its segments in any order and direction."""
    for rows in (facets, inner):
        rng.shuffle(rows)
        turn = rng.random(len(rows)) < 0.5
        rows[turn] = rows[turn, ::-1]
    return Domain(points, facets, inner=inner)


def grid(rng: Rng) -> Domain:
    """A union of unit squares of a small grid: right angles, pinched vertices, holes, islands, ties."""
    nx, ny = rng.integers(2, 6, size=2)
    cells = np.zeros((nx + 2, ny + 2), dtype=bool)
    while not cells.any():
        cells[1:-1, 1:-1] = rng.random((nx, ny)) < rng.choice([0.5, 0.8])
    facets, inner = [], []
    for i in range(nx + 1):
        for j in range(ny + 1):
            corner, right, up = i * (ny + 1) + j, (i + 1) * (ny + 1) + j, i * (ny + 1) + j + 1
            for one, two, end in (
                (cells[i, j + 1], cells[i + 1, j + 1], up),
                (cells[i + 1, j], cells[i + 1, j + 1], right),
            ):
                if one != two:
                    facets.append((corner, end))
                elif one and rng.random() < 0.1:
                    inner.append((corner, end))
    points = np.stack(np.meshgrid(np.arange(nx + 1), np.arange(ny + 1), indexing="ij"), axis=-1).reshape(
        -1, 2
    )
    facets, inner = np.array(facets), np.array(inner, dtype=int).reshape(-1, 2)
    if rng.random() < 0.5:  # without loose vertices
        used, index = np.unique(np.concatenate([facets, inner]), return_inverse=True)
        points, index = points[used], index.reshape(-1, 2)
        facets, inner = index[: len(facets)], index[len(facets) :]
    return _shuffled(rng, points.astype(float), facets, inner)


def triangles(rng: Rng) -> Domain:
    """A union of Delaunay triangles of random integer points: any angles, pinches, holes, inner segments."""
    side = int(rng.integers(3, 12))
    while True:
        points = np.unique(rng.integers(0, side + 1, size=(int(rng.integers(4, 25)), 2)), axis=0).astype(
            float
        )
        if len(points) < 4 or np.linalg.matrix_rank(points - points[0]) < 2:
            continue
        mesh = delaunay(points)
        take = rng.random(len(mesh.simplices)) < rng.choice([0.6, 0.9])
        if take.any():
            break
    facets, inside = _between(mesh.simplices, mesh.neighbors, take)
    inner = inside[rng.random(len(inside)) < rng.choice([0.0, 0.3])]
    return _shuffled(rng, points, facets, inner)


def star(rng: Rng) -> Domain:
    """A spiky star."""
    n = int(rng.integers(5, 30))
    angle = (np.arange(n) + rng.uniform(0, 0.9, n)) * (2 * np.pi / n)
    radius = np.where(np.arange(n) % 2 == 0, 1.0, rng.uniform(0.05, 0.9)) * rng.uniform(0.7, 1.0, n)
    return Domain.polygon(radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def holes(rng: Rng) -> Domain:
    """Rings within rings: holes, islands in them, holes in those; sometimes with corners on corners."""
    rings: list[np.ndarray] = []

    def fill(center: np.ndarray, radius: float, depth: int) -> None:
        n = int(rng.integers(3, 9))
        angle = (np.arange(n) + rng.uniform(0, 0.5)) * (2 * np.pi / n)
        rings.append(center + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
        within = 0.9 * radius * np.cos(np.pi / n)
        if depth == 0 or within < 1e-3:
            return
        if rng.random() < 0.5:
            fill(center, within * rng.choice([0.3, 0.8, 0.999]), depth - 1)
        else:
            k = int(rng.integers(2, 5))
            for j in range(k):
                turn = 2 * np.pi * j / k + 0.3
                small = within * np.sin(np.pi / k) / (1 + np.sin(np.pi / k))
                fill(
                    center + (within - small) * np.array([np.cos(turn), np.sin(turn)]),
                    0.95 * small,
                    depth - 1,
                )

    fill(np.zeros(2), 1.0, int(rng.integers(1, 4)))
    start = np.cumsum([0, *map(len, rings)])
    return Domain(np.concatenate(rings), np.concatenate([around(a, len(r)) for a, r in zip(start, rings)]))


def near(rng: Rng) -> Domain:
    """Sides that all but cross: slits, tips a few last bits from a side, corners almost on other sides."""
    gap = 2.0 ** -float(rng.integers(4, 50))
    x = np.sort(rng.uniform(0.15, 0.85, 2))
    tip = rng.uniform(0.2, 0.8)
    outer = [[0, 0], [1, 0], [1, 1], [0, 1]]
    wedge = [[x[0], gap], [tip, 0.5], [x[1], 0.6]]
    inner_points = [[tip, 0.5 + gap * 2], [x[0], 0.9]]
    points = np.array([*outer, *wedge, *inner_points])
    facets = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4]]
    points[6, 1] = min(points[6, 1], 0.5 + 0.4 * (x[1] - tip)) if x[1] > tip else 0.3
    try:
        return Domain(points, facets, inner=[[7, 8]])
    except ValueError:
        return Domain(
            [*outer, [x[0], gap], [x[1], gap], [tip, 2 * gap]],
            [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4]],
        )


def angles(rng: Rng) -> Domain:
    """A fan of sides at one corner with angles from 0.01 to 20 degrees, of very unequal lengths."""
    n = int(rng.integers(2, 6))
    turn = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-2, 1.3, n))])
    length = 10.0 ** rng.uniform(-1, 0, n + 1)
    turn = np.radians(turn + rng.uniform(0, 360))
    rim = length[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.concatenate([[[0.0, 0.0]], rim])
    ring = [[i, i + 1] for i in range(n + 1)] + [[n + 1, 0]]
    inner = [[0, i] for i in range(2, n + 1)]
    if rng.random() < 0.3:
        inner = []
    try:
        return Domain(points, ring, inner=inner)
    except ValueError:  # a long side may hide a short one
        return Domain(points[[0, 1, n + 1]], [[0, 1], [1, 2], [2, 0]])


def thin(rng: Rng) -> Domain:
    """A rectangle of extreme aspect, or a comb of thin teeth."""
    width = 10.0 ** -rng.uniform(0.5, 4)
    if rng.random() < 0.3:
        return Domain.rectangle((0, 0), (1, width))
    n = int(rng.integers(2, 5))
    rim = [[0.0, -0.2], [1.0, -0.2], [1.0, 0.0]]
    for i in reversed(range(n)):
        left = (i + 0.3) / n
        rim += [[left + width / n * 0.5, 0.0], [left + width / n * 0.5, 0.5], [left, 0.5], [left, 0.0]]
    return Domain.polygon([*rim, [0.0, 0.0]])


def curves(rng: Rng) -> Domain:
    """Arcs and wavy closed curves, with holes off center, lenses and crescents."""
    choice = rng.integers(4)
    if choice == 0:  # a disc with an off-center round hole, nearly touching
        gap = 10.0 ** -rng.uniform(0.5, 4)
        hole = rng.uniform(0.1, 0.6)
        return _discs([(0.0, 0.0, 1.0), (1.0 - hole - gap, 0.0, hole)])
    if choice == 1:  # a lens, or a crescent
        first, second = rng.uniform(0.05, 1.5, 2) * rng.choice([-1, 1], 2)
        if abs(first - second) < 0.02:
            second = -first
        bulges = [Arc.through((0, 0), (0.5, b / 2), (1, 0)) for b in (first, second)]
        return Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=dict(enumerate(bulges)))
    if choice == 2:  # a wavy closed curve in two halves
        k, amplitude = int(rng.integers(2, 7)), rng.uniform(0.05, 0.5)

        def rim(t: np.ndarray) -> np.ndarray:
            r = 1 + amplitude * np.cos(k * t)
            return np.column_stack([r * np.cos(t), r * np.sin(t)])

        halves = {0: Curve(rim, 0.0, np.pi), 1: Curve(rim, np.pi, 2 * np.pi)}
        return Domain(rim(np.array([0.0, np.pi])), [[0, 1], [1, 0]], curves=halves)
    # a half disc with small holes near its rim and a chord inside
    points = [[-1, 0], [1, 0], *(0.97 * np.array([[np.cos(a), np.sin(a)] for a in (0.6, 0.65, 0.62)]))]
    points[4] = 0.9 * np.array([np.cos(0.62), np.sin(0.62)])
    points += [[-0.5, 0.3], [0.2, 0.6]]
    facets = [[0, 1], [1, 0], [2, 3], [3, 4], [4, 2]]
    return Domain(points, facets, inner=[[5, 6]], curves={1: Arc((0, 0), 1.0, 0.0, np.pi)})


def _discs(discs: list[tuple[float, float, float]]) -> Domain:
    points, facets, arcs = [], [], {}
    for x, y, r in discs:
        start = len(points)
        points += [(x + r, y), (x, y + r), (x - r, y), (x, y - r)]
        for i in range(4):
            arcs[len(facets)] = Arc((x, y), r, i * np.pi / 2, np.pi / 2)
            facets.append((start + i, start + (i + 1) % 4))
    return Domain(points, facets, curves=arcs)


def cracks(rng: Rng) -> Domain:
    """A square with random chains of inner segments that dangle, close, or reach the boundary; seeds."""
    outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
    lattice = rng.permutation(np.array([[i, j] for i in range(1, 8) for j in range(1, 8)]))[:10] / 2
    points = np.concatenate([outer, lattice])
    inner: list[list[int]] = []
    for _ in range(int(rng.integers(1, 12))):
        pair = rng.choice(len(points), size=2, replace=False).tolist()
        if sorted(pair) in [[0, 1], [1, 2], [2, 3], [0, 3]]:
            continue
        try:
            Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[*inner, pair])
        except ValueError:
            continue
        inner.append(pair)
    seed = [0.015625, 0.0140625]  # on no line through two of the points
    return Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=inner, regions={"corner": [seed]})


KINDS: dict[str, Callable[[Rng], Domain]] = {
    "grid": grid,
    "triangles": triangles,
    "star": star,
    "holes": holes,
    "near": near,
    "angles": angles,
    "thin": thin,
    "curves": curves,
    "cracks": cracks,
    "wide exponents": wide,
}


def sector(parts: int = 7, center=(0.0, 0.0), *, bend: float = 0.0) -> Domain:
    """A part of an annulus, from polar angle 0 on; its sides "low" and "high" are straight, or bent arcs."""
    angle = 2 * np.pi / parts

    def at(share: float, radius: float) -> np.ndarray:
        return np.array(center) + radius * np.array([np.cos(share * angle), np.sin(share * angle)])

    points = [at(0, 0.4), at(0, 1), at(1, 1), at(1, 0.4)]
    curves = {
        k: Arc.through(points[k], at(0.5, radius), points[(k + 1) % 4]) for k, radius in ((1, 1), (3, 0.4))
    }
    if bend:
        curves[0] = Arc.through(points[0], at(bend, 0.7), points[1])
        curves[2] = Arc.through(points[2], at(1 + bend, 0.7), points[3])
    return Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0)], curves=curves, markers={"low": [0], "high": [2]})
