"""Insertion beside fixed cells: what the point may use, when it is refused, and what stays."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import InputError, Mesh, MeshError, check, delaunay, insert
from unstruct.connect.baker.fixed import as_cells, boundary_facets, cavities, held_by, hidden_facets
from unstruct.examples.running import random_triangulation
from unstruct.plain import modernized as plain
from unstruct.studies import Baker

STRIP_POINTS = np.array([(0, 1), (0, 2), (1, 0), (1, 2), (2, 0)], float)
STRIP = Mesh(STRIP_POINTS, [(0, 1, 2), (1, 2, 3), (2, 3, 4)]).oriented()
BELOW = Mesh(np.array([(0, 0), (4, 0), (2, -3), (2, 3)], float), [(0, 2, 1), (0, 1, 3)])


def rows(mesh):
    return {frozenset(row) for row in mesh.simplices.tolist()}


def test_the_sets_of_the_ledger():
    sets = cavities(STRIP, (1.6, 0.5))
    assert sets.gamma.tolist() == [0, 2] and sets.gamma_component.tolist() == [2]
    sets = cavities(STRIP, (1.6, 0.5), fixed=[0])
    assert sets.upsilon.tolist() == [2] and len(sets.refused_by) == 0
    sets = cavities(STRIP, (1.6, 0.5), fixed=[2])
    assert (
        sets.upsilon.tolist() == [0] and len(sets.upsilon_component) == 0 and sets.refused_by.tolist() == [2]
    )


@given(st.integers(0, 10**6), st.integers(4, 12), st.floats(0, 0.7))
@settings(max_examples=80, deadline=None)
def test_planar_cavities_against_the_plain_sets(seed, n, share):
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    mesh = random_triangulation(points, rng)
    fixed = rng.random(mesh.size) < share
    p = rng.dirichlet(np.ones(3)) @ mesh.corners[rng.integers(mesh.size)]
    sets = cavities(mesh, p, fixed=fixed)
    exact, cells = (
        [*map(tuple, points.tolist()), tuple(p.tolist())],
        [tuple(c) for c in mesh.simplices.tolist()],
    )
    gamma = plain.generalized_cavity(exact, cells, n)
    holders = {c for c in cells if plain.holds(exact, c, n)}
    assert {cells[c] for c in sets.gamma} == gamma
    assert {cells[c] for c in sets.gamma_component} == plain.principal_component(gamma, holders)
    if not len(sets.refused_by):
        free = gamma - {c for c, f in zip(cells, fixed) if f}
        assert {cells[c] for c in sets.upsilon_component} == plain.principal_component(free, holders)
        for cells_ in (sets.gamma_component, sets.upsilon_component):
            assert len(hidden_facets(mesh, cells_, p)) == 0, "all of it is visible, in the plane"
            assert len(boundary_facets(mesh, cells_)) == len(cells_) + 2, "a tree: no vertex within"


@given(st.integers(0, 10**6), st.sampled_from([2, 3]))
@settings(max_examples=40, deadline=None)
def test_fixed_cells_stay_and_the_rest_is_valid(seed, d):
    rng = np.random.default_rng(seed)
    mesh = delaunay(rng.random((25, d)))
    fixed = rng.random(mesh.size) < 0.3
    mesh = Mesh(mesh.points, mesh.simplices, markers={"frozen": fixed.astype(int)})
    points = rng.dirichlet(np.ones(d + 1), 60)[:, :, None] * mesh.corners[rng.integers(mesh.size, size=60)]
    points = points.sum(axis=1)
    held = held_by(mesh, points, "frozen")
    result = insert(mesh, points[held < 0], fixed="frozen")
    report = check(result)
    assert report, str(report)
    assert {frozenset(c) for c in mesh.simplices[fixed].tolist()} <= rows(result)
    assert result.markers["frozen"].sum() == fixed.sum(), "new cells do not inherit it"
    assert result.volume == pytest.approx(mesh.volume)
    for p in points[held >= 0][:3]:
        with pytest.raises(MeshError, match="fixed cell"):
            insert(mesh, p, fixed=fixed)


@pytest.mark.parametrize(
    ("point", "refused"), [((2, -1), True), ((2, 0), True), ((1, 0), True), ((2, 1), False)]
)
def test_closed_fixed_cells_refuse(point, refused):
    point = np.array(point, float)
    assert (held_by(BELOW, [point], [0])[0] >= 0) == refused
    assert (len(cavities(BELOW, point, fixed=[0]).refused_by) > 0) == refused
    if refused:
        with pytest.raises(MeshError, match="refused"):
            insert(BELOW, point, fixed=[0])
    else:
        assert check(insert(BELOW, point, fixed=[0]))


def test_a_copy_of_a_vertex_of_a_fixed_cell_is_a_duplicate():
    result = insert(BELOW, (2, -3), fixed=[0])
    assert result.duplicates.tolist() == [[4, 2]] and rows(result) == rows(BELOW)


def test_a_point_on_an_edge_far_round_in_space_is_refused_by_a_fixed_cell_across_it():
    points = np.array([(0, 0, -1), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], float)
    mesh = Mesh(points, [(0, 1, 2, 3), (0, 1, 3, 4), (0, 1, 4, 5), (0, 1, 5, 2)]).oriented()
    for c in range(4):
        with pytest.raises(MeshError, match="refused"):
            insert(mesh, (0, 0, 0.25), fixed=[c])
    assert check(insert(mesh, (0, 0, 0.25)))


def test_beside_a_fixed_triangle_delaunay_is_lost():
    result = insert(BELOW, (2, 1), fixed=[0])
    assert frozenset((0, 1, 2)) in rows(result) and frozenset((0, 1, 4)) in rows(result)
    assert not check(result, delaunay=True)
    kept = Mesh(result.points, result.simplices, markers={"edge": [[0, 1]]})
    assert check(kept, delaunay="constrained")


def test_refused_rows_leave_what_came_before():
    growing = Baker(BELOW, fixed=[0])
    with pytest.raises(MeshError, match=r"points\[1\]"):
        growing.insert([(2, 1), (2, -1), (1, 1)])
    assert len(growing.points) == 5
    growing.insert([(1, 0.5)])
    assert check(growing.mesh())


def test_many_insertions_keep_fixed_cells_while_arrays_grow():
    rng = np.random.default_rng(1)
    mesh = delaunay(rng.random((10, 2)))
    fixed = [0, mesh.size - 1]
    points = rng.random((3000, 2))
    points = points[mesh.find_simplex(points) >= 0]
    points = points[held_by(mesh, points, fixed) < 0]
    result = insert(mesh, points, fixed=fixed)
    assert {frozenset(c) for c in mesh.simplices[fixed].tolist()} <= rows(result)
    assert check(result)


@pytest.mark.parametrize("bad", ["name", [True], [7], [-1], [[0]], [0.5]])
def test_bad_choices(bad):
    with pytest.raises(InputError):
        as_cells(BELOW, bad)


def test_outside_has_no_cavity():
    with pytest.raises(InputError, match="outside"):
        cavities(BELOW, (9, 9))
