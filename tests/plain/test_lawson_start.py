"""Lawson's construction: triangles by the definition, each state a triangulation, flips that never return."""

from itertools import pairwise

import pytest
from fixtures import HARD_2D
from hypothesis import given, settings
from plane_delaunay import assert_delaunay, hull_area2, lattice_sets, ring, turn

import unstruct
from unstruct.base.errors import DegenerateInputError, InputError
from unstruct.plain.lawson_start import lawson_start, lawson_steps

HARD = {name: p for name, p in HARD_2D.items() if len(p) <= 40 and len(set(map(tuple, p))) == len(p)}


@given(lattice_sets)
@settings(max_examples=150, deadline=None)
def test_delaunay_by_definition(points):
    if hull_area2(points) == 0:
        with pytest.raises(DegenerateInputError) as caught:
            lawson_start(points)
        assert caught.value.dimension == min(len(points) - 1, 1)
        return
    assert_delaunay(points, lawson_start(points))


@pytest.mark.parametrize("name", HARD)
def test_hard_inputs(name):
    points = HARD[name]
    cells = lawson_start(points)
    assert_delaunay(points.tolist(), cells)
    assert len(unstruct.delaunay(points).simplices) == len(cells)


@given(lattice_sets)
@settings(max_examples=100, deadline=None)
def test_every_state(points):
    steps = list(lawson_steps(points))
    known = []
    for step in steps:
        if step.kind != "flip":
            assert not known or points[step.vertex] > points[known[-1]]
            known.append(step.vertex)
        if step.kind == "line":
            assert step.hull == tuple(known) and not step.cells
            continue
        ring_of = [points[v] for v in step.hull]
        assert len(set(step.hull)) == len(step.hull)
        assert all(turn(*three) >= 0 for three in zip(ring_of, ring_of[1:], ring_of[2:], strict=False))
        sides = {(t[k - 1], t[k]) for t in step.cells for k in range(3)}
        assert len(sides) == 3 * len(step.cells)
        assert sides - {(v, u) for u, v in sides} == set(pairwise([*step.hull, step.hull[0]]))
        assert sum(turn(*(points[v] for v in t)) for t in step.cells) == hull_area2(
            [points[v] for v in known]
        )
        assert all(turn(*(points[v] for v in t)) > 0 for t in step.cells)
    gone = [frozenset(step.swapped[0]) for step in steps if step.swapped]
    assert len(gone) == len(set(gone)) <= len(points) * (len(points) - 1) // 2


@given(lattice_sets)
@settings(max_examples=60, deadline=None)
def test_delaunay_after_each_point(points):
    steps = list(lawson_steps(points))
    known = []
    for step, after in pairwise([*steps, None]):
        if step.kind != "flip":
            known.append(step.vertex)
        if step.cells and (after is None or after.kind == "join"):
            number = {v: k for k, v in enumerate(known)}
            assert_delaunay([points[v] for v in known], [[number[v] for v in t] for t in step.cells])


def test_a_line_is_seen_from_both_sides():
    """Its back is part of the hull with all points on it: a later point sees every piece."""
    points = [(0, 0), (1, 0), (2, 0), (3, 1), (4, -9)]
    steps = list(lawson_steps(points))
    assert steps[3].seen == ((2, 1), (1, 0)) and steps[3].hull == (3, 0, 1, 2)
    assert steps[4].kind == "join" and steps[4].seen == ((0, 1), (1, 2), (2, 3))
    assert_delaunay(points, steps[-1].cells)
    below = [(0, 0), (1, 0), (2, 0), (3, -1), (4, 9)]
    assert_delaunay(below, lawson_start(below))


def test_rings_and_ties():
    for k in range(3):
        assert len(lawson_start(ring[k:] + ring[:k])) == 10
    assert not any(step.swapped for step in lawson_steps([(0, 0), (0, 1), (1, 0), (1, 1)]))  # ties stay


def test_a_quadratic_number_of_flips():
    """On the falling branch of a parabola each new point takes back the whole fan of the last one."""
    for n in (4, 8, 16, 32):
        steps = lawson_steps([(k - n, (k - n) ** 2) for k in range(n)])
        assert sum(step.swapped is not None for step in steps) == (n - 2) * (n - 3) // 2


@pytest.mark.parametrize("bad", [[], [(0, 0), (0, 0)], [(0, 0, 0)], [(0, float("inf"))], [(0, 1), (2,)]])
def test_bad_input(bad):
    with pytest.raises(InputError):
        lawson_start(bad)


def test_few_points():
    assert [step.hull for step in lawson_steps([(1, 0), (0, 0)])] == [(1,), (1, 0)]
