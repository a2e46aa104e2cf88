"""Baker's insertion: exact, in any triangulation, in two and three dimensions."""

import numpy as np
import pytest
from fixtures import lattice2, lattice3, uniform
from hypothesis import given, settings
from hypothesis import strategies as st
from reductions import count_reductions, scrambled

import unstruct
from unstruct import InputError, Mesh, MeshError, check, delaunay, gift_wrap, insert
from unstruct.examples.running import flip_at_random, random_triangulation, two_triangulations
from unstruct.mesh.topology import neighbors
from unstruct.plain import modernized as plain
from unstruct.predicates.batch import orient
from unstruct.studies import Baker

# A facet of the principal component that the point does not see: in space six vertices are enough.
HIDDEN_FACET_POINTS = [(0, 0, 1), (0, 1, 0), (3, 2, 1), (3, 2, 2), (1, 3, 3), (1, 2, 2)]
HIDDEN_FACET_CELLS = [(0, 1, 2, 3), (0, 1, 3, 5), (0, 1, 4, 5), (0, 3, 4, 5), (1, 2, 3, 4), (1, 3, 4, 5)]
HIDDEN_FACET_P = (1.5, 7 / 3, 2.0)
# Two parts of a generalized cavity that do not touch, and two that touch in a vertex.
APART = ([(0, 1), (0, 2), (1, 0), (1, 2), (2, 0)], [(0, 1, 2), (1, 2, 3), (2, 3, 4)], (1.6, 0.5))
TOUCHING = (
    [(6, 2), (5, 5), (6, 7), (3, 7), (2, 1), (1, 1)],
    [(0, 1, 2), (0, 1, 4), (1, 2, 3), (1, 3, 5), (1, 4, 5)],
    (4.2, 2.2),
)


def mesh_of(points, cells):
    return Mesh(np.array(points, float), cells).oriented()


def cells_of(rows):
    return {frozenset(map(int, row)) for row in rows}


def good(mesh, volume, *, delaunay=False):
    report = check(mesh, delaunay=delaunay)
    assert report, str(report)
    assert np.array_equal(neighbors(mesh.simplices), mesh.neighbors)
    assert mesh.volume == pytest.approx(volume, rel=1e-12)


def test_hidden_facet_in_space_is_reduced():
    mesh = mesh_of(HIDDEN_FACET_POINTS, HIDDEN_FACET_CELLS)
    good(mesh, 20 / 6)
    growing = Baker(mesh)
    record = growing.insert([HIDDEN_FACET_P])
    assert record.component == [3] and record.hidden == [1] and record.spared == [1] and record.deleted == [2]
    result = growing.mesh()
    good(result, 20 / 6)
    assert {0, 1, 2, 3} in cells_of(result.simplices), "the owner of the hidden facet stays"


def test_hidden_facet_in_space_is_refused_on_demand():
    mesh = mesh_of(HIDDEN_FACET_POINTS, HIDDEN_FACET_CELLS)
    with pytest.raises(MeshError, match=r"points\[0\].*hidden") as error:
        insert(mesh, HIDDEN_FACET_P, reduce=False)
    named = str(error.value).split("the facet [")[1].split("]")[0]
    assert {int(v) for v in named.split(",")} == {0, 1, 3}


@pytest.mark.parametrize(("points", "cells", "p"), [APART, TOUCHING])
def test_only_the_component_of_the_point_goes(points, cells, p):
    mesh = mesh_of(points, cells)
    exact = [*points, p]
    step = plain.insert(exact, mesh.simplices.tolist(), len(points))
    assert step.cavity > step.component, "the fixture has a cavity in two parts"
    result = insert(mesh, p)
    good(result, mesh.volume)
    assert cells_of(result.simplices) == cells_of(step.cells)


@st.composite
def any_triangulation(draw, d):
    """A triangulation of small integer points, and a lattice or half-lattice point of its hull."""
    side = 4 if d == 2 else 3
    rows = draw(st.lists(st.tuples(*[st.integers(0, side)] * d), min_size=d + 2, max_size=11, unique=True))
    points = np.array(rows, float)
    seed = draw(st.integers(0, 10**6))
    try:
        mesh = delaunay(points)
    except unstruct.DegenerateInputError:
        points = np.vstack([points, side * np.eye(d)[:1] + 5, 7 * np.eye(d), np.zeros((1, d))])
        mesh = delaunay(np.unique(points, axis=0))
    mesh = flip_at_random(mesh, draw(st.sampled_from([0, 20, 100])), seed)
    cell = mesh.points[mesh.simplices[draw(st.integers(0, mesh.size - 1))]]
    kind = draw(st.integers(1, d + 1))  # corners that take part: on a vertex, an edge, ..., inside
    weights = np.array(draw(st.lists(st.sampled_from([1, 2, 4]), min_size=d + 1, max_size=d + 1)), float)
    weights[kind:] = 0
    if weights.sum() not in (1, 2, 4, 8):  # exact multiples of 1/8, so that the point really lies on the face
        weights[:kind], weights[0] = 1, 0
        weights[0] = {1: 1, 2: 1, 3: 2, 4: 1}[kind]
    return mesh, weights @ cell / weights.sum()


@settings(max_examples=150, deadline=None)
@given(st.sampled_from([2, 3]).flatmap(any_triangulation))
def test_as_the_plain_version(case):
    """The same cells as in rational arithmetic, where reductions are taken one at a time."""
    mesh, p = case
    result = insert(mesh, p)
    n = len(mesh.points)
    step = plain.insert([*mesh.points.tolist(), p.tolist()], mesh.simplices.tolist(), n)
    assert cells_of(result.simplices) == cells_of(step.cells)
    assert all(s > 0 for s in np.ravel(orient(result.corners)))
    assert np.array_equal(neighbors(result.simplices), result.neighbors)
    assert set(np.unique(result.simplices)) >= set(np.unique(mesh.simplices)), "no vertex is lost"
    if any((p == q).all() for q in mesh.points):
        assert result.duplicates[-1][0] == n and cells_of(result.simplices) == cells_of(mesh.simplices)
    else:
        good(result, mesh.volume)
        assert n in result.simplices


@pytest.mark.parametrize("d", [2, 3])
def test_from_a_delaunay_start_it_is_bowyer_watson(d):
    corners = np.array(np.meshgrid(*[[0.0, 4.0]] * d)).reshape(d, -1).T
    inside = uniform(150, d) * 4
    lattice = (lattice2(5, 5) if d == 2 else lattice3(5, 5, 5)) * 1.0
    for points in (inside, lattice, np.random.default_rng(0).permutation(lattice)):
        mesh = insert(delaunay(corners), points)
        good(mesh, 4.0**d, delaunay=True)
        copies = {tuple(p) for p in mesh.points[mesh.duplicates[:, 0]].tolist()}
        assert copies == {tuple(c) for c in corners.tolist()} & {tuple(p) for p in points.tolist()}


def test_many_points_grow_the_arrays():
    growing = Baker(delaunay([[0, 0], [1, 0], [0, 1], [1, 1]]))
    points = uniform(5000, 2)
    for part in np.array_split(points, 7):
        growing.insert(part)
    assert np.array_equal(growing.points[4:], points)
    good(growing.mesh(), 1.0, delaunay=True)
    assert cells_of(growing.mesh().simplices) == cells_of(delaunay(growing.points).simplices)


def test_into_a_region_that_is_not_convex():
    """P on the boundary with a coplanar facet of the boundary beyond a gap: nothing may bridge the gap."""
    points = np.array([(0, 0), (2, 0), (2, 2), (4, 2), (4, 0), (6, 0), (6, 4), (0, 4)], float)
    segments = np.column_stack([np.arange(8), (np.arange(8) + 1) % 8])
    arch = gift_wrap(points, segments)
    inside = np.array(
        [(1, 0), (5, 0), (3, 2), (1, 3.5), (5.5, 1), (0.5, 0.5), (2, 1), (3, 3), (6, 2), (5, 4)]
    )
    for points in (inside, inside[::-1]):
        mesh = insert(arch, points)
        good(mesh, 20.0)
        assert len(mesh.boundary) == 8 + 6


def test_a_ledge_in_the_plane_of_the_point():
    """In space a facet of the boundary may be coplanar with an interior point: it is hidden, not flat."""
    mesh = gift_wrap(lattice3(3, 3, 3))
    centers = mesh.corners.mean(axis=1)
    carved = mesh.select(~((centers[:, 0] > 1) & (centers[:, 2] > 1)))  # a stair with a ledge at z = 1
    good(carved, 6.0)
    new = np.random.default_rng(4).integers(0, 33, (40, 3)) / 16
    new[:25, 2] = 1  # in the plane of the ledge, before it and on it
    new = new[(new[:, 0] <= 1) | (new[:, 2] <= 1)]
    for start in (carved, flip_at_random(carved, 600, 1)):
        growing = Baker(start)
        growing.insert(new)
        good(growing.mesh(), 6.0)


def test_markers_go_with_the_facets():
    square = [(0, 0), (2, 0), (2, 2), (0, 2)]
    mesh = Mesh(square, [(0, 1, 2), (0, 2, 3)], markers={"half": np.array([7, 8]), "side": [[0, 1], [0, 2]]})
    result = insert(mesh, (1.5, 0.5))
    below = orient(result.points[result.simplices][:, [0, 1, 2]]) > 0
    assert below.all() and sorted(result.markers["half"].tolist()) == [7, 7, 8, 8]
    assert result.markers["side"].tolist() == [[0, 1]], "the diagonal went, the side stays"
    assert result.origin.tolist() == [0, 1, 2, 3, -1]


@pytest.mark.parametrize(
    ("point", "text"),
    [
        ((3.0, 3.0), r"points\[0\].*outside"),
        ((0.9, 0.9), r"points\[0\].*outside"),
        ((0.1, np.nan), r"points\[0\].*not finite"),
        ((0.1, 0.1, 0.1), "2 coordinates"),
        ([[0.2, 0.2], [5, 5]], r"points\[1\].*outside"),
        ([], "shape"),
    ],
)
def test_bad_points(point, text):
    with pytest.raises(InputError, match=text):
        insert(delaunay([[0, 0], [1, 0], [0, 1]]), point)


def test_bad_meshes():
    with pytest.raises(MeshError, match="cell 1"):
        insert(Mesh([[0, 0], [1, 0], [0, 1], [1, 1]], [[0, 1, 2], [1, 2, 3]]), [0.1, 0.1])
    with pytest.raises(InputError, match="triangles in 2D"):
        Baker(delaunay([[0.0], [1.0]]))
    with pytest.raises(InputError, match="vertex 3 has a coordinate"):
        insert(delaunay([[0, 0], [2.0**500, 0], [0, 2.0**500]]), [2.0**-1040, 1.0])


def test_a_refused_point_leaves_the_rows_before_it():
    growing = Baker(delaunay([[0, 0], [4, 0], [0, 4]]))
    with pytest.raises(InputError, match=r"points\[2\]"):
        growing.insert([[1, 1], [1, 2], [3, 3]])
    assert len(growing.points) == 5
    growing.insert([[2, 2]])
    good(growing.mesh(), 8.0, delaunay=True)


def test_most_insertions_into_scrambled_meshes_need_reduction():
    """The theorem of the plane does not hold in space; each of these meshes passes `check` in the end."""
    count = count_reductions(150, seed=1)
    assert count["reduced"] >= 75 and count["vertices lost"] == 0


def test_in_the_plane_no_insertion_needs_reduction():
    rng = np.random.default_rng(2)
    for seed in range(10):
        mesh = random_triangulation(rng.random((60, 2)), seed)
        assert not check(mesh, delaunay=True), "a start that is not Delaunay"
        corners = mesh.points[mesh.simplices[rng.integers(mesh.size, size=20)]]
        growing = Baker(mesh)
        record = growing.insert((rng.dirichlet(np.ones(3), size=20)[:, :, None] * corners).sum(axis=1))
        assert not record.reduced.any()
        good(growing.mesh(), mesh.volume)


@pytest.mark.parametrize("d", [2, 3, 4])
def test_random_flips_keep_a_triangulation(d):
    mesh = delaunay(uniform(12 if d == 4 else 25, d))
    flipped = flip_at_random(mesh, 300, 1)
    assert check(flipped) and not check(flipped, delaunay=True)
    assert flipped.volume == pytest.approx(mesh.volume)
    old, new = two_triangulations(mesh.points, list(range(d + 2)))
    assert len(old) + len(new) == d + 2


def test_scrambled_is_seeded():
    first, second = (scrambled(30, np.random.default_rng(5)) for _ in range(2))
    assert np.array_equal(first.simplices, second.simplices)
