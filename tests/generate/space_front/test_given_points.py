"""The empty sphere from a front in space: the plain one, Delaunay where there is one, ties, what is left."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from solids import cube, torus

from unstruct import (
    Domain,
    IncompleteWarning,
    InputError,
    Mesh,
    UnstructError,
    check,
    delaunay,
    examples,
    front_delaunay,
    topology,
)
from unstruct.generate.space_front.classical_run import body_faces
from unstruct.generate.space_front.given_points import given_points_in_space
from unstruct.generate.space_front.tie_order import order_that_fits
from unstruct.geometry.ordering import hilbert_order
from unstruct.plain import front_delaunay_space as plain

CORNERS = st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=6, max_size=10, unique=True)


def hull_of(points: np.ndarray) -> tuple[Domain, np.ndarray, Mesh]:
    """The convex hull of points, those that are strictly inside, and all of their Delaunay cells."""
    try:
        mesh = delaunay(points)
        used = np.unique(mesh.convex_hull)
        domain = Domain(points[used], np.searchsorted(used, mesh.convex_hull))
    except UnstructError:
        assume(False)
    return domain, np.delete(points, used, axis=0), mesh


def cells_of(mesh: Mesh) -> set[frozenset[tuple[float, ...]]]:
    return {frozenset(map(tuple, mesh.points[row].tolist())) for row in mesh.simplices}


@settings(max_examples=6, deadline=None)
@given(CORNERS)
def test_the_plain_front_step_by_step(points: list[tuple[int, int, int]]) -> None:
    """Same faces and apexes on a lattice full of ties; the same faces are left."""
    domain, inside, _ = hull_of(np.array(points, dtype=float))
    mesh = given_points_in_space(domain, inside, history=True)
    assume("ties decided anew" not in mesh.counts)
    every = np.concatenate([domain.points, inside])
    body = body_faces(Domain(every, domain.facets))
    n = len(domain.points)
    order = np.append(np.arange(n), n + hilbert_order(inside))  # by which ties are decided
    every, number = every[order], np.argsort(order)
    loose = np.sort(number[body.needed]).tolist()
    steps = list(plain.front_delaunay_in_space(every.tolist(), number[body.faces].tolist(), loose=loose))
    assert mesh.counts["cells"] == len(steps)
    assert mesh.counts["stuck faces"] == (len(steps[-1].front) if steps else len(body.faces))
    if mesh.counts["taken back"] == 0:
        made = mesh.points[mesh.simplices[: len(steps)]]
        assert (made == every[np.array([(*s.face, s.apex) for s in steps]).reshape(-1, 4)]).all()
        assert mesh.steps is not None
        assert mesh.steps["cospherical"].tolist() == [len(s.cospherical) > 0 for s in steps]


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([20, 60, 200]))
def test_delaunay_of_random_points(seed: int, many: int) -> None:
    """Without ties the cells are those of the Delaunay triangulation."""
    domain, inside, expected = hull_of(np.random.default_rng(seed).random((many, 3)))
    mesh = given_points_in_space(domain, inside)
    assert cells_of(mesh) == cells_of(expected) and mesh.complete
    assert mesh.counts["cospherical"] == mesh.counts["hidden"] == mesh.counts["not Delaunay"] == 0


@settings(max_examples=25, deadline=None)
@given(CORNERS, st.integers(0, 2**32 - 1))
def test_an_order_fits_to_any_convex_body(points: list[tuple[int, int, int]], seed: int) -> None:
    """The surface of the hull is Delaunay for some order of ties; a random one is mended to fit."""
    domain, _, _ = hull_of(np.array(points, dtype=float))
    body, n = body_faces(domain), len(domain.points)
    order = np.random.default_rng(seed).permutation(n)
    fits = order_that_fits(body.points, body.faces, order)
    corners, faces = domain.points.astype(int).tolist(), body.faces.tolist()
    assert sorted(fits) == list(range(n)) and not wrong_diagonals(corners, faces, fits)
    assert np.array_equal(fits, order) == (not wrong_diagonals(corners, faces, order))


@settings(max_examples=25, deadline=None)
@given(CORNERS, st.booleans())
def test_any_hull_of_a_lattice(points: list[tuple[int, int, int]], drop: bool) -> None:
    """A valid mesh of all points; constrained Delaunay exactly where it says so."""
    domain, inside, _ = hull_of(np.array(points, dtype=float))
    mesh = given_points_in_space(domain, inside[::2] if drop else inside)
    assert check(mesh, domain=domain)
    if mesh.complete:
        assert check(mesh, domain=domain, delaunay="constrained")
    else:
        assert mesh.counts["filled"] > 0 or mesh.counts["not Delaunay"] > 0


def test_a_lattice() -> None:
    """Everything is cospherical: the order of the ties makes all cells fit."""
    x = np.array(list(product(range(1, 5), repeat=3))) / 5
    mesh = given_points_in_space(Domain.box([0, 0, 0], [1, 1, 1]), x)
    assert mesh.complete and mesh.counts["stuck faces"] == 0 and mesh.counts["cospherical"] > 100
    assert check(mesh, domain=Domain.box([0, 0, 0], [1, 1, 1]), delaunay="constrained")


def test_given_diagonals_against_the_order_of_ties() -> None:
    """Thirteen Delaunay cells of a lattice. The order of its vertices wants another diagonal of a square."""
    points = [[int(x) for x in p] for p in "100 122 212 211 200 222 221 210 021 011 112".split()]
    cells = "0734 6739 0324 6798 9708 9168 a561 9a61 03a2 63a9 263a 562a 3709".split()
    rows = np.array([[int(v, 16) for v in cell] for cell in cells])
    domain = Domain.surface(Mesh(points, topology.boundary(rows, topology.neighbors(rows))))
    mesh = front_delaunay(domain, np.empty((0, 3)))
    assert mesh.complete and mesh.counts["ties decided anew"] == 1 and len(mesh.points) == 11
    assert check(mesh, domain=domain, delaunay="constrained")
    body = body_faces(domain)
    order = order_that_fits(body.points, body.faces, np.arange(11))
    assert sorted(order) == list(range(11)) and not wrong_diagonals(points, body.faces.tolist(), order)
    assert wrong_diagonals(points, body.faces.tolist(), np.arange(11))


@pytest.mark.parametrize("power", [-1, -400, -600])
@pytest.mark.parametrize("turned", [0, 1, 2])
def test_an_order_fits_to_a_square_however_small(power: int, turned: int) -> None:
    """The normal of a small square underflows beside vertices that are far; its pair counts as any other."""
    square = np.roll([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], turned, axis=1) * 2.0**power
    points = np.concatenate([square, [[1, 1, 1], [2, 1, 1], [1, 2, 1]]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6]])
    order = np.array([1, 3, 4, 5, 6, 2, 0])
    fits = order_that_fits(points, faces, order)
    assert sorted(fits) == list(range(7)) and max(np.argsort(fits)[[1, 3]]) > max(np.argsort(fits)[[0, 2]])


def wrong_diagonals(points: list[list[int]], faces: list[list[int]], order: np.ndarray) -> list[set[int]]:
    """Pairs of triangles in a plane, corners on a circle, of which the last vertex is on the diagonal."""
    place, wrong = np.argsort(order), []
    for one, two in combinations(map(set, faces), 2):
        four = sorted(one | two)
        if len(four) == 4 and is_on_circle([points[v] for v in four]):
            last = max(four, key=lambda v: place[v])
            wrong += [one | two] if last in one & two else []
    return wrong


def is_on_circle(four: list[list[int]]) -> bool:
    """Whether lattice points are in a plane and on a circle: both ranks are told by a table of integers."""
    rows = sympy.Matrix([[*p, 1] for p in four])
    lifted = sympy.Matrix([[*p, 1, sum(x * x for x in p)] for p in four])
    return rows.rank() == 3 and lifted.rank() == 3


@pytest.mark.parametrize("body", [torus(7, 5), cube(3, 1)])
def test_solids(body: tuple[np.ndarray, np.ndarray]) -> None:
    domain = Domain(*body)
    mesh = given_points_in_space(domain, np.empty((0, 3)))
    assert check(mesh, domain=domain)
    assert mesh.complete == (mesh.counts["filled"] == mesh.counts["not Delaunay"] == 0)


def test_the_twisted_prism_has_no_apex() -> None:
    """All faces see nothing: the rest is filled, and that is said."""
    mesh = given_points_in_space(examples.stuck_body("twisted prism"), [])
    assert mesh.counts["cells"] == 0 and mesh.counts["stuck faces"] == 8 and mesh.counts["added inside"] == 1
    assert not mesh.complete and all(why.startswith("no apex") for why in mesh.reasons)
    assert check(mesh, domain=examples.stuck_body("twisted prism"))


@pytest.mark.parametrize("name", ["convex", "ten faces"])
def test_where_the_classical_front_sticks(name: str) -> None:
    mesh = given_points_in_space(examples.stuck_body(name), [])
    assert mesh.complete and check(mesh, domain=examples.stuck_body(name), delaunay="constrained")


def test_names_and_what_is_outside() -> None:
    """A wall across the box, points on both sides and outside."""
    x = [[i, j, k] for i in (0, 1, 2) for j in (0, 1) for k in (0, 1)]
    facets = [
        [0, 1, 3, 2], [8, 9, 11, 10], [0, 1, 5, 4], [4, 5, 9, 8], [2, 3, 7, 6], [6, 7, 11, 10],
        [0, 2, 6, 4], [4, 6, 10, 8], [1, 3, 7, 5], [5, 7, 11, 9],
    ]  # fmt: skip
    regions = {"left": [[0.2, 0.5, 0.5]], "right": [[1.2, 0.5, 0.5]]}
    domain = Domain(x, facets, inner=[[4, 5, 7, 6]], markers={"wall": [10]}, regions=regions)
    points = np.random.default_rng(1).random((80, 3)) * [3, 1, 1]
    mesh = given_points_in_space(domain, points)
    assert check(mesh, domain=domain)
    assert mesh.counts["outside"] == len(mesh.left_out) > 0
    assert mesh.left_out.tolist() == np.flatnonzero(points[:, 0] > 2).tolist()
    middle = mesh.points[mesh.simplices].mean(axis=1)[:, 0]
    assert (mesh.markers["region"] == (middle > 1)).all() and len(mesh.markers["wall"]) == 2


def test_points_outside_are_told() -> None:
    """A point in a cavity, one outside, one a rounding error inside; the words are those of the plane."""
    body = Domain.box([0, 0, 0], [3, 3, 3]).with_holes(Domain.box([1, 1, 1], [2, 2, 2]))
    points = [[1.5, 1.5, 1.5], [0.5, 0.5, 0.5], [4, 1, 1], [0.5, 0.25, np.nextafter(0, 1) + 1e-12]]
    with pytest.warns(
        IncompleteWarning, match=r"2 of 4 points are outside .*: points\[0\], points\[2\]; see"
    ):
        mesh = front_delaunay(body, points)
    assert mesh.left_out.tolist() == [0, 2] and check(mesh, domain=body)
    with pytest.raises(InputError, match=r"points\[1\].*lies on"):
        front_delaunay(body, [[0.5, 0.5, 0.5], [1, 1.5, 1.5]])
    many = np.column_stack([np.arange(8.0) + 5, np.zeros((8, 2))])
    with pytest.warns(IncompleteWarning, match=r"8 of 8 points .*points\[4\], \.\.\.; see"):
        front_delaunay(body, many)


@pytest.mark.parametrize(
    ("points", "text"),
    [
        ([[0.2, 0.3, 0.4], [0.2, 0.3, 0.4]], r"points\[1\].*equal to points\[0\]"),
        ([[1, 1, 1]], r"points\[0\].*vertex"), ([[0.5, 0.5, 1]], r"points\[0\].*lies on"),
        ([[0.5, 0.5]], "shape"), ([[np.nan, 0, 0]], "points"),
    ],
)  # fmt: skip
def test_arguments(points: list[list[float]], text: str) -> None:
    with pytest.raises(InputError, match=text):
        given_points_in_space(Domain.box([0, 0, 0], [1, 1, 1]), points)
