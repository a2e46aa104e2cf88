"""Every hard point input through the public ``delaunay``, in two and three dimensions."""

import math

import numpy as np
import pytest
from fixtures import (
    FLAT,
    HARD_2D,
    HARD_3D,
    duplicates,
    lattice2,
    lattice3,
    moment_curve,
    uniform,
    wide_exponents,
)
from interrupts import interrupt

import unstruct
from unstruct import DegenerateInputError, InputError, UnstructError, check, delaunay
from unstruct.plain.bowyer_watson import triangulate
from unstruct.plain.predicates import in_sphere, orient

HARD = {f"{name}-2d": p for name, p in HARD_2D.items()} | {f"{name}-3d": p for name, p in HARD_3D.items()}
PLAIN = {name: p for name, p in HARD.items() if len(p) <= 40}
CORNERS = {2: [[0.0, 0], [1, 0], [0, 1]], 3: [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}


@pytest.mark.parametrize("name", HARD)
def test_exact_delaunay_triangulation(name):
    """No flat cell, the true hull, empty spheres by exact signs, all points used or named as copies."""
    points = HARD[name]
    mesh = delaunay(points)
    report = check(mesh, delaunay=True)
    assert report, str(report)
    assert np.array_equal(mesh.points, points), "mesh.points is the input, in input order"
    copies = set(mesh.duplicates[:, 0].tolist()) if mesh.duplicates is not None else set()
    assert set(np.unique(mesh.simplices)) == set(range(len(points))) - copies


@pytest.mark.parametrize("name", PLAIN)
def test_as_the_plain_version_up_to_ties(name):
    """As many cells and the same hull as in rational arithmetic; the same cells where no sphere has a tie."""
    points = PLAIN[name]
    mesh = delaunay(points)
    kept = {tuple(p): v for v, p in reversed(list(enumerate(points.tolist())))}
    fast = {frozenset(kept[tuple(points[v].tolist())] for v in cell) for cell in mesh.simplices}
    plain = {frozenset(cell) for cell in triangulate(points)}
    assert hull(points, fast) == hull(points, plain)
    sites = set(kept.values())
    tie = any(in_sphere(points[sorted(c)], points[v]) == 0 for c in plain for v in sites - c)
    if not tie:
        assert fast == plain
    elif points.shape[1] == 2:
        assert len(fast) == len(plain)


def hull(points, cells):
    """The planes of the boundary, as the sets of points on them (ties may cut a flat facet otherwise)."""
    once = set()
    for cell in cells:
        for v in cell:
            once ^= {cell - {v}}
    planes = set()
    for facet in once:
        base = [points[v] for v in facet]
        planes.add(frozenset(v for v, p in enumerate(points) if orient([*base, p]) == 0))
    return planes


@pytest.mark.parametrize("name", HARD)
def test_same_input_same_output(name):
    a, b = delaunay(HARD[name]), delaunay(HARD[name].copy())
    assert np.array_equal(a.simplices, b.simplices) and np.array_equal(a.neighbors, b.neighbors)


@pytest.mark.parametrize("name", FLAT)
def test_flat_input_says_which_and_the_dimension(name):
    points, dimension = FLAT[name]
    with pytest.raises(DegenerateInputError) as caught:
        delaunay(points)
    assert caught.value.dimension == dimension
    assert ("equal", "collinear", "coplanar")[dimension] in str(caught.value)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_not_finite_names_the_first_row(d, value):
    points = uniform(20, d)
    points[7, d - 1] = value
    points[13] = value
    with pytest.raises(InputError, match=r"\b7\b"):
        delaunay(points)


@pytest.mark.parametrize("d", [2, 3])
def test_masked_names_the_first_row(d):
    points = np.ma.masked_array(uniform(20, d), mask=np.zeros((20, d), dtype=bool))
    points[5, 0] = np.ma.masked
    with pytest.raises(InputError, match=r"\b5\b"):
        delaunay(points)


BAD = {
    "one axis": lambda p: p[0],
    "three axes": lambda p: p[None],
    "text": lambda p: p.astype(str),
    "complex": lambda p: p + 1j,
    "objects": lambda p: np.full(p.shape, None),
    "ragged": lambda p: [row.tolist()[: 1 + k % 2] for k, row in enumerate(p)],
    "no rows": lambda p: p[:0],
    "empty list": lambda p: [],
    "no columns": lambda p: p[:, :0],
    "too few": lambda p: p[: p.shape[1]],
    "one point": lambda p: p[:1],
    "none": lambda p: None,
    "a string": lambda p: "points",
}


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("make", BAD.values(), ids=BAD)
def test_bad_arrays_raise_the_typed_error(d, make):
    with pytest.raises(UnstructError) as caught:
        delaunay(make(uniform(20, d)))
    assert len(str(caught.value)) > 20


@pytest.mark.parametrize("dtype", [np.int8, np.int32, np.uint64, np.int64, np.float16, np.float32, bool])
def test_real_types_are_taken(dtype):
    points = lattice2(2, 2).astype(dtype)
    mesh = delaunay(points)
    assert mesh.points.dtype == np.float64 and check(mesh, delaunay=True) and len(mesh.simplices) == 2


def test_integers_beyond_doubles_are_refused_or_exact():
    """2**53 + 1 is no double: a silent rounding would move a point."""
    points = np.array([[0, 0], [2**53 + 1, 0], [0, 2**53 + 1], [2**53, 2**53]], dtype=np.int64)
    with pytest.raises(InputError, match=r"\b1\b"):
        delaunay(points)


@pytest.mark.parametrize("d", [2, 3])
def test_duplicates_are_meshed_once_and_listed(d):
    points = duplicates(d)
    mesh = delaunay(points)
    assert sorted(map(tuple, mesh.duplicates.tolist())) == [(12, 0), (13, 3), (14, 3), (16, 15)]
    assert not {12, 13, 14, 16} & set(np.unique(mesh.simplices).tolist())
    assert check(mesh, delaunay=True)


@pytest.mark.parametrize("d", [2, 3])
def test_many_copies(d):
    base = (lattice2(3, 3) if d == 2 else lattice3(2, 2, 2))[::-1]
    points = np.vstack([base] * 5)
    mesh = delaunay(points)
    assert len(mesh.duplicates) == 4 * len(base) and (mesh.duplicates[:, 1] < len(base)).all()
    assert check(mesh, delaunay=True)


@pytest.mark.parametrize("d", [2, 3])
def test_last_bit_decides(d):
    """One site moved by its last bit goes from inside the circle to outside, and the cells follow."""
    for nudge, inside in ((np.nextafter(1, 0), True), (np.nextafter(1, 2), False)):
        points = np.vstack([CORNERS[d], np.ones((1, d))])
        points[-1, 0] = nudge
        mesh = delaunay(points)
        cells = {frozenset(map(int, c)) for c in mesh.simplices}
        assert (frozenset(range(d + 1)) in cells) is not inside
        assert check(mesh, delaunay=True)


@pytest.mark.parametrize("reach", [200, 400, 800, 1000])
@pytest.mark.parametrize("d", [2, 3])
def test_exponents_too_wide_are_exact_or_refused(d, reach):
    points = wide_exponents(d, reach)
    try:
        mesh = delaunay(points)
    except UnstructError as error:
        assert len(str(error)) > 20
        return
    assert check(mesh, delaunay=True)
    for cell in mesh.simplices:
        assert all(in_sphere(points[cell], q) <= 0 for q in points)


def test_moment_curve_has_all_its_tetrahedra():
    for n in (5, 9, 30):
        assert len(delaunay(moment_curve(n)).simplices) == math.comb(n - 2, 2)


@pytest.mark.parametrize("size", [300, 40])
def test_large_lattices(size):
    points = lattice2(size, size) if size > 100 else lattice3(size // 2, size // 2, size // 2)
    mesh = delaunay(np.random.default_rng(0).permutation(points))
    assert check(mesh, delaunay=True)
    assert abs(mesh.volume - np.prod(points.max(axis=0))) < 1e-6


@pytest.mark.parametrize(("n", "d", "most"), [(300_000, 2, 100_000), (25_000, 3, 10_000), (300, 4, 20)])
def test_an_interrupt_is_heard_after_a_chunk(monkeypatch, n, d, most):
    points = uniform(n, d, seed=1)
    steps = interrupt(monkeypatch, lambda: delaunay(points, progress=True), "points")
    assert max(steps) <= most
    assert check(delaunay(uniform(100)), delaunay=True)


def test_public_names():
    assert issubclass(UnstructError, ValueError)
    assert unstruct.delaunay is delaunay
