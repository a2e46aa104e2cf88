"""A given surface: nearest points beside all triangles, curves beside counting, distances by hand."""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain
from unstruct.errors import InputError
from unstruct.geometry.support import Support
from unstruct.geometry.support_features import same_points
from unstruct.geometry.support_walk import nearest_on_chain

SQUARE = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]]


def nearest_squared(x: list, corners: list) -> Fraction:
    """The squared distance of a point from a triangle in fractions: of all feet that lie in it, the least."""
    p, a = [Fraction(v) for v in x], [[Fraction(v) for v in row] for row in corners]

    def minus(u: list, v: list) -> list:
        return [s - t for s, t in zip(u, v)]

    def dot(u: list, v: list) -> Fraction:
        return sum((s * t for s, t in zip(u, v)), Fraction(0))

    found = [dot(minus(p, c), minus(p, c)) for c in a]
    for i in range(3):
        u, w = minus(a[(i + 1) % 3], a[i]), minus(p, a[i])
        if dot(u, u) and 0 <= dot(u, w) <= dot(u, u):
            found.append(dot(w, w) - dot(u, w) ** 2 / dot(u, u))
    u, v, w = minus(a[1], a[0]), minus(a[2], a[0]), minus(p, a[0])
    d = dot(u, u) * dot(v, v) - dot(u, v) ** 2
    if d:
        s = (dot(v, v) * dot(u, w) - dot(u, v) * dot(v, w)) / d
        t = (dot(u, u) * dot(v, w) - dot(u, v) * dot(u, w)) / d
        if s >= 0 and t >= 0 and s + t <= 1:
            found.append(dot(w, w) - s * dot(u, w) - t * dot(v, w))
    return min(found)


def soup(seed: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of few points in a small grid: flat ones, equal points, branches, all that is nasty."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 4, (max(4, count), 3)).astype(float)
    return points, rng.integers(0, len(points), (count, 3))


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32), st.integers(1, 30), st.sampled_from([-300, 0, 300]), st.booleans())
def test_nearest_beside_fractions(seed: int, count: int, exponent: int, hinted: bool) -> None:
    points, triangles = soup(seed, count)
    rng = np.random.default_rng(seed + 1)
    x = rng.integers(-9, 10, (12, 3)) / 2.0
    support = Support(np.ldexp(points, exponent), triangles)
    hint = rng.integers(0, count, 12) if hinted else None
    which, weights, foot = support.nearest(np.ldexp(x, exponent), hint)
    assert (weights >= -1e-15).all() and np.allclose(weights.sum(axis=1), 1)
    away = np.linalg.norm(np.ldexp(foot, -exponent) - x, axis=1)
    for i, row in enumerate(x):
        wanted = min(nearest_squared(row.tolist(), points[t].tolist()) for t in triangles)
        assert away[i] == pytest.approx(float(wanted) ** 0.5, abs=1e-12)
        own = nearest_squared(row.tolist(), points[triangles[which[i]]].tolist())
        assert float(own - wanted) == pytest.approx(0, abs=1e-12)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32), st.integers(1, 30))
def test_nearest_facing_beside_fractions(seed: int, count: int) -> None:
    """Only triangles that face the normal; all, where none does."""
    points, triangles = soup(seed, count)
    rng = np.random.default_rng(seed + 1)
    x, normals = rng.integers(-9, 10, (12, 3)) / 2.0, rng.integers(-2, 3, (12, 3)).astype(float)
    support = Support(points, triangles)
    which, _, foot = support.nearest(x, normals=normals)
    turned = support.normals @ normals.T
    for i, row in enumerate(x):
        faces = np.flatnonzero(turned[:, i] > 1e-12)
        if ((np.abs(turned[:, i]) <= 1e-12) & (turned[:, i] != 0)).any():  # upright, but for rounding
            continue
        if not normals[i].any() or len(faces) == 0:
            faces = np.arange(count)
        assert which[i] in faces
        wanted = min(nearest_squared(row.tolist(), points[triangles[t]].tolist()) for t in faces)
        assert np.linalg.norm(foot[i] - row) == pytest.approx(float(wanted) ** 0.5, abs=1e-12)


def counted(points: np.ndarray, triangles: np.ndarray) -> set[tuple[int, int]]:
    """Edges that have other than two triangles, or two in one direction; equal points are one."""
    first: dict[tuple, int] = {}
    for i, row in enumerate(points.tolist()):
        first.setdefault(tuple(row), i)
    runs = defaultdict(list)
    for row in triangles:
        a, b, c = (first[tuple(points[v].tolist())] for v in row)
        if len({a, b, c}) == 3:
            for u, v in ((a, b), (b, c), (c, a)):
                runs[min(u, v), max(u, v)].append(u < v)
    return {edge for edge, way in runs.items() if len(way) != 2 or way[0] == way[1]}


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32), st.integers(1, 30))
def test_features_beside_counting(seed: int, count: int) -> None:
    points, triangles = soup(seed, count)
    support = Support(points, triangles)
    assert set(map(tuple, np.sort(support.features, axis=1).tolist())) == counted(points, triangles)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32), st.integers(1, 30))
def test_curves_run_between_corners(seed: int, count: int) -> None:
    """Each curve is connected, passes no corner, and leaves no vertex that is none; two curves share none."""
    support = Support(*soup(seed, count), sharp=60)
    corners = set(support.corners.tolist())
    assert set(support.chain.tolist()) == set(range(support.chain.max(initial=-1) + 1))
    seen: dict[int, int] = {}
    for number in range(support.chain.max(initial=-1) + 1):
        edges = support.features[support.chain == number].tolist()
        assert all(one[1] == two[0] for one, two in pairwise(edges))
        at = defaultdict(list)
        for u, v in edges:
            at[u].append(v)
            at[v].append(u)
        for v, others in at.items():
            if v not in corners:
                assert len(others) == 2 and seen.setdefault(v, number) == number
        todo, reached = [0], {0}
        while todo:
            now = edges[todo.pop()]
            for i, other in enumerate(edges):
                if i not in reached and (set(now) & set(other)) - corners:
                    reached.add(i)
                    todo.append(i)
        assert len(reached) == len(edges)


def test_features_of_a_cube() -> None:
    cube = Domain.box((0, 0, 0), (1, 1, 1)).triangulated
    support = Support(cube.points, cube.triangles, sharp=40)
    assert len(support.features) == 12 and len(support.corners) == 8
    assert sorted(support.chain.tolist()) == list(range(12))
    without = Support(cube.points, cube.triangles)
    assert len(without.features) == 0 and len(without.corners) == 0


def test_curves_that_close_and_the_tip_of_a_cone() -> None:
    angle = np.arange(24) * np.pi / 12
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([rim, [[0, 0, 2], [0, 0, 0]]])
    i = np.arange(24)
    j = (i + 1) % 24
    triangles = np.concatenate([np.column_stack([i, j, 0 * i + 24]), np.column_stack([j, i, 0 * i + 25])])
    support = Support(points, triangles, sharp=40)
    assert len(support.features) == 24 and (support.chain == 0).all(), "one closed curve around the base"
    assert support.corners.tolist() == [24]
    edge, t, foot = support.onto_chain([[3.0, 0.0, 5.0]], 0)
    assert foot[0] == pytest.approx([1, 0, 0]) and 0 in support.features[edge[0]] and t[0] in (0, 1)


def test_flat_triangles_equal_points_and_branches() -> None:
    """A crease along a flat triangle; halves of a square with points of their own; three sheets at one."""
    points = [*SQUARE, [2, 0, 0], [0, 0, 4], [4, 0, 4]]
    rows = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [5, 6, 4], [5, 4, 0], [6, 1, 4]]
    support = Support(points, rows, sharp=40)
    kept = set(map(tuple, np.sort(support.features, axis=1).tolist()))
    assert {(0, 4), (1, 4)} <= kept
    assert (0, 1) not in kept, "one side of the flat triangle is enough"
    twice = Support([*SQUARE, *SQUARE], [[0, 1, 2], [4, 6, 7]])
    assert np.sort(twice.features, axis=1).tolist() == [[0, 1], [0, 3], [1, 2], [2, 3]]
    assert twice.corners.tolist() == [0, 1, 2, 3], "turns by a right angle, also without creases"
    three = Support([*SQUARE, [0, 0, 4]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]])
    assert [0, 2] in three.features.tolist() and set(three.corners.tolist()) >= {0, 2}
    hourglass = Support([[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]], [[0, 1, 2], [0, 3, 4]])
    assert 0 in hourglass.corners.tolist()


def test_thin_plate() -> None:
    """Points above one side of a plate that is thinner than they are off stay on that side with normals."""
    plate = Domain.box((0, 0, 0), (1, 1, 0.01)).triangulated
    support = Support(plate.points, plate.triangles, sharp=40)
    x = [[0.4, 0.5, -0.001], [0.4, 0.5, 0.008]]
    _, _, foot = support.nearest(x, normals=[[0, 0, 1], [0, 0, -1]])
    assert foot[:, 2].tolist() == [0.01, 0.0]
    _, _, foot = support.nearest(x)
    assert foot[:, 2].tolist() == [0.0, 0.01]


def test_named_edges_and_vertices_exactly() -> None:
    support = Support(SQUARE, [[0, 1, 2], [0, 2, 3]], edges=[[2, 0]])
    assert np.sort(support.features, axis=1).tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    _, _, foot = support.nearest([[5, -1, 3.3]])
    assert foot.tolist() == [[4, 0, 0]]
    place, stack = np.zeros(6), np.empty(128, dtype=np.int64)
    x = np.array([[2.0, 1.9, 1.0]]) * support.factor
    found = nearest_on_chain(support.held, x, 0, -1, place, stack)
    assert support.features[found].tolist() == [0, 2], "the nearest of all curves"


@settings(deadline=None, max_examples=12)
@given(st.integers(0, 2**32), st.integers(1, 9), st.integers(1, 9), st.sampled_from([-300, 0, 300]))
def test_distances_beside_fractions(seed: int, count: int, many: int, exponent: int) -> None:
    """The largest distance at samples of each triangle, both ways, and of all, by every pair in fractions."""
    points, triangles = soup(seed, count)
    x, rows = soup(seed + 1, many)
    support, step = Support(np.ldexp(points, exponent), triangles), 3.0
    found = support.distances(np.ldexp(x, exponent), rows, np.ldexp(step, exponent))
    for corners, others, away in (
        (x[rows], points[triangles], found[0]),
        (points[triangles], x[rows], found[1]),
    ):
        for corner, mine in zip(corners, np.ldexp(away, -exponent)):
            sides = corner - np.roll(corner, 1, axis=0)
            k = max(1, int(np.ceil(np.sqrt((sides**2).sum(axis=1)).max() / step)))
            shares = [(i, j, k - i - j) for i in range(k + 1) for j in range(k + 1 - i)]
            exact = [[Fraction(int(v)) for v in row] for row in corner]
            samples = [
                [sum(s * c for s, c in zip(share, side)) / k for side in zip(*exact)] for share in shares
            ]
            samples.append([sum(side) / Fraction(3) for side in zip(*exact)])
            wanted = max(min(nearest_squared(p, list(t)) for t in others.tolist()) for p in samples)
            assert mine == pytest.approx(float(wanted) ** 0.5, rel=1e-12, abs=1e-14)
    whole = support.deviation(np.ldexp(x, exponent), rows, np.ldexp(step, exponent))
    assert whole == tuple(away.max() for away in found)


def test_deviation_both_ways() -> None:
    """A cap that is missing is seen one way, a tent that is too much the other."""
    support = Support(SQUARE, [[0, 1, 2], [0, 2, 3]])
    there, back = support.deviation(SQUARE, [[0, 1, 2]])
    assert there == 0 and back == pytest.approx(8**0.5)
    there, back = support.deviation([*SQUARE, [2, 2, 3]], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], 0.1)
    assert there == 3 and 0.5 < back <= 12 / 13**0.5 / 2 * 1.5
    assert support.deviation(SQUARE, [[0, 1, 2], [0, 2, 3]], 1e-9) == (0, 0), "the step grows if it must"
    assert Support(np.zeros((3, 3)), [[0, 1, 2]]).deviation(np.zeros((3, 3)), [[0, 1, 2]]) == (0, 0)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(*[st.integers(-1, 1)] * 3), min_size=1, max_size=30))
def test_equal_points(rows: list) -> None:
    points = np.array(rows, dtype=float)
    assert same_points(points).tolist() == [rows.index(row) for row in rows]
    assert same_points(points * -0.0).tolist() == [0] * len(rows), "zeros of both signs are equal"


@pytest.mark.parametrize(
    ("arguments", "options", "text"),
    [
        (([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), {}, "space"),
        ((SQUARE, [[0, 1, 7]]), {}, r"triangles\[0\]"),
        ((SQUARE, [[0.0, 1.0, 2.0]]), {}, "rows of 3 vertices"),
        ((SQUARE, np.empty((0, 3), int)), {}, "at least one"),
        ((SQUARE, [[0, 1, 2]]), {"sharp": 200}, "between 0 and 180"),
        ((SQUARE, [[0, 1, 2]]), {"edges": [[0, 9]]}, r"edges\[0\]"),
    ],
)
def test_wrong_arguments(arguments: tuple, options: dict, text: str) -> None:
    with pytest.raises(InputError, match=text):
        Support(*arguments, **options)


def test_wrong_queries() -> None:
    support = Support(SQUARE, [[0, 1, 2], [0, 2, 3]])
    for call in (
        lambda: support.nearest([[0, 0]]),
        lambda: support.nearest([[0, 0, 0]], hint=[5]),
        lambda: support.nearest([[0, 0, 0]], normals=[[0, 0, 1], [0, 0, 1]]),
        lambda: support.onto_chain([[0, 0, 0]], 9),
        lambda: support.deviation(SQUARE, [[0, 1, 9]]),
        lambda: support.deviation(SQUARE, np.empty((0, 3), int)),
    ):
        with pytest.raises(InputError):
            call()
