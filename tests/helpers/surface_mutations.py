"""Good surfaces with faults: each is refused by name, or mended with an account; never a wrong volume.

    python tests/helpers/surface_mutations.py 1000 --seed 7

What must be inside is decided by rays through the facets as they were given, in plain arithmetic: points
at which rounding could matter are left out.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable
from itertools import pairwise, product
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from unstruct import Domain, UnstructError

__all__ = ["MUTATIONS", "examine", "inside", "mutated", "overlapping"]

Surface = tuple[np.ndarray, list[list[int]]]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(rng: np.random.Generator) -> Surface:
    return np.array(list(product((0.0, 1.0), (0.0, 2.0), (0.0, 1.0)))), [list(side) for side in SIDES]


def hull(rng: np.random.Generator) -> Surface:
    points = rng.standard_normal((int(rng.integers(6, 25)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    return points, ConvexHull(points).simplices.tolist()


def torus(rng: np.random.Generator) -> Surface:
    k, m = 8, 5
    u, v = np.meshgrid(np.arange(k) * 2 * np.pi / k, np.arange(m) * 2 * np.pi / m, indexing="ij")
    wide = 2 + np.cos(v)
    points = np.stack([wide * np.cos(u), wide * np.sin(u), np.sin(v)], axis=-1).reshape(-1, 3)
    points += rng.uniform(-0.05, 0.05, points.shape)
    rows = []
    for i in range(k):
        for j in range(m):
            a, b, c, d = ((i + x) % k * m + (j + y) % m for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
            rows += [[a, b, c], [a, c, d]]
    return points, rows


def plate(rng: np.random.Generator) -> Surface:
    """An L: two facets are not convex."""
    ring = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = np.array([(*p, z) for z in (0.0, 1.0) for p in ring])
    rows = [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11]]
    return points, rows + [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]


def nested(rng: np.random.Generator) -> Surface:
    points, rows = box(rng)
    center = np.array([0.5, 1.0, 0.5])
    return (
        np.concatenate([points, (points - center) * 0.5 + center]),
        [*rows, *([8 + v for v in row] for row in rows)],
    )


BODIES: list[Callable[[np.random.Generator], Surface]] = [box, hull, torus, plate, nested]


def overlapping(seed: int) -> Surface:
    """One to four boxes, sheared boxes or tetrahedra with corners on a grid, wherever they may lie."""
    rng = np.random.default_rng(seed)
    corners = np.array(list(product((0.0, 1.0), repeat=3)))
    points: list[list[float]] = []
    rows: list[list[int]] = []
    unit = rng.choice([1, 0.25, 0.1, 1 / 3])
    for _ in range(rng.integers(1, 5)):
        kind, low, n = rng.integers(3), rng.integers(0, 5, 3), len(points)
        if kind == 0:
            x, sides = rng.integers(0, 4, (4, 3)), [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)]
            if round(np.linalg.det(x[1:] - x[0])) == 0:
                continue
        else:
            shear = np.array([[1, 0, 0], [kind - 1, 1, 0], [0, 0, 1]])
            x, sides = (corners @ shear) * rng.integers(1, 5, 3) + low, SIDES
        points += (x * unit).tolist()
        rows += [[n + v for v in side] for side in sides]
    return np.array(points).reshape(-1, 3), rows


# ---------------------------------------------------------------------- mutations: in place, or a new surface


def _pick(rng: np.random.Generator, rows: list) -> int:
    return int(rng.integers(len(rows)))


def delete(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    del rows[_pick(rng, rows)]
    return points, rows


def duplicate(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = list(rows[_pick(rng, rows)])
    return points, [*rows, np.roll(row, rng.integers(len(row)))[:: rng.choice([-1, 1])].tolist()]


def flip(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    return points, [row[::-1] if rng.random() < 0.3 else row for row in rows]


def move(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    v, w = rng.choice(len(points), 2, replace=False)
    points[v] += (points[w] - points[v]) * rng.choice([0.1, 0.5, 1.5])
    return points, rows


def not_finite(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    points[_pick(rng, rows) % len(points), 1] = rng.choice([np.nan, np.inf])
    return points, rows


def merge_two(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    return points, [[row[0] if v == row[1] else v for v in other] for other in rows]


def same_place(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    v, w = rng.choice(len(points), 2, replace=False)
    points[v] = points[w]
    return points, rows


def shifted_copy(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    shift = rng.choice([0.0, 0.25, 0.5, 1.0, 2.0], 3)
    n = len(points)
    return np.concatenate([points, points + shift]), [*rows, *([n + v for v in row] for row in rows)]


def fin(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    return np.vstack([points, [3.0, 5.0, 4.0]]), [*rows, [row[0], row[1], len(points)]]


def wall(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    return points, [*rows, rng.choice(len(points), 3, replace=False).tolist()]


def mirrored(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    """A second body that touches the first in its lowest vertex; this is allowed."""
    low = int(np.lexsort(points.T)[0])
    number = [*range(len(points), len(points) + low), low, *range(len(points) + low, 2 * len(points) - 1)]
    other = np.delete(2 * points[low] - points, low, axis=0)
    return np.concatenate([points, other]), [
        *rows,
        *([number[v] if 0 <= v < len(number) else v for v in row] for row in rows),
    ]


def bow_tie(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    row[0], row[1] = row[1], row[0]
    return points, rows


def swap(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    one, two = rows[_pick(rng, rows)], rows[_pick(rng, rows)]
    one[0], two[-1] = two[-1], one[0]
    return points, rows


def t_junction(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    """A vertex in the middle of a side of one facet, which its neighbor lacks."""
    row = rows[_pick(rng, rows)]
    middle = points[row[0]] / 2 + points[row[1]] / 2
    row.insert(1, len(points))
    return np.vstack([points, middle]), rows


def loose(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    return np.vstack([points, points[row[0]] / 2 + points[row[2]] / 2]), rows


def stutter(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    row[1:1] = [[row[0]], [row[1], row[0]]][rng.integers(2)]
    return points, rows


def sliver(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    row = rows[_pick(rng, rows)]
    middle = points[row[0]] / 2 + points[row[1]] / 2
    return np.vstack([points, middle]), [*rows, [row[0], len(points), row[1]]]


def out_of_range(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    return points, [*rows, [0, 1, int(rng.choice([-1, len(points), 10**6]))]]


def soup(rng: np.random.Generator, points: np.ndarray, rows: list) -> Surface:
    """Each facet with vertices of its own, as in STL."""
    ends = np.cumsum([0, *map(len, rows)])
    flat = [v if 0 <= v < len(points) else 0 for row in rows for v in row]
    return points[flat], [list(range(a, b)) for a, b in pairwise(ends)]


MUTATIONS: dict[str, Callable[[np.random.Generator, np.ndarray, list], Surface]] = {
    f.__name__: f
    for f in (
        delete, duplicate, flip, move, not_finite, merge_two, same_place, shifted_copy, fin, wall, mirrored,
        bow_tie, swap, t_junction, loose, stutter, sliver, out_of_range, soup,
    )
}  # fmt: skip
ALLOWED = {"flip", "mirrored"}  # they need no repair
MENDED = {"duplicate", "t_junction", "loose", "out_of_range", "soup"}  # each alone
SAME = MENDED | {"flip", "stutter", "sliver", "fin"}  # what is inside is what was inside before


def mutated(seed: int) -> tuple[Surface, Surface, list[str]]:
    """A good surface, and the same with one to three mutations."""
    rng = np.random.default_rng(seed)
    good = BODIES[rng.integers(len(BODIES))](rng)
    points, rows = good[0].copy(), [list(row) for row in good[1]]
    names = rng.choice(list(MUTATIONS), rng.choice([1, 1, 2, 3])).tolist()
    for name in names:
        points, rows = MUTATIONS[name](rng, points, rows)
    return good, (points, rows), names


# ---------------------------------------------------------------------- what must hold


def inside(surface: Surface, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """By rays in a fixed direction: whether points are inside, and whether that is certain."""
    points, rows = surface
    fans = np.array([(row[0], *pair) for row in rows for pair in pairwise(row[1:])])
    fans = fans[(fans >= 0).all(axis=1) & (fans < len(points)).all(axis=1)]
    d = np.array([0.4213, 0.7791, 0.4643])
    a, b, c = (points[fans[:, k]][None] - x[:, None] for k in range(3))
    sides = np.stack([np.cross(u, v) @ d for u, v in ((a, b), (b, c), (c, a))])
    normal = np.cross(b - a, c - a)
    along = normal @ d
    above = (normal * a).sum(axis=-1)
    flat = np.abs(normal).max(axis=-1) < 1e-12
    hit = ((sides > 0).all(axis=0) | (sides < 0).all(axis=0)) & (above * along > 0) & ~flat
    near = (np.abs(sides).min(axis=0) < 1e-6) | (np.abs(above) < 1e-6) | (np.abs(along) < 1e-9)
    may_hit = (sides > -1e-6).all(axis=0) | (sides < 1e-6).all(axis=0)
    return hit.sum(axis=1) % 2 == 1, ~(near & may_hit & ~flat).any(axis=1)


def examine(seed: int) -> str:
    """Raise an AssertionError if the library does something wrong; else what it did."""
    good, surface, names = mutated(seed)
    points, rows = surface
    markers = {"first": [0], "even": list(range(0, len(rows), 2))}
    outcome = {}
    for resolve in (False, True):
        try:
            outcome[resolve] = Domain(points, rows, markers=markers, resolve=resolve)
        except UnstructError as error:
            assert len(str(error)) > 30, error
            outcome[resolve] = None
    plain, mended = outcome[False], outcome[True]
    assert np.isfinite(points).all() or mended is None
    if set(names) <= ALLOWED:
        assert plain is not None
    if len(names) == 1 and names[0] in MENDED:
        assert mended is not None, names
    if plain is not None:
        assert mended is not None and mended.volume == plain.volume
        assert {repair.kind for repair in mended.repairs} <= {"turned facets"}
    if mended is None:
        return "refused"
    _consistent(surface, markers, mended, plain is None)
    rng = np.random.default_rng(seed + 1)
    x = rng.uniform(points.min(axis=0), points.max(axis=0), (60, 3))
    bent = {"not flat", "crossing itself", "repeated vertex"} & {repair.kind for repair in mended.repairs}
    wanted, sure = inside(good if set(names) <= SAME else (points, _bounding(rows, mended)), x)
    sheets = {piece for repair in mended.repairs if repair.kind == "open boundary" for piece in repair.pieces}
    if not bent and not sheets & {*mended.piece_origin[: len(mended.facets)].tolist()}:
        assert (mended.contains(x) == wanted)[sure].all(), (names, mended.repairs)
    return "allowed" if plain is not None else "mended"


def _bounding(rows: list[list[int]], mended: Domain) -> list[list[int]]:
    """The rows that bound: not those that became inner, and one of an even number of which one was kept."""
    gone: set[int] = set()
    for repair in mended.repairs:
        if repair.kind == "open boundary":
            gone |= {*repair.pieces}
        if repair.kind == "repeated facet" and " was kept" in repair.text and len(repair.pieces) % 2 == 0:
            gone.add(repair.pieces[0])
    return [row for i, row in enumerate(rows) if i not in gone]


def _consistent(surface: Surface, markers: dict[str, list[int]], mended: Domain, changed: bool) -> None:
    """The account, the names and the numbers fit, and the result stands by itself."""
    assert bool(mended.repairs) or not changed
    assert all(str(repair) and len(repair.place) == 3 for repair in mended.repairs)
    again = Domain(mended.points, mended.facets, inner=mended.inner)
    assert again.volume == mended.volume > 0 and len(mended.turned) == 0
    old = mended.origin >= 0
    assert (mended.points[old] == surface[0][mended.origin[old]]).all()
    assert ((mended.piece_origin >= 0) & (mended.piece_origin < len(surface[1]))).all()
    merged = {piece for repair in mended.repairs for piece in repair.pieces if len(repair.pieces) > 1}
    for name, pieces in markers.items():
        from_named = np.isin(mended.piece_origin, pieces)
        has = np.isin(np.arange(len(mended.piece_origin)), mended.markers[name])
        assert (has | ~from_named).all()
        assert {*mended.piece_origin[has & ~from_named].tolist()} <= merged


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("number", type=int)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    seen: Counter[Any] = Counter()
    for seed in range(given.seed, given.seed + given.number):
        try:
            done = examine(seed)
        except Exception as error:
            print(f"seed {seed}: {mutated(seed)[2]}: {type(error).__name__}: {str(error)[:300]}")
            done = "WRONG"
        names = mutated(seed)[2]
        seen[names[0] if len(names) == 1 else "several", done] += 1
    for (name, done), count in sorted(seen.items()):
        print(f"{name:14} {done:8} {count}")


if __name__ == "__main__":
    main()
