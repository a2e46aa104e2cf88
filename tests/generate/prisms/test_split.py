"""Columns of wedges cut into tetrahedra: conforming, and which divisions of a positive wedge are negative."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import Mesh, check
from unstruct.generate.prisms.cells import cells_of
from unstruct.generate.prisms.split import negative_parts, tetrahedra, twisted
from unstruct.geometry.jacobians import wedge_signs

ONE_WEDGE = np.arange(6)[None].astype(np.int32)


def volume(points: np.ndarray, row: list[int]) -> Fraction:
    """Six times the volume of a tetrahedron, without rounding."""
    p = [[Fraction(float(x)) for x in points[v]] for v in row]
    (a, b, c), (d, e, f), (g, h, i) = ([x - y for x, y in zip(q, p[0])] for q in p[1:])
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def turned_prism(cosine: int, sine: int, unit: int) -> np.ndarray:
    """A prism over a nearly equilateral triangle, whose top is turned: whole coordinates."""
    base = np.array([(52.0, 0.0), (-26.0, 45.0), (-26.0, -45.0)])
    top = np.column_stack([base[:, 0] * cosine - base[:, 1] * sine, base[:, 0] * sine + base[:, 1] * cosine])
    return np.concatenate(
        [np.column_stack([unit * base, np.zeros(3)]), np.column_stack([top, np.full(3, 100.0)])]
    )


def ranks(order: tuple[int, ...]) -> np.ndarray:
    """Numbers of the six corners by level, then by the place of the ray in an order."""
    return np.array([*order, *(3 + k for k in order)])


@pytest.mark.parametrize(
    ("turn", "wrong"),
    [((1, 0, 1), 0), ((4, 3, 5), 0), ((0, 1, 1), 3), ((0, -1, 1), 3), ((-3, 4, 5), 6), ((-3, -4, 5), 6)],
    ids=["straight", "37 degrees", "90 degrees", "-90 degrees", "127 degrees", "-127 degrees"],
)
def test_a_positive_wedge_may_have_negative_tetrahedra(turn: tuple[int, int, int], wrong: int) -> None:
    points = turned_prism(*turn)
    assert wedge_signs(points[ONE_WEDGE]).tolist() == [1]
    found = [
        len(negative_parts(points, {"wedge": ONE_WEDGE}, ranks(order))) for order in permutations(range(3))
    ]
    assert sum(found) == wrong
    for order in permutations(range(3)):
        rows, _ = tetrahedra({"wedge": ONE_WEDGE}, ranks(order))
        signs = [volume(points, row) > 0 for row in rows.tolist()]
        assert sorted(signs)[1:] == [True, True]  # at most the one in the middle is negative


def test_lower_heights_make_every_division_positive() -> None:
    points = turned_prism(-3, 4, 5)
    for step in range(60):
        share = 0.5**step
        low = np.concatenate([points[:3], points[:3] + share * (points[3:] - points[:3])])
        if not any(len(negative_parts(low, {"wedge": ONE_WEDGE}, ranks(p))) for p in permutations(range(3))):
            break
    assert step == 2


def columns_of_grid(n: int) -> np.ndarray:
    """A square of n x n vertices cut into triangles."""
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return np.concatenate(
        [np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])]
    ).astype(np.int32)


@given(
    st.integers(2, 4),
    st.integers(1, 3),
    st.data(),
)
def test_divisions_fit_for_any_numbering(n: int, levels: int, data: st.DataObject) -> None:
    columns = columns_of_grid(n)
    x, y = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    stop = np.array(data.draw(st.lists(st.integers(0, levels), min_size=n * n, max_size=n * n)))
    number = np.minimum(np.arange(levels + 1)[:, None], stop) * n * n + np.arange(n * n)
    cells = cells_of(columns, number.astype(np.int32)).kinds
    if not cells:
        return
    z = np.repeat(np.arange(levels + 1.0), n * n)
    points = np.column_stack([np.tile(x, levels + 1), np.tile(y, levels + 1), z])
    rank = np.array(data.draw(st.permutations(range(len(points)))))
    rows, owner = tetrahedra(cells, rank)
    used = np.unique(rows)
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    mesh = Mesh(points[used], place[rows])
    report = check(mesh)
    alone = {"pinched vertex", "pinched edge", "link"}  # cells that touch only in vertices or edges
    assert not {p.kind for p in report.problems} - alone, report
    assert (np.diff(owner) >= 0).all() and len(np.unique(owner)) == sum(map(len, cells.values()))


@given(
    st.lists(st.integers(-6, 6), min_size=9, max_size=9),
    st.permutations(range(3)),
    st.integers(0, 30),
    st.permutations(range(3)),
)
def test_twisted_columns_are_those_with_negative_tetrahedra(
    values: list[int], order: list[int], tenths: int, first: list[int]
) -> None:
    """Also where the vertices of the wall are in another order than the rays."""
    base = np.array([(8.0, 0.0, 0.0), (-4.0, 7.0, 0.0), (-4.0, -7.0, 0.0)])
    along = np.array(values, dtype=float).reshape(3, 3)
    along[:, 2] += 9.0
    shares = np.array([0.0, 1.0, 3.0])[:, None, None] * tenths / 10
    places = np.empty((3, 3, 3))
    places[:, order] = base + shares * along
    columns = np.array([order], dtype=np.int32)
    number = np.arange(9, dtype=np.int32).reshape(3, 3)
    number[0] = first
    cells = cells_of(columns, number).kinds
    every = places.copy()
    every[0, first] = places[0]
    every = every.reshape(-1, 3)
    rows, owner = tetrahedra({"wedge": cells["wedge"]})
    bad = {int(o) for row, o in zip(rows.tolist(), owner) if volume(every, row) <= 0}
    assert sorted(bad) == negative_parts(every, {"wedge": cells["wedge"]}).tolist()
    positive = (wedge_signs(every[cells["wedge"]]) == 1).all()
    if positive:
        assert bool(twisted(places, columns, base=number[0])[0]) == bool(bad)
        if first == [0, 1, 2]:
            assert bool(twisted(places, columns)[0]) == bool(bad)
