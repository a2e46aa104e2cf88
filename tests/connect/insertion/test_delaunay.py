"""``delaunay``: against brute force, against SciPy on generic input, and against itself."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from oracles import brute_force, complex_of, grid_points

from unstruct import DegenerateInputError, InputError, check, delaunay, topology
from unstruct.connect.insertion.engine import COUNT, LAST, REACHED, STAMP
from unstruct.connect.insertion.general import General, independent_rows, normal
from unstruct.connect.insertion.space import Spatial, cavity3
from unstruct.connect.insertion.stars import MOST_WALLS, Space, small_star3, star3
from unstruct.connect.insertion.triangulation import Triangulation
from unstruct.predicates.batch import in_sphere, orient


def cells_of(simplices):
    return set(map(tuple, np.sort(simplices, axis=1).tolist()))


def through_general(points):
    """The same points through the integer engine, in input order."""
    integers = [[int(x) for x in row] for row in points]
    first = independent_rows(integers, points.shape[1])
    order = np.r_[first, np.delete(np.arange(len(points)), first)]
    engine = General(points[order][: len(first)])
    engine.add(points[order][len(first) :])
    while engine.done < engine.size:
        engine.advance()
    simplices, neighbors, _ = engine.cells(order.astype(np.int32))
    return simplices, neighbors, order, engine.copy_of


@settings(max_examples=120, deadline=None)
@given(grid_points())
@example(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1.0]]))
def test_integer_points(points):
    """Ties, flat quadruples, points on edges and facets and hull, copies: everything at once."""
    try:
        mesh = delaunay(points)
    except DegenerateInputError as error:
        assert len(independent_rows(points.astype(int).tolist(), points.shape[1])) == error.dimension + 1
        return
    brute_force(mesh)


@settings(max_examples=60, deadline=None)
@given(grid_points(side=3, most=12))
def test_the_general_path_gives_the_same_complex(points):
    assume(len(independent_rows(points.astype(int).tolist(), points.shape[1])) == points.shape[1] + 1)
    simplices, neighbors, _, _ = through_general(points)
    assert (np.asarray(orient(points[simplices])) > 0).all()
    assert np.array_equal(neighbors, topology.neighbors(simplices))
    assert complex_of(points, points[simplices]) == complex_of(points, points[delaunay(points).simplices])


@settings(max_examples=25, deadline=None)
@given(grid_points(dimensions=(1, 4, 5), side=3, most=10))
def test_one_four_and_five_dimensions(points):
    try:
        mesh = delaunay(points)
    except (DegenerateInputError, InputError):
        assume(False)
    brute_force(mesh)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([2, 3]),
    st.lists(st.tuples(*[st.integers(-3, 3)] * 4), min_size=6, max_size=12),
    st.sampled_from([0.5, 1.0, 1e8, 2.0**-900]),
)
def test_neighbors_in_the_last_bits(d, steps, base):
    """Points a few units in the last place apart, beside a few far ones."""
    near = base + np.spacing(base) * np.array(steps, dtype=float)[:, :d]
    points = np.vstack([near, base * (1.0 + np.eye(d)), base * np.full((1, d), -2.0)])
    brute_force(delaunay(points))


@settings(max_examples=40, deadline=None)
@given(st.sampled_from([2, 3]), st.data())
def test_wide_exponents(d, data):
    """Coordinates from 2**-1074 to 2**1023: beyond what one scale serves, the integer engine takes over."""
    reach = data.draw(st.sampled_from([30, 400, 1000]))
    value = st.builds(lambda m, e: float(np.ldexp(m, e)), st.integers(-3, 3), st.integers(-reach, reach))
    rows = data.draw(st.lists(st.tuples(*[value] * d), min_size=d + 2, max_size=9))
    try:
        mesh = delaunay(np.array(rows, dtype=float))
    except DegenerateInputError:
        assume(False)
    brute_force(mesh)


def test_scale_that_would_lose_bits_takes_the_integer_engine():
    points = np.array([[0, 0], [1e300, 0], [0, 1e300], [1e-300, 1e-300], [1e-300, 2e-300], [5e-324, 0]])
    t = Triangulation(points)
    assert isinstance(t._engine, General)
    brute_force(t.mesh())
    assert not isinstance(Triangulation(points[:3] * 1e-300)._engine, General)


@pytest.mark.parametrize(("d", "n"), [(1, 300), (2, 3000), (3, 800), (4, 120), (5, 40)])
def test_generic_points_as_scipy(d, n):
    points = np.random.default_rng(d).standard_normal((n, d))
    mesh = delaunay(points)
    if d == 1:
        order = np.argsort(points[:, 0])
        assert cells_of(mesh.simplices) == cells_of(np.stack([order[:-1], order[1:]], axis=1))
    else:
        from scipy.spatial import Delaunay

        assert cells_of(mesh.simplices) == cells_of(Delaunay(points).simplices)


@pytest.mark.parametrize(("d", "n"), [(2, 100_000), (3, 15_000)])
@pytest.mark.parametrize("kind", ["uniform", "lattice", "sphere", "clustered"])
def test_large(d, n, kind):
    rng = np.random.default_rng(4)
    points = rng.random((n, d))
    if kind == "lattice":
        side = round(n ** (1 / d))
        points = np.stack(np.meshgrid(*[np.arange(side)] * d), axis=-1).reshape(-1, d) * 0.1
    if kind == "sphere":
        points = rng.standard_normal((n // 4, d))
        points /= np.linalg.norm(points, axis=1)[:, None]
    if kind == "clustered":
        points = rng.random((20, d))[rng.integers(0, 20, n)] + 1e-3 * rng.standard_normal((n, d))
    mesh = delaunay(points)
    report = check(mesh, delaunay=True)
    assert report, str(report)
    assert len(mesh.duplicates) == 0


def test_offset_of_a_hundred_million():
    for d, side in ((2, 40), (3, 9)):
        lattice = np.stack(np.meshgrid(*[np.arange(side)] * d), axis=-1).reshape(-1, d)
        mesh = delaunay(1e8 + 1e-6 * lattice)
        assert check(mesh, delaunay=True)
        assert len(mesh.duplicates) == 0


def test_hundreds_of_points_in_four_dimensions():
    points = np.random.default_rng(0).random((400, 4))
    mesh = delaunay(points)
    assert len(mesh.simplices) > 4_000
    rows = np.random.default_rng(1).choice(len(mesh.simplices), 50, replace=False)
    for t in rows:
        assert (np.asarray(in_sphere(points[mesh.simplices[t]], points)) <= 0).all()


def test_the_least_copy_is_kept():
    rng = np.random.default_rng(6)
    points = rng.integers(0, 12, (600, 2)).astype(float)
    mesh = delaunay(points)
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    kept = first[inverse.ravel()]
    copies = np.flatnonzero(kept != np.arange(600))
    assert np.array_equal(mesh.duplicates, np.stack([copies, kept[copies]], axis=1))
    brute_force(delaunay(points[:150]))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_the_first_bad_row_is_named(value):
    points = np.random.default_rng(0).random((9, 3))
    points[4, 1] = points[7, 0] = value
    with pytest.raises(InputError, match=r"points\[4\]"):
        delaunay(points)


def test_normal_is_orthogonal():
    rng = np.random.default_rng(0)
    for k in range(1, 7):
        rows = rng.integers(-9, 10, (k, k + 1)).tolist()
        n = normal(rows)
        assert any(n) and all(sum(a * b for a, b in zip(row, n)) == 0 for row in rows)


INTERRUPTED = """
import signal, sys
import numpy as np
from unstruct.connect.insertion.triangulation import Triangulation
from unstruct import check
n, d, line = map(int, sys.argv[1:])
points = np.random.default_rng(0).random((n, d))
signal.signal(signal.SIGINT, signal.default_int_handler)  # who starts the tests may have turned it off
t = Triangulation(points[:100])
kind, steps, left = type(t._engine), [], [line]
advance = kind.advance
def counted(engine):
    before = engine.done
    advance(engine)
    steps.append(engine.done - before)
    if len(steps) == 2:
        signal.raise_signal(signal.SIGINT)
def trace(frame, event, argument):
    left[0] -= 1
    if left[0] == 0:
        sys.settrace(None)
        signal.raise_signal(signal.SIGINT)
    return trace
if line:
    sys.settrace(trace)
else:
    kind.advance = counted
try:
    t.insert(points[100:])
    print("not interrupted")
except KeyboardInterrupt:
    kind.advance = advance
    print(100 < t._engine.done < n, bool(line) or len(steps) == 2 and max(steps) <= kind.chunk)
    t.insert(points[:1] + 2.0)  # goes on with what was left
    mesh = t.mesh()
    print(len(np.unique(mesh.simplices)) == n + 1, bool(check(mesh, delaunay=True)))
"""


@pytest.mark.parametrize(
    ("n", "d", "line"),
    [(300_000, 2, 0), (25_000, 3, 0), (300, 2, 50_000), (300, 2, 50_077), (250, 3, 90_000), (250, 3, 90_077)],
)
def test_an_interrupt_is_heard_and_harmless(n, d, line):
    """Compiled, between two calls, after a bounded number of points; in plain Python, after any line."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"} if line else dict(os.environ)
    arguments = [sys.executable, "-c", INTERRUPTED, str(n), str(d), str(line)]
    run = subprocess.run(arguments, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["True"] * 4, run.stdout


def test_both_ways_to_make_a_star_agree():
    """Edges of walls in a table, or found by turning through the cavity: the same arrays."""
    rows = np.random.default_rng(5).random((300, 3)) * 0.9
    engine = Spatial(rows[:4])
    for p in range(4, 300):
        engine.add(rows[p : p + 1])
        x, stamp = tuple(rows[p]), int(engine.state[STAMP])
        engine.state[STAMP] += 1
        (t,) = engine.locate_all(rows[p : p + 1])
        found = engine._cavity()
        assert cavity3(engine._space(), found, engine.batch, int(t), x, stamp)
        assert found.sizes[1] <= MOST_WALLS
        turned = Space(*(array.copy() for array in engine._space()))
        last = star3(turned, found, p, stamp)
        assert small_star3(engine._space(), found, engine.ridges, p) == last
        used = 4 * int(engine.state[COUNT])
        assert np.array_equal(turned.state, engine.state)
        assert np.array_equal(turned.vertex[:used], engine.vertex[:used])
        alive = np.repeat(turned.vertex[:used:4] != -2, 4)
        assert np.array_equal(turned.across[:used][alive], engine.across[:used][alive])
        engine.state[LAST], engine.state[REACHED] = last, p + 1


def test_large_stars():
    """A point amid a sphere of others: its cavity has more walls than the table has room for."""
    x = np.random.default_rng(6).standard_normal((400, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    grown = Triangulation(x)
    grown.insert([0.0, 0.0, 0.0])
    mesh = grown.mesh()
    assert (mesh.simplices == 400).any(axis=1).sum() > MOST_WALLS
    assert check(mesh, delaunay=True)
