"""Bodies simplified: facets in one plane are polygons, nothing else changes, and all can be meshed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT, halves
from tests.generate.stuffing.test_flat_parts import CORNERS, TRIANGLES, TURN, grid_cube
from tests.helpers.voxels import voxels
from unstruct import Domain, InputError, check, constrained_delaunay, tetrahedralize


def sides_of_voxels(cells: set[tuple[int, int, int]]) -> int:
    """How many sides there are, by a search: squares in one plane and direction that share an edge."""
    faces = {
        (cell, axis, end)
        for cell in cells
        for axis in range(3)
        for end in (0, 1)
        if tuple(c + (2 * end - 1) * (a == axis) for a, c in enumerate(cell)) not in cells
    }
    count = 0
    while faces:
        stack, count = [faces.pop()], count + 1
        while stack:
            cell, axis, end = stack.pop()
            for a in range(3):
                for step in (-1, 1):
                    beside = tuple(c + step * (k == a) for k, c in enumerate(cell))
                    if a != axis and (beside, axis, end) in faces:
                        faces.discard((beside, axis, end))
                        stack.append((beside, axis, end))
    return count


@settings(max_examples=25, deadline=None)
@given(st.sets(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=12), st.booleans())
def test_voxels(cells: set[tuple[int, int, int]], turn: bool) -> None:
    points, rows = voxels(cells)
    body = Domain(points @ TURN.T if turn else points, rows)
    new = body.simplified()
    assert new.volume == pytest.approx(len(cells), rel=1e-14)
    assert np.array_equal(new.points, body.points[new.origin])
    covered = {tuple(row) for row in np.asarray(body.facets)[new.piece_origin].tolist()}
    assert len(covered) == len(new.facets)
    if not turn:
        wanted = sides_of_voxels(cells)
        assert len(new.facets) >= wanted
        bare = max(len(ring) for i in range(len(new.facets)) for ring in new.pieces.rings(i)) >= 4
        assert bare
        if len(new.facets) > wanted:  # sides that touch themselves in a vertex stay triangles
            assert any(len(new.pieces.rings(i)[0]) == 3 for i in range(len(new.facets)))
    mesh = constrained_delaunay(new)
    assert not mesh.complete or check(mesh, domain=new)


@pytest.mark.parametrize("n", [1, 8])
@pytest.mark.parametrize("unit", [1e-200, 1.0, 1e200])
def test_a_cube_of_many_triangles_has_six_sides(n: int, unit: float) -> None:
    points, rows = grid_cube(n)
    body = Domain(points @ TURN.T * unit, rows)
    new = body.simplified()
    assert (len(new.points), len(new.facets)) == (8, 6)
    assert [repair.kind for repair in new.repairs] == ["joined facets"]
    assert new.simplified().repairs == new.repairs
    if unit == 1.0:
        assert new.volume == pytest.approx(8.0, rel=1e-14)
        mesh = tetrahedralize(new, 0.7)
        assert mesh.complete
        assert check(mesh, domain=new)


def test_single_precision_needs_a_tolerance() -> None:
    points, rows = grid_cube(3)
    points = (points @ TURN.T).astype(np.float32).astype(float)
    body = Domain(points, rows)
    assert len(body.simplified().facets) > 6
    new = body.simplified(1e-6)
    assert (len(new.points), len(new.facets)) == (8, 6)
    assert check(tetrahedralize(new, 1.0), domain=new)


def test_holes_of_sides_are_rings() -> None:
    square, hole = [(0, 0), (3, 0), (3, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)]
    body = Domain.extruded(Domain.polygon(square, holes=[hole]), 1.0, size=0.7)
    shell = body.triangulated
    new = Domain(body.points, shell.bounding).simplified()
    assert len(new.facets) == 10
    assert sorted(len(new.pieces.rings(i)) for i in range(10)) == [1] * 8 + [2] * 2
    mesh = tetrahedralize(new, 0.6)
    assert check(mesh, domain=new)


def test_names_inner_pieces_and_loose_points_stay() -> None:
    named = Domain(CORNERS, TRIANGLES, markers={"half": [0], "all": range(12)})
    new = named.simplified()
    assert len(new.facets) == 7
    assert new.markers["half"].tolist() == [0]
    assert len(new.markers["all"]) == 7
    wall = halves()
    shell = wall.triangulated
    pieces = shell.piece
    body = Domain(
        np.concatenate([wall.points, [[0.2, 0.3, 0.4]]]),
        shell.bounding,
        inner=shell.triangles[pieces >= len(wall.facets)],
        regions=wall.regions,
    )
    new = body.simplified()
    assert len(new.inner) == 2  # inner facets are not joined
    assert len(new.facets) == 10  # nothing is joined over the edges of the wall
    assert len(new.loose) == 1
    mesh = tetrahedralize(new, 0.3)
    assert check(mesh, domain=new)


def test_an_inner_segment_that_ends_within_a_side() -> None:
    points, rows = grid_cube(2)
    middle = int(np.flatnonzero((points == [1, 0, 0]).all(axis=1))[0])
    body = Domain(np.concatenate([points, [[0, 0, 0]]]), rows, inner=[[middle, len(points)]])
    new = body.simplified()
    assert len(new.facets) == 5 + 8
    assert check(constrained_delaunay(new), domain=new)


def test_steps_lower_than_the_tolerance_are_no_fault() -> None:
    """What crosses itself when it is joined stays as it is."""
    step = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 1.01), (0, 1.01)]
    body = Domain.extruded(Domain.polygon(step), 1.0)
    new = body.simplified(0.05)
    assert new.volume == pytest.approx(body.volume, rel=0.02)
    assert check(constrained_delaunay(new), domain=new)


def test_polygons_and_smooth_surfaces() -> None:
    box = Domain(UNIT, SIDES)
    assert len(box.simplified().facets) == 6
    assert box.simplified().repairs == []
    ball = Domain.ball(size=0.5)
    assert len(ball.simplified().facets) == len(ball.facets)


def test_refusals() -> None:
    body = Domain(UNIT, SIDES)
    with pytest.raises(InputError, match="a size is for planar regions"):
        body.simplified(size=0.1)
    for wrong in (-1.0, np.nan, "a"):
        with pytest.raises(InputError, match="tolerance"):
            body.simplified(wrong)
