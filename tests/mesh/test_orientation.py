"""Signs of cells of all kinds, simple polygons, and the turning of negative cells."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_cells import GOOD, cloud, planar, spatial

from unstruct import Mesh, MeshError, check
from unstruct.mesh.orientation import cell_signs, jacobian_signs, polygon_signs

Point = tuple[int, int]


def turn(a: Point, b: Point, c: Point) -> int:
    value = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (value > 0) - (value < 0)


def touch(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether closed segments ab and cd have a point in common: integers."""
    s = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)]
    if s[0] * s[1] < 0 and s[2] * s[3] < 0:
        return True

    def on(p: Point, q: Point, r: Point) -> bool:
        return all(min(p[i], q[i]) <= r[i] <= max(p[i], q[i]) for i in (0, 1))

    ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(sign == 0 and on(*three) for sign, three in zip(s, ends))


def simple(p: list[Point]) -> int:
    k = len(p)
    if len(set(p)) < k:
        return 0
    for i, j in combinations(range(k), 2):
        a, b, c, d = p[i], p[(i + 1) % k], p[j], p[(j + 1) % k]
        if len({a, b, c, d}) == 4 and touch(a, b, c, d):
            return 0
        if len({a, b, c, d}) < 4:  # neighbors: they must not fold back on each other
            if (
                b == c
                and turn(a, b, d) == 0
                and (a[0] - b[0]) * (d[0] - b[0]) + (a[1] - b[1]) * (d[1] - b[1]) > 0
            ):
                return 0
            if (
                d == a
                and turn(c, d, b) == 0
                and (c[0] - d[0]) * (b[0] - d[0]) + (c[1] - d[1]) * (b[1] - d[1]) > 0
            ):
                return 0
    area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(p, [*p[1:], p[0]]))
    return (area > 0) - (area < 0)


lattice = st.tuples(st.integers(0, 4), st.integers(0, 4))


@settings(max_examples=300, deadline=None)
@given(st.lists(lattice, min_size=3, max_size=8))
def test_polygons_on_a_lattice(corners: list[Point]) -> None:
    points = np.array(corners, dtype=float)
    assert polygon_signs(points, [np.arange(len(points))])[0] == simple(corners)


def test_polygons_of_many_corners() -> None:
    n = 300
    angle = 2 * np.pi * np.arange(n) / n
    star = (1 + 0.5 * (np.arange(n) % 2))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    ring = [np.arange(n), np.arange(n)[::-1]]
    assert polygon_signs(star, ring).tolist() == [1, -1]
    twice = np.column_stack([np.cos(2 * angle), np.sin(2 * angle)]) * (1 + 0.001 * np.arange(n))[:, None]
    assert polygon_signs(twice, [np.arange(n)]).tolist() == [0]
    pentagram = np.column_stack([np.cos(2 * angle[::60]), np.sin(2 * angle[::60])])
    assert polygon_signs(pentagram, [np.arange(5)]).tolist() == [0], "all corners turn left, twice around"
    assert polygon_signs(star, []).shape == (0,)


def quad_sign(p: list[Point]) -> int:
    found = {turn(p[i - 1], p[i], p[(i + 1) % 4]) for i in range(4)}
    return found.pop() if len(found) == 1 else 0


@settings(max_examples=200, deadline=None)
@given(st.lists(lattice, min_size=4, max_size=4), st.sampled_from([1.0, 0.1, 2.0**-500]))
def test_quadrilaterals_on_a_lattice(corners: list[Point], scale: float) -> None:
    """Exactly the convex ones are positive: an arrow is valid as a polygon, but not as a quad."""
    mesh = cloud("quad", np.array([corners]) * scale)
    exact = [(Fraction(x * scale), Fraction(y * scale)) for x, y in corners]
    assert mesh.jacobian_signs().tolist() == [quad_sign(exact)]


@pytest.mark.parametrize("kind", GOOD)
def test_every_kind_is_turned(kind: str) -> None:
    good = np.array([GOOD[kind]], dtype=float)
    d = good.shape[2]
    mesh = Mesh(good[0], cells={kind: [list(range(len(good[0])))]})
    assert mesh.jacobian_signs().tolist() == [1] == cell_signs(mesh).tolist()
    mirrored = Mesh(good[0] * ([-1] + [1] * (d - 1)), cells=mesh.cells, markers={"a": [3]})
    assert mirrored.jacobian_signs().tolist() == [-1]
    turned = mirrored.oriented()
    assert turned.jacobian_signs().tolist() == [1] and turned.markers["a"].tolist() == [3]
    assert sorted(np.ravel(turned.cells[kind][0])) == list(range(len(good[0])))
    assert turned.volume == pytest.approx(mesh.volume) and turned.volume == -mirrored.volume
    assert {frozenset(e) for e in turned.edges.tolist()} == {frozenset(e) for e in mesh.edges.tolist()}
    assert check(turned), check(turned)
    again = turned.oriented()
    assert all((a == b).all() for a, b in zip(again.cells[kind], turned.cells[kind]))


@pytest.mark.parametrize("make", [planar, spatial])
def test_some_cells_turned_among_others(make) -> None:  # type: ignore[no-untyped-def]
    mesh = make(3, jitter=0.1, seed=4)
    mirrors = {
        "quad": [0, 3, 2, 1],
        "triangle": [0, 2, 1],
        "tetra": [1, 0, 2, 3],
        "pyramid": [0, 3, 2, 1, 4],
        "wedge": [3, 4, 5, 0, 1, 2],
        "hexahedron": [4, 5, 6, 7, 0, 1, 2, 3],
    }
    cells, flipped = {}, []
    for kind, block in mesh.cells.items():
        rows = [row.tolist() for row in block]
        for i in range(0, len(rows), 2):
            rows[i] = rows[i][::-1] if kind == "polygon" else [rows[i][v] for v in mirrors[kind]]
        flipped += [i % 2 == 0 for i in range(len(rows))]
        cells[kind] = rows
    bad = Mesh(mesh.points, cells=cells)
    assert bad.jacobian_signs().tolist() == [-1 if f else 1 for f in flipped]
    report = check(bad)
    assert {p.kind for p in report.problems} >= {"negative cell"}
    assert next(p for p in report.problems if p.kind == "negative cell").cells == tuple(
        np.nonzero(flipped)[0].tolist()
    )
    assert check(bad.oriented()) and (bad.oriented().volumes > 0).all()


def test_surfaces_have_no_sign() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], cells={"quad": [[0, 1, 2, 3]]})
    with pytest.raises(MeshError, match="cells of dimension 2 have no sign in 3 dimensions"):
        mesh.jacobian_signs()
    with pytest.raises(MeshError, match="cells of dimension 2 have no sign in 3 dimensions"):
        mesh.oriented()


def test_undecided_cells_are_reported() -> None:
    base = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], dtype=float)
    top = base * [-0.5, -0.5, 1] + [0, 0, 4]
    mesh = Mesh([*base, *top], cells={"hexahedron": [range(8)]})
    signs, undecided = jacobian_signs(mesh)
    assert signs.tolist() == [0] and undecided.tolist() == [0]
    report = check(mesh)
    assert not report and "undecided" in {problem.kind for problem in report.problems}
