"""Arcs, parametric curves and Bezier curves; regions bounded by them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import random_region

from unstruct import Arc, Bezier, Curve, Domain, InputError
from unstruct.domain.plane import sample as domain_sample
from unstruct.geometry.outline_distance import distance_to_piece

HALF = np.array([0.0, 0.5, 1.0])


def ring(curves, points) -> Domain:
    n = len(points)
    return Domain(points, [[i, (i + 1) % n] for i in range(n)], curves=dict(enumerate(curves)))


def test_an_arc_by_center_and_by_three_points() -> None:
    arc = Arc((1, 2), 2, 0, math.pi)
    assert np.allclose(arc.point(HALF), [[3, 2], [1, 4], [-1, 2]])
    for sign in (1, -1):
        same = Arc.through((3, 2), (1, 2 + 2 * sign), (-1, 2))
        assert np.allclose([*same.center, same.radius, same.sweep], [1, 2, 2, sign * math.pi])
    long = Arc.through((1, 0), (-1, 0), (0, -1))
    assert math.isclose(long.sweep, 1.5 * math.pi)


@settings(max_examples=80, deadline=None)
@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=3, max_size=3, unique=True))
def test_an_arc_passes_its_three_points_in_order(points) -> None:
    a, b, c = points
    flat = (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0])
    if flat:
        with pytest.raises(InputError, match="on a line"):
            Arc.through(a, b, c)
        return
    arc = Arc.through(a, b, c)
    ends = arc.point(np.array([0.0, 1.0]))
    assert np.allclose(ends, [a, c], atol=1e-9)
    domain = Domain([ends[0], ends[1]], [], inner=[[0, 1]], curves={0: arc})
    away, t = distance_to_piece(domain, 0, np.array([b], dtype=float))
    assert away[0] < 1e-9 and 0 < t[0] < 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Arc((0, 0), 0, 0, 1), "radius = 0.0 must be positive"),
        (lambda: Arc((0, 0), 1, 0, 0), "sweep"),
        (lambda: Arc((0, 0), 1, 0, 7), "sweep"),
        (lambda: Arc((0, np.nan), 1, 0, 1), "center"),
        (lambda: Arc((0, 0, 0), 1, 0, 1), "center"),
        (lambda: Arc((0, 0), "wide", 0, 1), "radius must be a number"),
        (lambda: Arc("middle", 1, 0, 1), "center must be real numbers"),
        (lambda: Bezier([["a", 0], [1, 0]]), "controls must be real numbers"),
        (lambda: Curve(3), "callable"),
        (lambda: Curve(np.cos, 1, 1), "single point"),
        (lambda: Curve(np.cos).point(HALF), r"must return shape \(3, 2\)"),
        (
            lambda: Curve(lambda t: np.column_stack([t, 1 / (t - 0.5)])).point(HALF),
            "not finite at parameter 0.5",
        ),
        (lambda: Bezier([[0, 0]]), "controls must have shape"),
        (lambda: Bezier([[0, 0], [np.inf, 0]]), "finite"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_bad_curves(make, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_a_curve_keeps_its_ends_exactly_and_runs_either_way() -> None:
    def cubic(t):
        return np.column_stack([t, t**3])

    there, back = Curve(cubic, 0.1, 0.7), Curve(cubic, 0.7, 0.1)
    t = np.linspace(0, 1, 11)
    assert np.array_equal(there.point(t[[0, -1]]), cubic(np.array([0.1, 0.7])))
    assert np.allclose(there.point(t), back.point(1 - t))


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**9), st.integers(2, 5))
def test_bezier_curves_are_bernstein_sums(seed: int, count: int) -> None:
    controls = np.random.default_rng(seed).normal(size=(count, 2))
    t = np.linspace(0, 1, 9)
    n = count - 1
    wanted = sum(math.comb(n, i) * ((1 - t) ** (n - i) * t**i)[:, None] * controls[i] for i in range(count))
    assert np.allclose(Bezier(controls).point(t), wanted)
    assert np.array_equal(Bezier(controls).point(np.array([0.0, 1.0])), controls[[0, -1]])


def test_curves_must_meet_their_vertices() -> None:
    with pytest.raises(InputError, match=r"curve of facet 1 starts at .*vertex 1 is at \[1.0, 0.0\]"):
        Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={1: Arc((0, 0.1), 1, 0, math.pi)})
    with pytest.raises(InputError, match="curve of facet 1 starts"):  # the wrong way round
        Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={1: Arc((0, 0), 1, math.pi, -math.pi)})
    with pytest.raises(InputError, match="finite points"):

        class Bad:
            def point(self, t):
                return np.full((len(t), 2), np.nan)

        Domain([[-1, 0], [1, 0]], [[0, 1], [1, 0]], curves={1: Bad()})  # fmt: skip
    with pytest.raises(InputError, match=r"zero length.*second vertex on the curve"):
        Domain([[1, 0]], [[0, 0]], curves={0: Arc((0, 0), 1, 0, 2 * math.pi)})


def test_curves_that_lie_on_each_other_are_reported_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """They conflict everywhere, however finely they are cut: it used to go on to 2^28 chords."""
    there, back = Arc.through((0, 0), (0.5, -0.3), (1, 0)), Arc.through((1, 0), (0.5, -0.3), (0, 0))
    for second, end in (([1, 0], back), ([0, 1], there)):
        with pytest.raises(InputError, match="facet 0 and facet 1 are the same curve between points 0 and 1"):
            Domain([[0, 0], [1, 0]], [[0, 1], second], curves={0: there, 1: end})
    monkeypatch.setattr(domain_sample, "CONFLICTS", 256)
    turns = np.array([0, 2, 1, 3])
    points = [*np.column_stack([np.cos(turns), np.sin(turns)]).tolist(), [0, -1]]
    arcs = {0: Arc((0, 0), 1, 0, 2), 3: Arc((0, 0), 1, 1, 2)}
    with pytest.raises(InputError, match="facet 0 and inner segment 0 cross or touch"):
        Domain(points, [[0, 1], [1, 4], [4, 0]], inner=[[2, 3]], curves=arcs)


def test_crossing_and_touching_curves_are_named() -> None:
    def disc(x, r):
        return Domain.disc((x, 0), r)

    with pytest.raises(InputError, match=r"facet \d and facet \d cross or touch near \(1.5625, "):
        disc(0, 2).with_holes(disc(2, np.sqrt(1.75)))  # x = (4 + 4 - 1.75) / 4
    with pytest.raises(InputError, match=r"facet 0 and facet 4 cross or touch near \(0\.6, 0\.8"):
        disc(0, 1).with_holes(Domain.disc((0.42, 0.56), 0.3))  # tangent from inside at (0.6, 0.8)
    assert abs(disc(0, 1).with_holes(disc(0.7, 0.2999999)).area - math.pi * (1 - 0.2999999**2)) < 1e-12

    def eight(t):
        return np.column_stack([np.sin(t), np.sin(2 * t)])

    with pytest.raises(InputError, match=r"facet 0 meets itself near|cross or touch near"):
        ring([Curve(eight, 0.5, 4.0), Curve(eight, 4.0, 0.5 + 2 * np.pi)], eight(np.array([0.5, 4.0])))


def test_a_corner_within_a_curve_is_refused() -> None:
    corner = Curve(lambda t: np.column_stack([t, np.abs(t)]), -1, 2)
    with pytest.raises(InputError, match=r"facet 0 turns without end near \(.*put a vertex there"):
        Domain([[-1, 1], [2, 2]], [[0, 1], [1, 0]], curves={0: corner})


def test_area_and_inside_of_curved_regions() -> None:
    disc = Domain.disc((3, -2), 0.7)
    assert abs(disc.area - math.pi * 0.49) < 4e-16
    angle = np.linspace(0, 2 * np.pi, 37)
    for factor, inside in ((1 - 1e-12, True), (1 + 1e-12, False)):
        x = [3, -2] + 0.7 * factor * np.column_stack([np.cos(angle), np.sin(angle)])
        assert (disc.contains(x) == inside).all()
    amplitude, k = 0.3, 5

    def wavy(t):
        r = 1 + amplitude * np.cos(k * t)
        return np.column_stack([r * np.cos(t), r * np.sin(t)])

    cuts = np.linspace(0, 2 * np.pi, 4)
    region = ring([Curve(wavy, *cuts[i : i + 2]) for i in range(3)], wavy(cuts[:-1]))
    assert abs(region.area - math.pi * (1 + amplitude**2 / 2)) < 1e-13
    rng = np.random.default_rng(3)
    t, share = rng.uniform(0, 2 * np.pi, 2000), rng.uniform(0, 1.4, 2000)
    assert np.array_equal(region.contains(wavy(t) * share[:, None]), share < 1)
    arcs = [Arc.through((0, 0), (0.5, y), (1, 0)) for y in (0.5, 0.3)]
    crescent = Domain([[0, 0], [1, 0]], [[0, 1], [0, 1]], curves=dict(enumerate(arcs)))
    assert crescent.contains([[0.5, 0.4]])[0] and not crescent.contains([[0.5, 0.2], [0.5, -0.2]]).any()


def test_chords_are_no_longer_than_is_safe() -> None:
    """A small hole between a chord and its arc would leave the region: the arc is cut until it does not."""
    angle = 0.62
    tip = 0.995 * np.array([[np.cos(a), np.sin(a)] for a in (angle, angle + 0.004, angle + 0.002)])
    tip[2] *= 0.997
    facets = [[0, 1], [1, 0], [2, 3], [3, 4], [4, 2]]
    domain = Domain([[-1, 0], [1, 0], *tip], facets, curves={1: Arc((0, 0), 1, 0, math.pi)})
    for sampled in (domain.sampled(), domain.sampled(0.5)):
        polygon = Domain(sampled.points, sampled.ends)
        assert polygon.contains([0.99 * np.cos(angle), 0.99 * np.sin(angle)])
        assert not polygon.contains(tip.mean(axis=0))
    assert len(domain.sampled().ends) < 20  # and only there
    seed = Domain.disc(regions={"rim": 0.999 * np.array([np.cos(0.3), np.sin(0.3)])})
    chords = Domain(seed.sampled().points, seed.sampled().ends)
    assert chords.contains(seed.regions["rim"])[0]


def test_a_coarse_chord_turns_by_sixty_degrees_at_most() -> None:
    for domain in (Domain.disc(), Domain.naca("2412"), Domain.smooth([[0, 0], [3, 0], [3, 1], [0, 2]])):
        sampled = domain.sampled()
        for piece, span in zip(sampled.piece, sampled.span):
            x = domain.at(int(piece), np.linspace(*span, 65))
            d = np.diff(x, axis=0)
            turn = np.abs(np.angle((d[1:, 0] + 1j * d[1:, 1]) / (d[:-1, 0] + 1j * d[:-1, 1]))).sum()
            assert turn < np.radians(61)


def test_kernels_get_arcs_as_arrays() -> None:
    frame = Domain.polygon([[-99, -99], [99, -99], [99, 99], [-99, 99]])
    domain = frame.with_holes(
        random_region(np.random.default_rng(0), "curves"), Domain.polygon([[9, 9], [10, 9], [9, 10]])
    )
    cuts = domain.cuts()
    assert cuts.kind.shape == (len(domain.pieces),) and cuts.arc.shape == (len(domain.pieces), 5)
    for i, kind in enumerate(cuts.kind):
        curve = domain.curves.get(i)
        assert kind == (0 if curve is None else 1 if isinstance(curve, Arc) else 2)
        if kind == 1:
            x, y, r, start, sweep = cuts.arc[i]
            point = [x + r * np.cos(start + 0.3 * sweep), y + r * np.sin(start + 0.3 * sweep)]
            assert np.allclose(domain.at(i, 0.3)[0], point, rtol=0, atol=1e-15)


def test_points_by_parameter() -> None:
    domain = Domain.disc((1, 1), 2.0)
    assert np.array_equal(domain.at(0, [0.0, 1.0]), domain.points[domain.pieces[0]])
    with pytest.raises(InputError, match=r"piece = 4 must lie in 0\.\.3"):
        domain.at(4, 0.5)
    with pytest.raises(InputError, match=r"t = 1.5 must lie in \[0, 1\]"):
        domain.at(0, [0.5, 1.5])
    straight = Domain.rectangle((0.1, 0.2), (0.7, 0.9))
    assert np.allclose(straight.at(0, [0.25, 0.5, 0.9])[:, 0], [0.25, 0.4, 0.64])


@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_distance_to_pieces(offset: float) -> None:
    def parabola(t):
        return np.column_stack([t, t * t])

    arc = Arc((0, 0), 2.0, 0.5, -4.0)
    shift = [20, 0]
    moved = Curve(lambda t: parabola(t) + shift, -1, 2)
    ends = np.array([0.0, 1.0])
    points = np.concatenate([[[5, 5], [8, 9]], arc.point(ends), moved.point(ends)])
    domain = Domain(points, [], inner=[[0, 1], [2, 3], [4, 5]], curves={1: arc, 2: moved})
    t = np.array([0.1, 0.4, 0.77])
    for piece in range(3):
        x = domain.at(piece, t)
        near = domain.at(piece, t + 1e-7) - domain.at(piece, t - 1e-7)
        normal = np.column_stack([-near[:, 1], near[:, 0]]) / np.hypot(*near.T)[:, None]
        away, found = distance_to_piece(domain, piece, x + 0.3 * offset * normal)
        assert np.allclose(found, t, atol=1e-7) and np.allclose(away, 0.3 * offset, atol=1e-14)
