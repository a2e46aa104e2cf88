"""Regular triangulations: against lower hulls in rational numbers, SciPy's hulls, and the exact validator."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import scipy.spatial
from fixtures import FLAT, HARD_2D, HARD_3D, uniform
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import DegenerateInputError, InputError, Mesh, check, delaunay
from unstruct.connect.insertion import weighted
from unstruct.plain.predicates import orient

heavy = st.integers(-4, 4)
grid1 = st.lists(st.tuples(st.integers(0, 9), heavy), min_size=2, max_size=9)
grid2 = st.lists(st.tuples(*[st.integers(0, 4)] * 2, heavy), min_size=3, max_size=9)
grid3 = st.lists(st.tuples(*[st.integers(0, 2)] * 3, heavy), min_size=4, max_size=10)
grid4 = st.lists(st.tuples(*[st.integers(0, 1)] * 4, heavy), min_size=5, max_size=8)
some = settings(max_examples=100, deadline=None)
few = settings(max_examples=40, deadline=None)


def split(rows):
    rows = np.array(rows, dtype=float)
    return rows[:, :-1], rows[:, -1]


def spans(points):
    return np.linalg.matrix_rank(points - points[0]) == points.shape[1]


def solved(rows, right):
    """The solution of a square linear system in fractions, or None."""
    table = [[*row, b] for row, b in zip(rows, right)]
    for i in range(len(table)):
        k = next((k for k in range(i, len(table)) if table[k][i]), None)
        if k is None:
            return None
        table[i], table[k] = table[k], table[i]
        table[i] = [x / table[i][i] for x in table[i]]
        for k, row in enumerate(table):
            if k != i:
                table[k] = [x - row[i] * y for x, y in zip(row, table[i])]
    return [row[-1] for row in table]


def hidden_by_fractions(points, weights):
    """Points that are convex combinations of others whose lifted combination is no higher (planar, exact)."""
    n, d = points.shape
    place = [[Fraction(x) for x in p] for p in points.tolist()]
    lift = [sum(x * x for x in p) - Fraction(w) for p, w in zip(place, weights.tolist())]
    found = set()
    for q in range(n):
        others = [i for i in range(n) if i != q and (place[i] != place[q] or weights[i] > weights[q])]
        for size in range(1, d + 2):
            for chosen in combinations(others, size):
                if covers(place, lift, q, chosen, d):
                    found.add(q)
    return found


def covers(place, lift, q, chosen, d):
    if len(chosen) == 1:
        return place[chosen[0]] == place[q]
    if len(chosen) == d + 1:
        share = solved(
            [[place[i][k] for i in chosen] for k in range(d)] + [[Fraction(1)] * (d + 1)], [*place[q], 1]
        )
    else:  # on a segment
        (a, b), share = chosen, None
        k = max(range(d), key=lambda k: abs(place[b][k] - place[a][k]))
        if place[a][k] != place[b][k]:
            t = (place[q][k] - place[a][k]) / (place[b][k] - place[a][k])
            if all(x + t * (y - x) == z for x, y, z in zip(place[a], place[b], place[q])):
                share = [1 - t, t]
    if share is None or min(share) < 0:
        return False
    return lift[q] >= sum(s * lift[i] for s, i in zip(share, chosen))


def accounted(mesh):
    """Every point is used, a copy of a heavier or earlier one, or hidden."""
    used = set(mesh.simplices.ravel().tolist())
    copies, hidden = set(mesh.duplicates[:, 0].tolist()), set(mesh.hidden.tolist())
    assert used | copies | hidden == set(range(len(mesh.points)))
    assert len(used) + len(copies) + len(hidden) == len(mesh.points)
    for copy, kept in mesh.duplicates.tolist():
        assert (mesh.points[copy] == mesh.points[kept]).all()
        assert (mesh.weights[kept], -kept) > (mesh.weights[copy], -copy)
    return hidden


@pytest.mark.parametrize("rows", [grid1, grid2, grid3, grid4], ids=["line", "plane", "space", "4D"])
def test_any_grid(rows):
    @(some if rows is grid2 else few)
    @given(rows, st.randoms(use_true_random=False))
    def verify(rows, random):
        points, weights = split(rows)
        if not spans(points):
            with pytest.raises((DegenerateInputError, InputError)):
                delaunay(points, weights=weights)
            return
        mesh = delaunay(points, weights=weights)
        report = check(mesh, delaunay=True, brute=True)
        assert report, report
        hidden = accounted(mesh)
        if points.shape[1] < 3:
            expected = hidden_by_fractions(points, weights)
            assert hidden == expected - set(mesh.duplicates[:, 0].tolist())
        order = list(range(len(points)))
        random.shuffle(order)  # what is hidden does not depend on the order
        other = delaunay(points[order], weights=weights[order])
        assert places(other, other.hidden) == places(mesh, mesh.hidden)
        assert np.array_equal(delaunay(points, weights=weights + 8).simplices, mesh.simplices)

    verify()


def places(mesh, rows):
    return sorted(map(tuple, mesh.points[rows].tolist()))


@few
@given(grid2, grid3)
def test_the_compiled_insertion_agrees_with_integers(plane, space):
    for rows in (plane, space):
        points, weights = split(rows)
        if not spans(points):
            continue
        mesh = delaunay(points, weights=weights)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(weighted, "WEIGHTED", {})
            exact = delaunay(points, weights=weights)
        assert exact.hidden.tolist() == mesh.hidden.tolist()
        assert check(exact, delaunay=True, brute=True)


@pytest.mark.parametrize("name", HARD_2D)
def test_hard_inputs_in_the_plane(name):
    points = HARD_2D[name][:400]
    rng = np.random.default_rng(5)
    unit = np.abs(points - points.mean(axis=0)).max() ** 2
    if not spans((points - points[0]) / max(np.abs(points - points[0]).max(), 1e-300)):
        return
    for weights in (rng.random(len(points)) * unit * 1e-3, rng.integers(0, 3, len(points)) * unit / 64):
        mesh = delaunay(points, weights=weights)
        report = check(mesh, delaunay=True)
        assert report, report
        accounted(mesh)


@pytest.mark.parametrize("name", HARD_3D)
def test_hard_inputs_in_space(name):
    points = HARD_3D[name][:150]
    rng = np.random.default_rng(5)
    if not spans((points - points[0]) / np.abs(points - points[0]).max()):
        return
    unit = np.abs(points - points.mean(axis=0)).max() ** 2
    mesh = delaunay(points, weights=rng.integers(0, 3, len(points)) * unit / 64)
    report = check(mesh, delaunay=True)
    assert report, report
    accounted(mesh)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("spread", [1e-4, 1e-2, 1.0])
def test_lower_hulls_of_scipy(d, spread):
    points = uniform(400, d, seed=3)
    weights = np.random.default_rng(4).random(400) * spread
    mesh = delaunay(points, weights=weights)
    hull = scipy.spatial.ConvexHull(np.column_stack([points, (points**2).sum(axis=1) - weights]))
    lower = hull.simplices[hull.equations[:, d] < -1e-12]
    assert set(map(frozenset, lower.tolist())) == set(map(frozenset, mesh.simplices.tolist()))
    assert sorted(set(range(400)) - set(lower.ravel().tolist())) == mesh.hidden.tolist()


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_equal_weights_give_the_plain_triangulation(d):
    points = np.vstack([uniform(60, d), uniform(60, d)[:5]])
    plain, mesh = delaunay(points), delaunay(points, weights=np.full(65, 7.25))
    assert np.array_equal(mesh.simplices, plain.simplices) and np.array_equal(mesh.neighbors, plain.neighbors)
    assert np.array_equal(mesh.duplicates, plain.duplicates) and len(mesh.hidden) == 0
    assert (mesh.weights == 7.25).all() and plain.weights is None
    assert check(mesh, delaunay=True)


def test_a_light_point_is_hidden_and_a_heavy_one_hides():
    """The exercise of the book: F of seven sites, with weight -30."""
    sites = np.array([(0, 0), (7, 0), (8, 5), (3, 7), (-1, 5), (3, 2), (5, 4)], dtype=float)
    mesh = delaunay(sites, weights=[0, 0, 0, 0, 0, -30, 0])
    assert mesh.hidden.tolist() == [5] and "1 hidden" in repr(mesh)
    mesh = delaunay(sites, weights=[0, 0, 0, 0, 0, 0, 1000])
    assert mesh.hidden.tolist() == [5] and len(mesh.simplices) == 5
    # Exactly in the lifted plane of the corners of a square: its cell is a point, so it is hidden.
    square = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 1)]
    for order in ([0, 1, 2, 3, 4], [4, 0, 1, 2, 3], [0, 4, 1, 3, 2]):
        tied = delaunay(np.array(square)[order], weights=np.array([0, 0, 0, 0, -2.0])[order])
        assert tied.hidden.tolist() == [order.index(4)]
    assert len(delaunay(square, weights=[0, 0, 0, 0, -1.875]).simplices) == 4


def test_copies_of_different_weights():
    points = [(0, 0), (0, 0), (1, 0), (0, 1), (0, 0), (1, 1)]
    mesh = delaunay(points, weights=[0, 3, 0, 0, 3, 0])
    assert mesh.duplicates.tolist() == [[0, 1], [4, 1]]
    middle = delaunay([*points[1:], (0.5, 0.5), (0.5, 0.5)], weights=[0, 0, 0, 0, 0, -9, -8])
    assert middle.hidden.tolist() == [6] and middle.duplicates.tolist() == [[3, 0], [5, 6]]
    assert check(middle, delaunay=True, brute=True)


def test_wide_exponents_take_integers():
    points = np.array([[0.0, 0], [1e300, 0], [0, 1e-300], [1e200, 1e100], [1, 1]])
    for weights in ([0, 1e-320, 0, 1e308, 5], [0, 1e300, 0, -1e300, 0]):
        mesh = delaunay(points, weights=weights)
        assert check(mesh, delaunay=True, brute=True)
        accounted(mesh)


@pytest.mark.parametrize("name", FLAT)
def test_flat_points_raise(name):
    points, dimension = FLAT[name]
    with pytest.raises(DegenerateInputError) as error:
        delaunay(points, weights=np.arange(len(points)))
    assert error.value.dimension == dimension


@pytest.mark.parametrize(
    "weights, words",
    [
        ([1, 2], r"shape \(4,\)"),
        ([[1], [2], [3], [4]], r"shape \(4,\)"),
        ([1, np.inf, 3, 4], r"weights\[1\]"),
        (np.ma.masked_array([1.0, 2, 3, 4], [0, 0, 1, 0]), r"weights\[2\] is masked"),
        (["a", "b", "c", "d"], "real numbers"),
        ([[1, 2], 3, 4, 5], "weights"),
    ],
)
def test_bad_weights(weights, words):
    with pytest.raises(InputError, match=words):
        delaunay([(0, 0), (1, 0), (1, 1), (0, 1)], weights=weights)


def test_the_validator_finds_what_is_wrong():
    points, weights = [(0, 0), (4, 0), (4, 4), (0, 4), (1, 2)], [0, 0, 0, 0, -30]
    mesh = delaunay(points, weights=weights)
    assert mesh.hidden.tolist() == [4]
    right = {"weights": weights, "hidden": [4]}
    assert check(Mesh(points, mesh.simplices, **right), delaunay=True)
    assert not check(Mesh(points, mesh.simplices, weights=weights))  # vertex 4 is not accounted for
    lighter = Mesh(points, mesh.simplices, weights=[0, 0, 0, 0, 1], hidden=[4])
    assert any("power cell" in p.text for p in check(lighter, delaunay=True).problems)
    everything = delaunay(points)
    assert check(everything, delaunay=True)
    assert not check(Mesh(points, everything.simplices, weights=weights), delaunay=True)
    assert not check(Mesh(points, everything.simplices, **right))
    with pytest.raises(InputError, match="hidden"):
        Mesh(points, mesh.simplices, hidden=[5])


def test_large_and_interruptible():
    points = uniform(20_000, 2, seed=1)
    weights = np.random.default_rng(2).random(20_000) * 1e-4
    mesh = delaunay(points, weights=weights, progress=False)
    assert 100 < len(mesh.hidden) < 19_000
    assert check(mesh, delaunay=True)
    assert orient(points[mesh.simplices[0]]) > 0
