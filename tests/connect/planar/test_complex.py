"""PlanarComplex and the two-phase cavity: insertions and splits at random, judged by `check`."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import DegenerateInputError, Domain, InputError, check
from unstruct.connect.insertion.halfedges import SEGMENTS
from unstruct.connect.planar import extraction
from unstruct.connect.planar.cavity import (
    GHOST,
    blocked_by,
    commit,
    commit_split,
    find_cavity,
    find_split,
    next_edge,
    prev_edge,
    walk,
)
from unstruct.connect.planar.complex import PlanarComplex
from unstruct.generate.boundary.constrained import planar_complex


def square(extra: np.ndarray) -> PlanarComplex:
    """The unit square with its four sides marked, points inside, and the domain as region 0."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    complex_ = PlanarComplex(np.concatenate([corners, extra]))
    complex_.reserve(complex_.size, 4)
    sides = {(k, (k + 1) % 4): k for k in range(4)}
    vertex = complex_.vertex
    for e in range(3 * complex_.triangles):
        pair = (int(vertex[next_edge(e)]), int(vertex[prev_edge(e)]))
        if pair in sides:
            s = sides[pair]
            complex_.mark[e] = complex_.mark[complex_.twin[e]] = s
            complex_.ends[s], complex_.piece[s], complex_.span[s], complex_.where[s] = pair, s, (0, 1), e
            complex_.state[SEGMENTS] += 1
    slots = vertex[: 3 * complex_.triangles].reshape(-1, 3)
    complex_.region[: complex_.triangles][(slots >= 0).all(axis=1)] = 0
    return complex_


def insert(c: PlanarComplex, x: np.ndarray, seed: int | None = None) -> int:
    """Insert x (scaled) from a seed triangle or from where it lies; what is in the way, -1 for nothing."""
    c.reserve(c.size + 1, c.segments)
    plane, scratch = c.plane(), c.scratch()
    t = walk(c.xy, c.vertex, c.twin, 0, *x) if seed is None else seed
    m, k = find_cavity(plane, scratch, t, *x)
    if k < 0:
        return 0
    blocked = blocked_by(c.xy, c.vertex, scratch.rim, k, *x)
    if blocked < 0:
        assert k == m + 2
        p = c.size
        c.xy[p] = x
        commit(plane, scratch, m, k, p)
        assert (c.vertex[3 * scratch.fresh[:k]] == p).all()
    return int(blocked)


def split(c: PlanarComplex, s: int, x: np.ndarray, t: float) -> int:
    """Split subsegment s at x (scaled), parameter t; what is in the way, -1 for nothing."""
    c.reserve(c.size + 1, c.segments + 1)
    plane, scratch = c.plane(), c.scratch()
    e = c.where[s]
    before = c.mark.copy()
    m, k, h = find_split(plane, scratch, e, *x)
    np.testing.assert_array_equal(c.mark, before)
    if k < 0:
        return 0
    blocked = blocked_by(c.xy, c.vertex, scratch.rim, k, *x)
    if blocked < 0:
        p = c.size
        c.xy[p] = x
        new = commit_split(plane, scratch, e, m, k, h, p, t)
        assert new == c.segments - 1
    return int(blocked)


def sound(c: PlanarComplex) -> None:
    """Twins, marks, subsegments and ghosts fit together."""
    edges = np.arange(3 * c.triangles)
    twin = c.twin[edges]
    np.testing.assert_array_equal(c.twin[twin], edges)
    np.testing.assert_array_equal(c.mark[edges], c.mark[twin])
    start = np.array([c.vertex[next_edge(e)] for e in edges])
    end = np.array([c.vertex[prev_edge(e)] for e in edges])
    np.testing.assert_array_equal(start, end[twin])
    for s in range(c.segments):
        e = c.where[s]
        assert c.mark[e] == s
        assert {start[e], end[e]} == set(c.ends[s])
    assert (c.mark[edges] >= 0).sum() == 2 * c.segments
    ghosts = (c.vertex[: 3 * c.triangles].reshape(-1, 3) == GHOST).any(axis=1)
    assert (c.region[: c.triangles][ghosts] == -1).all()


def well(c: PlanarComplex) -> None:
    sound(c)
    report = check(c.mesh(facets=4), delaunay="constrained")
    assert report, str(report)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.booleans())
def test_insertions_and_splits(seed: int, coarse: bool) -> None:
    rng = np.random.default_rng(seed)
    draw = (lambda n: rng.integers(1, 8, (n, 2)) / 8) if coarse else (lambda n: rng.random((n, 2)))
    c = square(np.unique(draw(3), axis=0))
    done = 0
    for _ in range(25):
        if rng.random() < 0.5:
            x = draw(1)[0] * c.factor
            if not (c.xy[: c.size] == x).all(axis=1).any():
                done += insert(c, x) < 0
        else:
            s = int(rng.integers(c.segments))
            a, b = c.xy[c.ends[s]]
            t = 0.5 if coarse else rng.uniform(0.2, 0.8)
            done += split(c, s, a + t * (b - a), c.span[s] @ (1 - t, t)) < 0
    assert done > 10
    well(c)
    assert c.mesh(facets=4).volume == pytest.approx(1.0)


def test_a_hidden_point_is_refused_and_nothing_changes() -> None:
    c = square(np.array([[0.5, 0.4]]))
    arrays = [a.copy() for a in (c.vertex, c.twin, c.mark, c.region)]
    outside = np.array([0.5, -0.05]) * c.factor  # below the bottom side, in the circle of the triangle on it
    (t,) = [int(c.where[0] // 3) if c.region[c.where[0] // 3] == 0 else int(c.twin[c.where[0]] // 3)]
    assert insert(c, outside, t) >= 0
    for array, old in zip((c.vertex, c.twin, c.mark, c.region), arrays):
        np.testing.assert_array_equal(array[: len(old)], old)


def test_a_boundary_edge_follows_a_curve() -> None:
    """Halves outside the chord enlarge the region, halves inside it cut from it."""
    for depth, area in ((-0.25, 1.125), (0.25, 0.875)):
        c = square(np.array([[0.5, 0.75]]))
        assert split(c, 0, np.array([0.5, depth]) * c.factor, 0.5) < 0
        well(c)
        mesh = c.mesh(facets=4)
        assert mesh.volume == area
        np.testing.assert_array_equal(np.sort(mesh.span[mesh.piece == 0], axis=0), [[0.0, 0.5], [0.5, 1.0]])


def test_a_split_that_would_touch_is_refused() -> None:
    c = square(np.array([[0.5, 0.25]]))
    assert split(c, 0, np.array([0.5, 0.5]) * c.factor, 0.5) >= 0  # beyond the vertex inside
    assert split(c, 0, np.array([0.5, 0.25]) * c.factor, 0.5) >= 0  # onto it
    well(c)


def test_there_is_a_slot_for_every_triangle_that_the_rows_admit() -> None:
    """Rows grew by half, slots by what was asked for: refinement wrote beyond the last one."""
    c = square(np.random.default_rng(0).random((100, 2)))
    for vertices in (105, 160, 161, 300, 301, 5000):
        c.reserve(vertices, 4)
        slots = 2 * len(c.xy) - 2
        assert len(c.xy) >= vertices and len(c.region) >= slots
        assert min(len(c.vertex), len(c.twin), len(c.mark)) >= 3 * slots
    well(c)


def test_bad_points() -> None:
    with pytest.raises(InputError, match="points 0 and 2 are equal"):
        PlanarComplex([[0, 0], [1, 0], [0, 0], [0, 1]])
    with pytest.raises(DegenerateInputError):
        PlanarComplex([[0, 0], [1, 1], [2, 2]])
    with pytest.raises(InputError, match="exponents"):
        PlanarComplex([[0, 0], [1e300, 0], [0, 1e300], [5e-324, 1e-320]])
    with pytest.raises(InputError, match="2"):
        PlanarComplex([[0, 0, 0], [1, 0, 0]])


def test_many_markers_are_those_of_few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sets that overlap, are empty, or name pieces outside: the same edges in the same order."""
    square = Domain.rectangle()
    markers = {f"m{k}": [k % 4, (k * k + 1) % 4, k % 4] for k in range(20)}
    domain = Domain(square.points, square.facets, markers=markers)
    c = planar_complex(domain, 0.3)
    sets = {**domain.markers, "none": np.empty(0, dtype=int), "two": [1, 7, 3]}
    many = c.mesh(facets=4, markers=sets).markers
    monkeypatch.setattr(extraction, "FEW_MARKERS", 100)
    few = c.mesh(facets=4, markers=sets).markers
    assert list(many) == list(few) and all(np.array_equal(many[name], few[name]) for name in few)
    assert all(many[name].dtype == few[name].dtype and len(many["two"]) > 0 for name in few)
