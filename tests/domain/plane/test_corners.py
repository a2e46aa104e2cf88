"""Pieces that cross once more near a common vertex: against sign changes along very many points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, InputError, check, constrained_delaunay
from unstruct.domain.plane.corners import crossings_at_corners
from unstruct.geometry.curves import Arc, Bezier
from unstruct.geometry.outline import Outline


def arc_from(vertex: np.ndarray, direction: float, radius: float, sweep: float) -> Arc:
    """The arc that leaves a vertex in a direction; it turns left for a positive sweep."""
    side = math.copysign(math.pi / 2, sweep)
    center = vertex + radius * np.array([math.cos(direction + side), math.sin(direction + side)])
    return Arc(center, radius, direction - side, sweep)


def oracle(one: Arc, two: Arc | np.ndarray, vertex: np.ndarray) -> bool:
    """Whether the first piece crosses the second one again, seen at points that thicken to the vertex."""
    t = np.unique(np.concatenate([np.geomspace(1e-7, 1, 4000), np.linspace(0, 1, 4000)[1:]]))
    x = one.point(t) - vertex
    if isinstance(two, Arc):
        c = np.array(two.center) - vertex
        value = (x * x).sum(axis=1) - 2 * x @ c
    else:
        value = x @ np.array([-two[1], two[0]])
    for k in np.nonzero(value[1:] * value[:-1] < 0)[0]:
        y = (x[k] + x[k + 1]) / 2
        if isinstance(two, Arc):
            angle = np.sign(two.sweep) * (math.atan2(y[1] - c[1], y[0] - c[0]) - two.start)
            if angle % (2 * math.pi) < abs(two.sweep):
                return True
        elif 0 < y @ two < two @ two:
            return True
    return False


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_second_meetings_are_those_of_the_curves(data: st.DataObject) -> None:
    vertex = np.array(data.draw(st.tuples(st.integers(-3, 3), st.integers(-3, 3)))) * 0.37
    angle = st.floats(-3.1, 3.1)
    first = data.draw(angle)
    between = data.draw(st.sampled_from([0.001, 0.02, 0.3, 1.7])) * data.draw(st.sampled_from([-1, 1]))
    sweeps = st.sampled_from([-5.0, -2.0, -0.4, 0.4, 1.0, 3.0])
    one = arc_from(vertex, first, data.draw(st.floats(0.2, 3)), data.draw(sweeps))
    points, facets, curves = [vertex, one.point(np.ones(1))[0]], [[0, 1], [0, 2]], {0: one}
    if data.draw(st.booleans()):
        other: Arc | np.ndarray = arc_from(
            vertex, first + between, data.draw(st.floats(0.2, 3)), data.draw(sweeps)
        )
        assert isinstance(other, Arc)
        points.append(other.point(np.ones(1))[0])
        curves[1] = other
        gap = np.hypot(*(np.array(other.center) - one.center))
        if gap < 0.05:  # nearly one circle: where they meet is ill-conditioned
            return
    else:
        other = data.draw(st.floats(0.1, 4)) * np.array(
            [math.cos(first + between), math.sin(first + between)]
        )
        points.append(vertex + other)
    region = plain(np.array(points), np.array(facets), curves)
    pairs, places = crossings_at_corners(region)  # type: ignore[arg-type]
    near_an_end = len(places) and min(np.hypot(*(places[0] - p)) for p in points[1:]) < 2e-3
    if not near_an_end:
        assert (len(pairs) > 0) == oracle(one, other, vertex) or ends_touch(one, other, points)


def ends_touch(one: Arc, other: Arc | np.ndarray, points: list[np.ndarray]) -> bool:
    """An end of one piece nearly on the other one: the oracle's samples cannot tell."""
    t = np.linspace(0, 1, 20_001)
    chains = [one.point(t), other.point(t) if isinstance(other, Arc) else points[0] + t[:, None] * other]
    return any(np.hypot(*(chains[1 - k] - points[1 + k]).T).min() < 2e-3 for k in (0, 1))


def plain(points: np.ndarray, pieces: np.ndarray, curves: dict[int, Arc]) -> Outline:
    """Points, pieces and curves that nobody has validated, as `crossings_at_corners` reads them."""
    return Outline(points, pieces, np.empty((0, 2), dtype=np.int32), curves, {}, {})


@pytest.mark.parametrize("x0", [0.3, 0.1, 0.01, 1e-3, 1e-4, 1e-6])
def test_an_arc_that_cuts_the_side_it_starts_from(x0: float) -> None:
    """The samples of a coarse chord used to pass over the first part of it."""
    center = np.array([x0 / 2, 2.0])
    radius = math.hypot(x0 / 2, 2.0)
    start, stop = math.atan2(-2, -x0 / 2), -math.pi / 2 + 0.7
    last = center + radius * np.array([math.cos(stop), math.sin(stop)])
    arc = Arc(center, radius, stop, start - stop)
    told = r"facet 0 and facet 2 (cross or touch|touch at their common vertex) near"
    with pytest.raises(InputError, match=told):
        Domain([[0, 0], [1.5, 0], last], [[0, 1], [1, 2], [2, 0]], curves={2: arc})


def test_what_only_touches_in_a_vertex_is_left_alone() -> None:
    disc = Domain.disc((3.0, 1e3), 2.0)  # arcs of one circle
    lens = Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={
        0: Arc.through([-1, 0], [0, -0.3], [1, 0]), 1: Arc.through([1, 0], [0, 0.5], [-1, 0])})  # fmt: skip
    r = 0.25  # rounded corners: sides are tangents of arcs
    straight = [[r, 0], [1 - r, 0], [1, r], [1, 1 - r], [1 - r, 1], [r, 1], [0, 1 - r], [0, r]]
    centers = {1: (1 - r, r, -90), 3: (1 - r, 1 - r, 0), 5: (r, 1 - r, 90), 7: (r, r, 180)}
    arcs = {i: Arc((x, y), r, math.radians(a), math.pi / 2) for i, (x, y, a) in centers.items()}
    plate = Domain(straight, [[i, (i + 1) % 8] for i in range(8)], curves=arcs)
    centers = {0: (-1.0, 0.0), 1: (1.0, 0.0)}  # two disks that touch from without, in a vertex
    pair = Domain(
        [[0, 0], [-2, 0], [2, 0]], [[0, 1], [1, 0], [0, 2], [2, 0]],
        curves={0: Arc(centers[0], 1, 0, math.pi), 1: Arc(centers[0], 1, math.pi, math.pi),
                2: Arc(centers[1], 1, math.pi, math.pi), 3: Arc(centers[1], 1, 0, math.pi)})  # fmt: skip
    assert pair.area == pytest.approx(2 * math.pi)
    for domain in (disc, lens, plate, pair):
        assert len(crossings_at_corners(domain)[0]) == 0
        assert check(constrained_delaunay(domain), domain=domain)


def test_other_curves_are_left_to_the_samples() -> None:
    bow = Bezier([[0, 0], [0.5, -0.5], [1, 0]])
    domain = Domain([[0, 0], [1, 0], [0.5, 1]], [[0, 1], [1, 2], [2, 0]], curves={0: bow})
    assert len(crossings_at_corners(domain)[0]) == 0
