"""Segments and inside in one kernel call: the same arrays as step by step, and every special case refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from regions import KINDS
from segments import noncrossing

from unstruct import InputError
from unstruct.connect.planar.bounded import bound_at_once
from unstruct.connect.planar.complex import PlanarComplex
from unstruct.connect.planar.flood import mark_regions
from unstruct.connect.planar.inserting import insert_all


def both(points, ends, facets, regions, hull, piece=None):
    """The complex made in one call, or None; and that made step by step."""
    piece = np.arange(len(ends), dtype=np.int32) if piece is None else piece
    subsegments = ends, piece, np.tile([0.0, 1.0], (len(ends), 1))
    one, two = PlanarComplex(points), PlanarComplex(points)
    done = bound_at_once(one, subsegments, facets, regions, hull)
    insert_all(two, *subsegments, facets=facets)
    mark_regions(two, facets, regions, hull)
    return one if done else None, two


def agree(one, two):
    for name, a, b in zip(one.plane()._fields, one.plane(), two.plane()):
        np.testing.assert_array_equal(a, b, err_msg=name)
        assert a.dtype == b.dtype and a.flags.writeable
    assert one.regions == two.regions


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("hull", [False, True])
def test_regions_as_step_by_step(kind, hull):
    domain = KINDS[kind](np.random.default_rng(3))
    sampled = domain.sampled()
    agree(*both(sampled.points, sampled.ends, len(domain.facets), {}, hull, sampled.piece))


@given(st.integers(0, 10**6), st.booleans())
@settings(max_examples=60, deadline=None)
def test_segments_as_step_by_step_unless_divided(seed, lattice):
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(0, 5, (20, 2)), axis=0) if lattice else rng.random((20, 2))
    points, n = points.astype(float), len(points)
    pairs = noncrossing(points, [tuple(rng.choice(n, 2, replace=False).tolist()) for _ in range(12)])
    one, two = both(points, np.array(pairs, dtype=np.int32).reshape(-1, 2), 0, {}, True)
    if one is None:
        assert two.segments > len(pairs), "a vertex divides a segment"
    else:
        agree(one, two)


def test_named_parts_as_step_by_step():
    points = np.array([(0, 0), (3, 0), (3, 1), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)], dtype=float)
    ring = [(0, 4), (4, 6), (6, 1), (1, 2), (2, 7), (7, 5), (5, 3), (3, 0), (4, 5), (6, 7)]
    ends = np.array(ring, dtype=np.int32)
    right, middle = np.array([[2.5, 0.5]]), np.array([[1.5, 0.5]])
    for names in ({}, {"b": middle}, {"b": right, "a": middle}):
        one, two = both(points, ends, 8, names, False)
        agree(one, two)
        assert one.parts() == 3 and one.regions == {name: k for k, name in enumerate(names)}


@pytest.mark.parametrize(
    "ends, facets",
    [([(0, 2), (1, 3)], 0), ([(0, 2), (2, 0)], 0), ([(0, 1), (1, 2)], 2), ([(0, 0)], 0), ([], 0)],
)
def test_refused_what_the_steps_report(ends, facets):
    points = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    rows = np.array(ends, dtype=np.int32).reshape(-1, 2)
    subsegments = rows, np.arange(len(rows), dtype=np.int32), np.zeros((len(rows), 2))
    assert not bound_at_once(PlanarComplex(points), subsegments, facets, {}, False)
    with pytest.raises(InputError):
        both(points, rows, facets, {}, False)
