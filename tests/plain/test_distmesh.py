"""DistMesh: forces by hand, exact Delaunay triangles, regions covered, and what it does not promise."""

from fractions import Fraction
from itertools import pairwise
from math import dist, inf, pi, sqrt
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plane_delaunay import turn

import unstruct
from unstruct.base.errors import InputError
from unstruct.plain.distmesh import (
    FAR,
    PUSH,
    STILL,
    Region,
    bars_of,
    circle,
    difference,
    distmesh,
    forces,
    lattice,
    moves,
    polygon,
    put_back,
    triangulated,
)
from unstruct.plain.divide_and_conquer import divide_and_conquer
from unstruct.plain.point_choices import aspect
from unstruct.plain.triangulations import is_delaunay

BOX = ((-1.0, -1.0), (1.0, 1.0))
U = [(0, 0), (4, 0), (4, 3), (2.5, 3), (2.5, 1.5), (1.5, 1.5), (1.5, 3), (0, 3)]
SIDES = [(k, (k + 1) % 8) for k in range(8)]
RUNS = {
    "disk": ((circle((0, 0), 1), lambda p: 1.0, 0.3, BOX), pi),
    "ring": ((difference(circle((0, 0), 1), circle((0, 0), 0.4)), lambda p: 1.0, 0.25, BOX), 0.84 * pi),
    "graded": ((circle((0, 0), 1), lambda p: 0.2 + dist(p, (0, 0)), 0.12, BOX), pi),
    "u": ((polygon(U, SIDES), lambda p: 1.0, 0.5, ((0, 0), (4, 3)), U), 10.5),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run(name):
    arguments, area = RUNS[name]
    steps = list(distmesh(*arguments))
    last, spacing = steps[-1], arguments[2]
    assert last.settled and last.fresh and last.largest < STILL and steps[0].fresh
    assert not any(step.settled for step in steps[:-1])
    assert all(step.bars == bars_of(step.triangles) for step in steps)
    exact = [tuple(map(Fraction, p)) for p in last.points]
    assert is_delaunay(exact, last.triangles)
    assert unstruct.check(unstruct.Mesh(np.array(last.points), last.triangles))
    covered = float(sum(turn(*(exact[v] for v in t)) for t in last.triangles)) / 2
    assert 0.9 * area < covered < 1.001 * area  # chords are inside of a disk
    assert max(aspect([last.points[v] for v in t]) for t in last.triangles) < 1.5
    assert max(arguments[0](p) for p in last.points) < 1e-6 * spacing
    if name == "u":
        assert list(last.points[:8]) == U and covered == pytest.approx(area, rel=1e-3)


def test_a_graded_size_is_followed():
    *_, last = distmesh(*RUNS["graded"][0])
    near, far = [], []
    for u, v in last.bars:
        a, b = last.points[u], last.points[v]
        r = dist(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), (0, 0))
        (near if r < 0.4 else far if r > 0.8 else []).append(dist(a, b))
    assert np.mean(far) > 1.8 * np.mean(near)


def test_another_method_for_the_triangles():
    def fast(points):
        return [tuple(t) for t in unstruct.delaunay(points).simplices.tolist()]

    ours, theirs = (list(distmesh(*RUNS["disk"][0], delaunay=f)) for f in (divide_and_conquer, fast))
    assert ours[-1].settled and theirs[-1].settled
    assert abs(len(ours[-1].triangles) - len(theirs[-1].triangles)) <= 2  # first ties may be cut otherwise


def test_a_limit_is_kept_and_told():
    steps = list(distmesh(*RUNS["ring"][0], limit=3))
    assert len(steps) == 3 and not steps[-1].settled and steps[-1].fresh
    assert is_delaunay([tuple(map(Fraction, p)) for p in steps[-1].points], steps[-1].triangles)


def test_a_new_triangulation_when_a_point_has_moved_far():
    steps = list(distmesh(*RUNS["u"][0]))
    at = None
    for before, step in pairwise(steps[:-1]):
        if at is not None:
            assert step.fresh == (max(map(dist, at, before.points)) > FAR * 0.5)
        if step.fresh:
            at = before.points
        else:
            assert step.triangles == before.triangles
    assert at is not None and not any(step.merged for step in steps)


def test_forces_by_hand():
    """A long bar and a short one: scale = PUSH sqrt(10 / 2); only the short one pushes, with scale - 1."""
    points = [(0.0, 0.0), (3.0, 0.0), (0.0, 1.0)]
    push = PUSH * sqrt(10 / 2) - 1
    found = forces(points, [(0, 1), (0, 2)], lambda p: 1.0)
    assert np.allclose(found, [(0, -push), (0, 0), (0, push)])


@given(st.lists(st.tuples(*[st.integers(-9, 9)] * 2), min_size=3, max_size=9, unique=True))
@settings(max_examples=50, deadline=None)
def test_forces_cancel_and_never_pull(points):
    bars = [(u, v) for v in range(len(points)) for u in range(v)]
    found = forces(points, bars, lambda p: 1 + abs(p[0]))
    assert np.allclose(np.sum(found, axis=0), 0, atol=1e-9)
    torque = sum(x * fy - y * fx for (x, y), (fx, fy) in zip(points, found, strict=True))
    assert abs(torque) < 1e-8
    assert sum(x * fx + y * fy for (x, y), (fx, fy) in zip(points, found, strict=True)) >= -1e-9  # outward


def test_points_are_put_back_and_fixed_ones_stay():
    region = Region(circle((0, 0), 1), lambda p: 1.0, 0.5, 1, divide_and_conquer)
    assert dist(put_back(region, (1.2, 0.9)), (0.8, 0.6)) < 1e-6
    have, out, largest = moves(region, [(0.9, 0.0), (0.0, 0.9), (0.1, 0.0)], [(5, 0), (0, 5), (0.25, 0)])
    assert have[0] == (0.9, 0.0) and out == {1} and dist(have[1], (0, 1)) < 1e-6
    assert have[2] == pytest.approx((0.15, 0)) and largest == pytest.approx(0.1)  # the one on the rim aside


def test_copies_are_made_one():
    region = Region(circle((0, 0), 2), lambda p: 1.0, 0.5, 0, divide_and_conquer)
    points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.0)]
    assert triangulated(region, points) == (points[:3], 1, ((0, 1, 2),))


def test_the_lattice():
    region = Region(circle((0, 0), 1), lambda p: 1.0, 0.2, 0, divide_and_conquer)
    points = lattice(region, BOX, Random(0))
    near = [min(dist(p, q) for q in points if q != p) for p in points]
    assert np.allclose(near, 0.2) and abs(len(points) * 0.04 * sqrt(3) / 2 - pi) < 0.3
    graded = Region(circle((0, 0), 1), lambda p: 1.0 if p[0] < 0 else 2.0, 0.05, 0, divide_and_conquer)
    found = lattice(graded, BOX, Random(0))
    left = sum(p[0] < 0 for p in found)
    assert 0.15 < (len(found) - left) / left < 0.35  # a quarter


@given(st.tuples(st.floats(-1, 5), st.floats(-1, 4)))
@settings(max_examples=100, deadline=None)
def test_the_distance_of_a_polygon(p):
    brute = min(
        dist(p, (a[0] + (b[0] - a[0]) * k / 500, a[1] + (b[1] - a[1]) * k / 500))
        for a, b in zip(U, [*U[1:], U[0]], strict=True)
        for k in range(501)
    )
    x, y = p
    inside = 0 < x < 4 and 0 < y < 3 and not (1.5 <= x <= 2.5 and y >= 1.5)
    assert abs(abs(polygon(U, SIDES)(p)) - brute) < 0.005
    if brute > 0.01:
        assert (polygon(U, SIDES)(p) < 0) == inside


def test_wrong_arguments():
    disk = circle((0, 0), 1)
    for arguments, options in (
        ((disk, lambda p: 1.0, 0, BOX), {}),
        ((disk, lambda p: 1.0, inf, BOX), {}),
        ((disk, lambda p: -1.0, 0.3, BOX), {}),
        ((disk, lambda p: 1.0, 0.3, BOX), {"limit": 0}),
        ((disk, lambda p: 1.0, 0.3, ((5, 5), (6, 6))), {}),
    ):
        with pytest.raises(InputError):
            list(distmesh(*arguments, **options))
