"""Four choices of points: constrained Delaunay by definition at every step, lengths reached, reasons true."""

from fractions import Fraction
from math import cos, dist, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plane_delaunay import turn

import unstruct
from unstruct.base.errors import InputError
from unstruct.plain.constrained import is_constrained_delaunay
from unstruct.plain.point_choices import (
    SPARE,
    anderson,
    aspect,
    baker,
    circumcenter,
    curvatures,
    cut,
    hamann,
    holmes_snyder,
    point_choices,
)
from unstruct.plain.rebay import circumradius, start


def loop(n, first=0):
    return [(first + k, first + (k + 1) % n) for k in range(n)]


U = [(0, 0), (4, 0), (4, 3), (2.5, 3), (2.5, 1.5), (1.5, 1.5), (1.5, 3), (0, 3)]
FRAME = [(0, 0), (3, 0), (3, 3), (0, 3), (1, 1), (2, 1), (2, 2), (1, 2)]
DISK = [(2 * cos(k * pi / 12), 2 * sin(k * pi / 12)) for k in range(24)]
REGIONS = {
    "u": cut(U, loop(8), 0.5),
    "frame": cut(FRAME, loop(4) + loop(4, 4), 0.5),
    "disk": (DISK, loop(24)),
    "coarse triangle": ([(0, 0), (3, 0), (1.2, 2.5)], loop(3)),
}
CHOICES = {
    "holmes_snyder": lambda points, segments: holmes_snyder(0.5),
    "hamann": lambda points, segments: hamann(points, segments, 0.9),
    "anderson": lambda points, segments: anderson(points, segments, 0.45),
    "baker": lambda points, segments: baker(0.5),
}


def assert_meshed(step, points, segments):
    """The library's own check of the mesh against the region."""
    origin = np.r_[np.arange(len(points)), np.full(len(step.points) - len(points), -1)]
    mesh = unstruct.Mesh(
        np.array(step.points), sorted(step.cells), origin=origin, markers={"facets": np.array(segments)}
    )
    assert unstruct.check(mesh, domain=unstruct.Domain(points, segments), delaunay="constrained")


@pytest.mark.parametrize("region", REGIONS)
@pytest.mark.parametrize("name", CHOICES)
def test_a_run(name, region):
    points, segments = REGIONS[region]
    choice = CHOICES[name](points, segments)
    steps = list(point_choices(points, segments, choice))
    last = steps[-1]
    assert_meshed(last, points, segments)
    aside = {s.worst: s for s in steps if s.refusal}
    for cell in last.cells:  # good, or set aside for a reason that is true
        corners = [last.points[v] for v in cell]
        assert choice.badness(corners) <= 1 or cell in aside
    for step in steps:
        assert step.badness > 1
        if step.refusal == "near":
            nearest = min(dist(step.point, p) for p in step.points)
            assert nearest < SPARE * choice.wanted(step.point)
        elif not step.refusal:
            *before, x = step.points
            assert x == step.point and min(dist(x, p) for p in before) >= SPARE * choice.wanted(x)
    assert len(last.points) > len(points)


@pytest.mark.parametrize("name", CHOICES)
def test_constrained_delaunay_by_definition_at_every_step(name):
    points, segments = cut([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (0, 1)], loop(6), 0.8)
    for step in point_choices(points, segments, CHOICES[name](points, segments)):
        exact = [tuple(map(Fraction, p)) for p in step.points]
        assert is_constrained_delaunay(exact, step.cells, segments)
        assert sum(turn(*(exact[v] for v in t)) for t in step.cells) == 2 * 4


@given(st.lists(st.integers(1, 5), min_size=5, max_size=8), st.sampled_from(sorted(CHOICES)))
@settings(max_examples=20, deadline=None)
def test_star_polygons(radii, name):
    """Any radii in equal directions: sharp spikes, notches, points that hide behind walls."""
    n = len(radii)
    corners = [(r * cos(2 * pi * k / n), r * sin(2 * pi * k / n)) for k, r in enumerate(radii)]
    points, segments = cut(corners, loop(n), 1.5)
    choice = {
        "holmes_snyder": lambda: holmes_snyder(1.5),
        "hamann": lambda: hamann(points, segments, 2.5),
        "anderson": lambda: anderson(points, segments, 1.5),
        "baker": lambda: baker(1.5),
    }[name]()
    steps = list(point_choices(points, segments, choice))
    if steps:
        assert_meshed(steps[-1], points, segments)


def test_lengths_follow_the_choice():
    """Hamann's and Anderson's triangles grow away from the boundary, the others' do not."""
    points, segments = REGIONS["disk"]

    def sides(name):
        *_, last = point_choices(points, segments, CHOICES[name](points, segments))
        corners = [[last.points[v] for v in t] for t in last.cells]
        far = [t for t in corners if max(dist(p, (0, 0)) for p in t) < 1]
        return max(sqrt(3) * circumradius(t, (0, 1, 2)) for t in far)

    assert sides("holmes_snyder") < 0.75 and sides("baker") < 0.68
    assert 0.75 < sides("anderson") <= 1.05 and 0.7 < sides("hamann") <= 0.9


def test_points_behind_a_wall_are_hidden():
    """The circle's center is far below a flat triangle, and on the longest side of one with a right angle."""
    for corner in ((2, 0.5), (0, 4)):
        steps = list(point_choices([(0, 0), (4, 0), corner], loop(3), holmes_snyder(0.5)))
        assert [s.refusal for s in steps] == ["hidden"] and steps[0].cells == {(0, 1, 2)}


def test_points_too_near_are_not_inserted():
    """A spike: the circumcenter of its last triangle is nearer to a vertex than half the wanted length."""
    steps = list(point_choices([(0, 0), (1, 0), (0.5, 0.8)], loop(3), baker(1.2, accept=0.6)))
    assert [s.refusal for s in steps] == ["near"] and steps[0].cells == {(0, 1, 2)}


def test_measures():
    a, b, c = (0, 0), (1, 0), (0.5, sqrt(3) / 2)
    assert aspect([a, b, c]) == pytest.approx(1) and aspect([(0, 0), (3, 0), (0, 4)]) == pytest.approx(5 / 4)
    assert circumcenter([(0, 0), (3, 0), (0, 4)]) == (1.5, 2)
    assert curvatures(DISK, loop(24))[5] == pytest.approx((pi / 12 / (4 * sin(pi / 24)), 4 * sin(pi / 24)))
    have, parts = cut([(0, 0), (1, 0), (0, 1)], loop(3), 0.5)
    assert have[3] == (0.5, 0) and len(parts) == len(have) == 7
    assert all(dist(have[a], have[b]) <= 0.5 for a, b in parts)
    assert start(have, parts)[1] == {frozenset(p) for p in parts}


def test_wrong_arguments():
    square, edges = [(0, 0), (1, 0), (1, 1), (0, 1)], loop(4)
    for call in (
        lambda: holmes_snyder(0),
        lambda: holmes_snyder(1, most=1),
        lambda: hamann(square, edges, float("inf")),
        lambda: hamann(square, edges[:3], 1),
        lambda: anderson(square, edges, -1),
        lambda: baker(float("nan")),
        lambda: cut(square, edges, 0),
    ):
        with pytest.raises(InputError):
            call()
