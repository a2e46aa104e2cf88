"""``resolve=True`` where arcs meet: areas against formulas and integrals, insides against parity, meshes."""

from __future__ import annotations

from itertools import combinations, pairwise
from math import acos, cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from unstruct import Domain, InputError, check, constrained_delaunay, refine
from unstruct.domain.arguments import joined
from unstruct.geometry.curves import Arc, Bezier

Disc = tuple[float, float, float]
Box = tuple[float, float, float, float]


def shape(parts: Disc | Box) -> Domain:
    return Domain.disc(parts[:2], parts[2]) if len(parts) == 3 else Domain.rectangle(parts[:2], parts[2:])


def together(*shapes: Disc | Box) -> Domain:
    """All pieces of the shapes in one domain: inside is what an odd number of them covers."""
    return Domain(**joined([shape(s) for s in shapes]), resolve=True)


def cap(radius: float, distance: float) -> float:
    """The area that a line at this distance from the center cuts off a disc."""
    return radius**2 * acos(distance / radius) - distance * sqrt(radius**2 - distance**2)


def lens(r: float, s: float, d: float) -> float:
    """The common area of two discs whose centers have this distance."""
    return cap(r, (d * d + r * r - s * s) / (2 * d)) + cap(s, (d * d + s * s - r * r) / (2 * d))


UNIT = (0.0, 0.0, 1.0, 1.0)
CASES = {
    "disc over a side": ((UNIT, (0.5, 0.1, 0.25)), 1 + pi / 16 - 2 * (pi / 16 - cap(0.25, 0.1)), 2),
    "disc halfway over a side": ((UNIT, (0.5, 0.0, 0.25)), 1.0, 2),
    "disc over a corner": ((UNIT, (1.0, 1.0, 0.5)), 1 + pi / 8, 2),
    "disc over the whole": ((UNIT, (0.5, 0.5, 0.6)), 1 + pi * 0.36 - 2 * (pi * 0.36 - 4 * cap(0.6, 0.5)), 8),
    "corners on the disc": ((UNIT, (0.5, 0.5, sqrt(0.5))), pi / 2 - 1, None),
    "two discs": (((0.0, 0.0, 1.0), (1.0, 0.0, 1.0)), 2 * pi - 2 * lens(1, 1, 1), 2),
    "two discs of any size": (((0.1, 0.2, 1.0), (0.7, 1.0, 0.6)), pi * 1.36 - 2 * lens(1, 0.6, 1), 2),
    "disc in a disc": (((0.0, 0.0, 1.0), (0.1, 0.05, 0.5)), 0.75 * pi, 0),
    "discs apart": (((0.0, 0.0, 1.0), (3.0, 0.0, 1.0)), 2 * pi, 0),
    "tangent from inside": ((UNIT, (0.5, 0.25, 0.25)), 1 - pi / 16, 1),
    "tangent at no vertex": (((0.0, 0.0, 1.0), (1.2, 1.6, 1.0)), 2 * pi, 1),
    "three through points": (
        ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (0.5, sqrt(3) / 2, 1.0)),
        3 * pi - 6 * lens(1, 1, 1) + 4 * ((pi - sqrt(3)) / 2),
        None,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_areas_are_those_of_formulas(name: str) -> None:
    shapes, area, many = CASES[name]
    domain = together(*shapes)
    assert abs(domain.area - area) <= 1e-12 * max(1.0, area)
    assert many is None or len(domain.repairs) == many
    for mesh in (constrained_delaunay(domain), refine(domain, 0.2)):
        report = check(mesh, domain=domain)
        assert report, str(report)


def test_arcs_that_touch_from_within_are_refused_with_a_reason() -> None:
    with pytest.raises(InputError, match=r"touch at their common vertex near \(0\.6, 0\.8\)"):
        together((0.0, 0.0, 1.0), (0.3, 0.4, 0.5))


def test_both_parts_keep_center_and_radius() -> None:
    domain = together((0.0, 0.0, 1.0), (1.0, 0.0, 1.0))
    assert {(curve.center, curve.radius) for curve in domain.curves.values()} == {((0, 0), 1), ((1, 0), 1)}
    assert len(domain.points) == 10 and len(domain.facets) == 12
    new = domain.points[domain.origin < 0]
    assert np.array_equal(np.abs(new), [[0.5, sqrt(0.75)]] * 2)
    assert [r.kind for r in domain.repairs] == ["crossing"] * 2 and "odd number" in domain.repairs[0].text
    assert sorted(domain.piece_origin.tolist()) == [0, 0, 1, 2, 3, 3, 4, 5, 5, 6, 6, 7]


def test_arcs_of_one_circle() -> None:
    angles = [0.3, 2.1, 4.0, 0.3 + 2 * pi]
    turned = Domain(
        [[cos(t), sin(t)] for t in angles[:3]],
        [[0, 1], [1, 2], [2, 0]],
        curves={i: Arc((0, 0), 1, angles[i], angles[i + 1] - angles[i]) for i in range(3)},
    )
    for other in (turned, Domain.disc()):  # twice the same disc: nothing is left of it
        twice = Domain(**joined([Domain.rectangle((-2, -2), (2, 2)), Domain.disc(), other]), resolve=True)
        assert twice.area == 16 and len(twice.points) == 4 and len(twice.facets) == 4
    half = Domain([[1, 0], [-1, 0]], [[0, 1], [1, 0]], curves={0: Arc((0, 0), 1, 0, pi)})
    rest = Domain(**joined([half, Domain.disc()]), resolve=True)
    assert abs(rest.area - pi / 2) < 1e-15 and (rest.points[:, 1] <= 0).all()
    with pytest.raises(InputError, match="no facet is left"):
        Domain(**joined([Domain.disc(), turned]), resolve=True)


def test_a_closed_arc_gets_a_second_vertex() -> None:
    whole = Domain([[1, 0]], [[0, 0]], curves={0: Arc((0, 0), 1, 0, 2 * pi)}, resolve=True)
    assert abs(whole.area - pi) < 1e-15 and [r.kind for r in whole.repairs] == ["closed curve"]


def test_an_interface_that_ends_on_a_side() -> None:
    points, ring = [[0, 0], [1, 0], [1, 1], [0, 1], [0.25, 0], [0.75, 0]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    curves = {4: Arc((0.5, 0), 0.25, pi, -pi)}
    with pytest.raises(InputError, match=r"point 4 lies on facet 0 .*resolve=True"):
        Domain(points, ring, inner=[[4, 5]], curves=curves)
    domain = Domain(points, ring, inner=[[4, 5]], curves=curves, resolve=True, regions={"half": [0.5, 0.1]})
    assert domain.area == 1 and [r.kind for r in domain.repairs] == ["vertex on a segment"] * 2
    assert check(refine(domain, 0.1), domain=domain)
    bow = {4: Bezier([[0.25, 0], [0.5, 0.5], [0.75, 0]])}  # the vertices of any curve split straight pieces
    assert len(Domain(points, ring, inner=[[4, 5]], curves=bow, resolve=True).facets) == 6


def test_other_curves_are_refused_with_a_reason() -> None:
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [0.25, 0.5], [0.75, 0.5]]
    bow = {4: Bezier([[0.25, 0.5], [0.5, -1.0], [0.75, 0.5]])}
    with pytest.raises(InputError, match=r"cross or touch near .*straight pieces and arcs alone"):
        Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[[4, 5]], curves=bow, resolve=True)


# ---------------------------------------------------------------------- discs and boxes on a grid


def oracle_area(shapes: list[Disc | Box]) -> float:
    """Heights covered by an odd number of shapes, integrated between all places where their order changes."""
    at = {x for s in shapes for x in ((s[0] - s[2], s[0], s[0] + s[2]) if len(s) == 3 else (s[0], s[2]))}
    for s, t in combinations(shapes, 2):
        if len(s) == len(t) == 3:
            dx, dy = t[0] - s[0], t[1] - s[1]
            square = dx * dx + dy * dy
            if square > 0:
                along = (square + s[2] ** 2 - t[2] ** 2) / (2 * square)
                across = sqrt(max(0.0, s[2] ** 2 / square - along**2))
                at |= {s[0] + along * dx - k * across * dy for k in (-1, 1)}
        elif len(s) != len(t):
            disc, box = (s, t) if len(s) == 3 else (t, s)
            for y in (box[1], box[3]):
                reach = sqrt(max(0.0, disc[2] ** 2 - (y - disc[1]) ** 2))
                at |= {disc[0] - reach, disc[0] + reach}
    places = sorted(at)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    total = 0.0
    for low, high in pairwise(places):
        angle = nodes * pi / 2  # roots at the ends become smooth
        x = (low + high) / 2 + (high - low) / 2 * np.sin(angle)
        ends = []
        for s in shapes:
            if len(s) == 3:
                half = np.sqrt(np.maximum(0.0, s[2] ** 2 - (x - s[0]) ** 2))
                ends += [s[1] - half, s[1] + half]
            elif s[0] <= low and high <= s[2]:
                ends += [np.full(len(x), s[1]), np.full(len(x), s[3])]
        heights = np.sort(np.array(ends), axis=0) if ends else np.zeros((0, len(x)))
        odd = (heights[1::2] - heights[::2]).sum(axis=0)
        total += (high - low) / 2 * pi / 2 * float(weights @ (odd * np.cos(angle)))
    return total


def depth(s: Disc | Box, x: np.ndarray) -> np.ndarray:
    """How far points are inside of a shape; negative outside."""
    if len(s) == 3:
        return s[2] - np.hypot(x[:, 0] - s[0], x[:, 1] - s[1])
    return np.minimum(np.minimum(x[:, 0] - s[0], s[2] - x[:, 0]), np.minimum(x[:, 1] - s[1], s[3] - x[:, 1]))


def touch_within(s: Disc, t: Disc) -> bool:
    return abs(np.hypot(s[0] - t[0], s[1] - t[1]) - abs(s[2] - t[2])) < 1e-9 * s[2]


grid = st.integers(0, 8).map(lambda k: k / 4)
discs = st.tuples(grid, grid, st.integers(1, 5).map(lambda k: k / 4))
tilted = st.tuples(grid, grid, st.sampled_from([5 / 8, 13 / 16, 0.1, 0.7, sqrt(0.5), sqrt(0.125), 1 / 3]))
boxes = st.tuples(grid, grid, st.integers(1, 6), st.integers(1, 6)).map(
    lambda b: (b[0], b[1], b[0] + b[2] / 4, b[1] + b[3] / 4)
)


@settings(max_examples=120, deadline=None)
@given(st.lists(st.one_of(discs, tilted, boxes), min_size=2, max_size=4), st.sampled_from([1.0, 0.3, 1e5]))
@example([(0.5, 0.5, 0.5), (0.0, 0.0, 1.0, 1.0), (0.5, 0.5, sqrt(0.5))], 1.0)
def test_discs_and_boxes(shapes: list[Disc | Box], scale: float) -> None:
    shapes = [tuple(c * scale for c in s) for s in shapes]
    area = oracle_area(shapes)
    try:
        domain = together(*shapes)
    except InputError as error:
        if "common vertex" in str(error):
            assert any(touch_within(s, t) for s, t in combinations(shapes, 2) if len(s) == len(t) == 3)
        else:
            assert "no facet is left" in str(error) and abs(area) < 1e-9 * scale**2
        return
    assert abs(domain.area - area) <= 1e-9 * scale**2
    x = np.random.default_rng(0).random((200, 2)) * 4 * scale - scale
    inside = np.array([depth(s, x) for s in shapes])
    clear = (np.abs(inside) > 1e-6 * scale).all(axis=0)
    assert np.array_equal(domain.contains(x[clear]), (inside > 0).sum(axis=0)[clear] % 2 == 1)
    report = check(constrained_delaunay(domain), domain=domain)
    assert report, str(report)
    parts = {name: getattr(domain, name) for name in ("points", "facets", "inner", "curves")}
    assert not Domain(**parts, resolve=True).repairs  # nothing is left to be done
