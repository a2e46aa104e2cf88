"""Construction from given points, face by face: the same Delaunay complex, faces that match, and fronts."""

import os
import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from fixtures import FLAT, HARD_2D, HARD_3D, LEDGER, circle_integer, cube, lattice3, sphere_integer, uniform
from hypothesis import given, settings
from hypothesis import strategies as st

import unstruct
from unstruct import DegenerateInputError, InputError, Mesh, MeshError, check, delaunay, gift_wrap
from unstruct.connect.wrapping.start import first_cell, grow_exactly, suspects
from unstruct.examples.point_sets import clipped_lattice, letter_outlines, mapped_grid
from unstruct.examples.running import running_points, running_region, running_size
from unstruct.plain import gift_wrapping as plain
from unstruct.predicates.batch import in_sphere, orient

HARD = {f"{name}-2d": p for name, p in HARD_2D.items()} | {f"{name}-3d": p for name, p in HARD_3D.items()}
SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
RING = [(0, 1), (1, 2), (2, 3), (3, 0)]


def cells_of(rows):
    return {frozenset(map(int, row)) for row in rows}


def good(mesh, **options):
    report = check(mesh, **options)
    assert report, str(report)


@pytest.mark.parametrize("name", HARD)
def test_exact_delaunay_triangulation(name):
    points = HARD[name]
    mesh = gift_wrap(points)
    good(mesh, delaunay=True)
    assert np.array_equal(mesh.points, points)
    copies = set(mesh.duplicates[:, 0].tolist())
    assert set(np.unique(mesh.simplices)) == set(range(len(points))) - copies
    assert copies == set(delaunay(points).duplicates[:, 0].tolist())


@st.composite
def integer_points(draw, d):
    side = {2: 5, 3: 3, 4: 2}[d]
    rows = st.lists(st.tuples(*[st.integers(0, side)] * d), min_size=d + 1, max_size=12, unique=True)
    return np.array(draw(rows), float)


@settings(max_examples=120, deadline=None)
@given(st.sampled_from([2, 2, 3, 3, 4]).flatmap(integer_points))
def test_as_brute_force_and_as_the_plain_version(points):
    """All empty spheres by exact signs, the whole hull, and with the plain start the same cells."""
    d = points.shape[1]
    try:
        mesh = gift_wrap(points)
    except DegenerateInputError as error:
        assert error.dimension == np.linalg.matrix_rank(points - points[0])
        with pytest.raises(DegenerateInputError):
            plain.gift_wrap(points.tolist())
        return
    assert (np.asarray(in_sphere(mesh.corners[:, None], points[None])) <= 0).all()
    assert mesh.volume == pytest.approx(delaunay(points).volume, rel=1e-12)
    good(mesh, delaunay=True)
    slow = plain.gift_wrap(points.tolist())
    assert all(plain.orient([points[v] for v in cell]) > 0 for cell in slow)
    signs = in_sphere(mesh.corners[:, None], points[None])
    if (np.asarray(signs) == 0).sum() == mesh.size * (d + 1):  # no ties: there is only one
        assert cells_of(slow) == cells_of(mesh.simplices)
    else:
        volumes = [abs(np.linalg.det(points[list(c[1:])] - points[c[0]])) for c in slow]
        assert sum(volumes) == pytest.approx(mesh.volume * np.prod(np.arange(1, d + 1)))


@pytest.mark.parametrize("d", [2, 3, 4])
def test_ties_are_the_same_from_any_order_of_faces(d):
    """The infinitesimal lift: all rows of the corners of a cube, and two cubes that share a facet."""
    rng = np.random.default_rng(d)
    boxes = np.unique(np.vstack([cube(d), cube(d) + np.eye(d)[0]]), axis=0)
    for _ in range(10):
        mesh = gift_wrap(rng.permutation(boxes))
        assert mesh.volume == 2.0
        good(mesh, delaunay=True)


@pytest.mark.parametrize("points", [circle_integer(), sphere_integer(), sphere_integer(81)], ids=len)
def test_many_cospherical_points(points):
    mesh = gift_wrap(points)
    good(mesh, delaunay=True)
    if points.shape[1] == 2:
        assert mesh.size == len(points) - 2


def front_of(mesh, k):
    """The facets of the first k cells that belong to one of them only."""
    facets = [frozenset(np.delete(cell, i).tolist()) for cell in mesh.simplices[:k] for i in range(len(cell))]
    return {f for f in facets if facets.count(f) == 1}


def test_cells_are_a_history():
    """The first k cells hang together, and each but the first stands on an open face of those before."""
    mesh = gift_wrap(uniform(60, 2))
    for k in range(1, mesh.size):
        cell = set(mesh.simplices[k].tolist())
        assert any(cell - {v} in front_of(mesh, k) for v in cell), f"cell {k} stands alone"


@pytest.mark.parametrize("d", [2, 3])
def test_against_the_insertion_kernel(d):
    points = uniform(20000 if d == 2 else 3000, d)
    mesh = gift_wrap(points)
    assert cells_of(mesh.simplices) == cells_of(delaunay(points).simplices)


@pytest.mark.parametrize(("d", "n"), [(1, 30), (4, 60), (5, 25)])
def test_other_dimensions(d, n):
    points = uniform(n, d)
    mesh = gift_wrap(points)
    good(mesh, delaunay=True)
    assert cells_of(mesh.simplices) == cells_of(delaunay(points).simplices)


@pytest.mark.parametrize("name", FLAT)
def test_flat_input(name):
    points, dimension = FLAT[name]
    with pytest.raises(DegenerateInputError) as error:
        gift_wrap(points)
    assert error.value.dimension == dimension


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([2, 3]).flatmap(integer_points))
def test_the_first_cell_is_empty(points):
    """Also in rational arithmetic; and what floating point leaves out is outside."""
    try:
        rows = [first_cell(points), grow_exactly(points)]
    except DegenerateInputError:
        return
    for row in rows:
        row = row if orient(points[row]) > 0 else row[[1, 0, *range(2, len(row))]]
        signs = np.asarray(in_sphere(points[row], points))
        assert (signs <= 0).all()
        left_out = np.setdiff1d(np.arange(len(points)), [*suspects(points, row), *row])
        assert (signs[left_out] < 0).all()


@pytest.mark.parametrize(
    ("name", "face"),
    [
        ("smallest_area_face", {0, 1, 4}),
        ("smallest_longest_edge_face", {0, 3, 4}),
        ("smallest_perimeter_face", {1, 2, 3}),
    ],
)
def test_a_smallest_face_need_not_be_one(name, face):
    """In space neither area, nor longest edge, nor perimeter tells a face to start from."""
    mesh = gift_wrap(LEDGER[name])
    good(mesh, delaunay=True)
    assert face not in [set(f) for f in mesh.facets.tolist()]


# --- a prescribed front ---------------------------------------------------------------------------


def test_square_front():
    """Every edge on its own may take another corner; here they agree."""
    for shift in range(4):
        mesh = gift_wrap(SQUARE, np.roll(RING, shift, axis=0))
        good(mesh, delaunay="constrained")
        assert mesh.size == 2 and mesh.volume == 1.0


def test_edge_with_no_empty_circle():
    """Every circle through the ends of the edge holds a vertex: yet each side has its cells."""
    points = np.array([(-5, 0), (5, 0), (0, 1), (0, 8), (0, -1)], float)
    signs = in_sphere(points[[[0, 1, 2], [0, 1, 3]]], points[4])
    assert (np.asarray(signs) > 0).all(), "no apex above has an empty circle"
    mesh = gift_wrap(points, [(0, 1), (1, 0)])
    good(mesh, delaunay="constrained")
    assert [0, 1] in mesh.edges.tolist() and not check(Mesh(mesh.points, mesh.simplices), delaunay=True)
    assert cells_of(mesh.simplices) != cells_of(delaunay(points).simplices)


def test_running_region():
    points, (_, segments) = running_points(), running_region(running_size)
    mesh = gift_wrap(points, segments)
    good(mesh, delaunay="constrained")
    assert {frozenset(e) for e in mesh.boundary.tolist()} == {frozenset(e) for e in segments.tolist()}
    assert mesh.euler_characteristic == 0


@pytest.mark.parametrize("spacing", [0.3, 0.1, 0.05])
def test_clipped_lattice(spacing):
    """Where it is coarse the Delaunay triangulation misses boundary edges; with the front it has them."""
    points, segments = clipped_lattice(spacing)
    mesh = gift_wrap(points, segments)
    good(mesh, delaunay="constrained")
    present = {frozenset(e) for e in gift_wrap(points).edges.tolist()}
    assert (spacing < 0.3) == all(frozenset(e) in present for e in segments.tolist()) or spacing == 0.1


def test_mapped_grid():
    points = mapped_grid(24, 6)
    good(gift_wrap(points), delaunay=True)
    with pytest.raises(InputError, match="ring"):
        mapped_grid(1, 1)


def test_letters():
    points, segments = letter_outlines("Mesh")
    mesh = gift_wrap(points, segments)
    good(mesh, delaunay="constrained")
    a, b = points[segments].transpose(1, 0, 2)
    assert mesh.volume == pytest.approx(float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])) / 2)
    with pytest.raises(InputError, match="no outline"):
        letter_outlines(" ")


def test_cube_front_in_space():
    corners = cube(3)
    front = gift_wrap(corners).boundary
    for points in (
        corners,
        np.vstack([corners, [[0.5, 0.5, 0.5]]]),
        np.vstack([corners, lattice3(2, 2, 2) / 4 + 0.25]),
    ):
        mesh = gift_wrap(points, front)
        good(mesh)
        assert mesh.volume == 1.0
        assert {frozenset(f) for f in mesh.boundary.tolist()} == {frozenset(f) for f in front.tolist()}


def prism(turned):
    """A prism over a triangle, its top turned by 30 degrees, with one of the two diagonals of each side."""
    angle = 2 * np.pi * np.arange(3) / 3
    low, high = (
        np.column_stack([np.cos(a), np.sin(a), z * np.ones(3)])
        for a, z in ((angle, 0), (angle + np.pi / 6, 1))
    )
    sides = []
    for i in range(3):
        j = (i + 1) % 3
        sides += [(i, j, 3 + j), (i, 3 + j, 3 + i)] if turned else [(i, j, 3 + i), (j, 3 + j, 3 + i)]
    return np.vstack([low, high]), [(2, 1, 0), (3, 4, 5), *sides]


def test_schoenhardt_prism_admits_no_apex():
    """The other diagonals do; these leave every tetrahedron cut by an edge. One point inside helps."""
    points, front = prism(False)
    good(gift_wrap(points, front))
    points, front = prism(True)
    with pytest.raises(MeshError, match=r"front\[0\] on vertices \[2, 1, 0\] admits no apex after 0 cells"):
        gift_wrap(points, front)
    helped = gift_wrap(np.vstack([points, [[0.0, 0.0, 0.5]]]), front)
    good(helped)
    assert helped.size == 8


def test_crossing_front_is_reported():
    with pytest.raises(MeshError, match=r"on vertices \[.*\] admits no apex"):
        gift_wrap(SQUARE, [(0, 2), (2, 0), (1, 3), (3, 1)])


def test_a_vertex_on_a_face_is_reported():
    with pytest.raises(MeshError, match=r"front\[0\] on vertices \[0, 1\] admits no apex"):
        gift_wrap(np.vstack([SQUARE, [[0.5, 0.0]]]), RING)


def test_turned_front_is_reported():
    with pytest.raises(MeshError, match="turn the faces"):
        gift_wrap(SQUARE, [e[::-1] for e in RING])


@pytest.mark.parametrize(
    ("points", "front", "text"),
    [
        (SQUARE, [(0, 1, 2)], "shape"),
        (SQUARE, [(0, 7)], r"front\[0\] = \[0, 7\]"),
        (SQUARE, [(0, 1), (1, 1)], r"front\[1\].*flat"),
        (SQUARE, [(0, 1), (0, 1)], r"front\[1\].*twice"),
        (cube(3), [(0, 1, 2), (1, 2, 0)], r"front\[1\].*twice"),
        (np.vstack([cube(3), [[0, 0, 2]]]), [(0, 1, 8)], r"front\[0\].*flat"),
        (uniform(9, 4), [(0, 1, 2, 3)], "two or three dimensions"),
        (uniform(9, 1), [(0,)], "two or three dimensions"),
        (SQUARE[:2], None, "too few"),
        ([[0.0, np.nan], [0, 1], [1, 0]], None, r"points\[0\]"),
    ],
)
def test_bad_input(points, front, text):
    with pytest.raises(InputError, match=text):
        gift_wrap(points, front)


def test_duplicates_in_a_front():
    """A front may name copies: they stand for the vertex that is kept."""
    points = np.vstack([SQUARE, SQUARE[:1]])
    mesh = gift_wrap(points, [(4, 1), (1, 2), (2, 3), (3, 4)])
    good(mesh, delaunay="constrained")
    assert mesh.duplicates.tolist() == [[4, 0]]


def test_it_never_calls_the_insertion_kernel(monkeypatch):
    def forbidden(*args, **options):
        raise AssertionError("gift wrapping builds its cells itself")

    monkeypatch.setattr(unstruct.Triangulation, "insert", forbidden)
    for d in (1, 2, 3, 4):
        assert gift_wrap(list(product(range(3), repeat=d))).volume == 2.0**d


def test_without_numba():
    """Kernels run as plain Python, without a warning, and make the same cells: here and in insertion."""
    program = """
import warnings; warnings.simplefilter("error")
import numpy as np, unstruct
for d in (2, 3):
    points = np.random.default_rng(d).integers(0, 4, (25, d)).astype(float)
    mesh = unstruct.gift_wrap(points)
    more = unstruct.insert(mesh, mesh.corners.mean(axis=1)[:5])
    print(mesh.simplices.tolist(), more.simplices.tolist())
square, ring = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]]
print(unstruct.gift_wrap(square, ring).simplices.tolist())
"""
    made = []
    for off in ("0", "1"):
        environment = os.environ | {"NUMBA_DISABLE_JIT": off}
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        made.append(done.stdout)
    assert made[0] == made[1]
