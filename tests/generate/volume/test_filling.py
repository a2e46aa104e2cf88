"""constrained_delaunay in space: facets are faces, parts have their names, what is missing is said."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solids import saddle_lines, six_points, twisted_star

from unstruct import (
    Domain,
    DomainMesh,
    InputError,
    UnstructError,
    check,
    conforming_delaunay,
    constrained_delaunay,
    delaunay,
)
from unstruct.geometry import simplex
from unstruct.predicates import orient
from unstruct.studies import replay_recovery

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def filled(domain: Domain) -> DomainMesh:
    mesh = constrained_delaunay(domain)
    report = check(mesh, domain=domain)
    assert report, report
    return mesh


def cubes(*boxes: tuple[float, float]) -> Domain:
    """Cubes from (low, low, low) to (high, high, high)."""
    points = np.concatenate([low + (high - low) * CORNERS for low, high in boxes])
    return Domain(points, [[8 * i + v for v in side] for i in range(len(boxes)) for side in SIDES])


def twisted(turn: float) -> Domain:
    """Schoenhardt's polyhedron: a prism on a triangle whose top is turned, its sides bent inward."""
    angle = np.radians([0, 120, 240])
    rings = [
        np.column_stack([np.cos(a), np.sin(a), np.full(3, z)]) for a, z in ((angle, 0), (angle + turn, 1))
    ]
    sides = [row for k in range(3) for n in [(k + 1) % 3] for row in [(k, n, 3 + k), (n, 3 + n, 3 + k)]]
    return Domain(np.vstack(rings), [(0, 2, 1), (3, 4, 5), *sides])


def test_a_cube_and_what_is_in_it() -> None:
    assert len(filled(cubes((0.0, 1.0))).simplices) in (5, 6)
    hollow = cubes((0.0, 4.0), (1.0, 3.0), (1.5, 2.0))
    mesh = filled(hollow)
    assert np.unique(mesh.markers["region"]).tolist() == [0, 1]
    assert mesh.steiner.size == 0 and mesh.complete


def test_a_polyhedron_without_tetrahedra() -> None:
    domain = twisted(-np.pi / 6)
    mesh = filled(domain)
    assert mesh.counts["added inside"] == 1 and mesh.steiner.size == 0
    assert len(mesh.points) == 7 and mesh.origin.tolist().count(-1) == 1
    assert len(filled(twisted(np.pi / 6)).points) == 6  # bent outward, it has tetrahedra


def test_six_integer_points() -> None:
    points, faces = six_points()
    mesh = filled(Domain(points, faces))
    assert len(mesh.points) > 6 and mesh.complete


def test_names_and_regions() -> None:
    points = np.vstack([CORNERS * [1, 1, 2], [(x, y, 1.0) for x in (0, 1) for y in (0, 1)]])
    facets = [
        (0, 8, 1, 3, 9, 2),
        (4, 6, 11, 7, 5, 10),
        (0, 4, 10, 5, 1, 8),
        (2, 9, 3, 7, 11, 6),
        (0, 2, 6, 4),
    ]
    domain = Domain(
        points,
        [*facets, (1, 5, 7, 3)],
        inner=[(8, 9, 11, 10)],
        markers={"top": [5], "between": [6], "low and between": [4, 6]},
        regions={"high": (0.5, 0.25, 1.5)},
    )
    mesh = filled(domain)
    assert sorted(np.unique(mesh.markers["region"]).tolist()) == [0, 1] and mesh.regions == {"high": 0}
    high = mesh.points[mesh.simplices].mean(axis=1)[:, 2] > 1
    assert (mesh.markers["region"][high] == 0).all() and (mesh.markers["region"][~high] == 1).all()
    assert len(mesh.markers["between"]) == 2 == len(mesh.markers["inner"])
    with pytest.raises(InputError, match="same part"):
        constrained_delaunay(Domain(CORNERS, SIDES, regions={"a": (0.5, 0.3, 0.5), "b": (0.5, 0.6, 0.5)}))


def test_inner_segments_and_loose_points() -> None:
    points = np.vstack([CORNERS, [(0.5, 0.5, 0.5), (0.25, 0.5, 0.75), (5.0, 5.0, 5.0)]])
    mesh = filled(Domain(points, SIDES, inner=[(8, 9)], markers={"axis": [6]}))
    assert 10 not in mesh.origin  # outside
    assert mesh.origin[mesh.markers["axis"]].tolist() == [[8, 9]]
    assert mesh.piece.tolist() == [6] and mesh.span.tolist() == [[0.0, 1.0]]


def test_bodies_that_touch() -> None:
    for offset in ((1, 1, 0), (1, 1, 1), (2, 0, 0)):
        both = np.vstack([CORNERS, CORNERS + offset])
        points, number = np.unique(both, axis=0, return_inverse=True)
        rows = number.reshape(2, 8)
        domain = Domain(points, [row[list(side)].tolist() for row in rows for side in SIDES])
        assert np.unique(filled(domain).markers["region"]).tolist() == [0, 1]


@settings(deadline=None, max_examples=25)
@given(
    st.lists(st.tuples(*[st.integers(0, 5)] * 3), min_size=5, max_size=14, unique=True), st.integers(0, 2**32)
)
def test_parts_of_triangulations_of_lattice_points(points: list, choice: int) -> None:
    """Cells of a Delaunay triangulation, chosen by chance: what they bound has tetrahedra."""
    rows = np.array(points, dtype=float)
    if np.linalg.matrix_rank(rows - rows[0]) < 3:
        return
    cells = delaunay(rows)
    kept = np.flatnonzero([(choice >> (i % 32)) & 1 for i in range(cells.size)])
    if len(kept) == 0:
        return
    border = np.asarray(cells.select(kept).boundary)
    used = np.asarray(cells.select(kept).origin)
    domain = Domain(rows, used[border])
    mesh = filled(domain)
    x = rows[cells.simplices[kept]]
    whole = np.abs(np.linalg.det(x[:, 1:] - x[:, :1])).sum() / 6
    assert mesh.complete and np.isclose(domain.volume, whole)


@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
def test_scales(scale: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = filled(Domain(CORNERS * scale, SIDES))
    assert mesh.complete


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="no facets"):
        constrained_delaunay(Domain(CORNERS, []))
    with pytest.raises(InputError, match="hull"):
        constrained_delaunay(Domain(CORNERS, SIDES), hull=True)
    with pytest.raises(UnstructError, match="planar"):
        conforming_delaunay(Domain(CORNERS, SIDES), 0.1)


def test_the_same_input_gives_the_same_mesh() -> None:
    one, two = (constrained_delaunay(twisted(-np.pi / 6)) for _ in range(2))
    assert np.array_equal(one.points, two.points) and np.array_equal(one.simplices, two.simplices)


def notched() -> Domain:
    """A prism on a star whose sides are turned: it needs points, which are moved off the surface again."""
    points, triangles = twisted_star(6, 3, 0.6)
    return Domain(points, triangles)


@pytest.mark.parametrize("make", [lambda: twisted(-np.pi / 6), notched, lambda: Domain(*six_points())])
def test_the_record_is_replayed_to_the_identical_mesh(make: Callable[[], Domain]) -> None:
    domain = make()
    mesh, plain = constrained_delaunay(domain, history=True), constrained_delaunay(domain)
    assert np.array_equal(mesh.points, plain.points) and np.array_equal(mesh.simplices, plain.simplices)
    steps = mesh.steps
    assert plain.steps is None and steps is not None
    place = np.full(len(steps["points"]), -1)
    place[steps["vertex"]] = np.arange(len(mesh.points))
    assert np.array_equal(steps["points"][steps["vertex"]], mesh.points)
    assert np.array_equal(place[replay_recovery(steps)[steps["inside"]]], mesh.simplices)
    box = replay_recovery(steps, 0)
    volume = simplex.volume(steps["points"][box]).sum()
    for k in range(1, len(steps["kind"]) + 1):  # each state fills the box
        cells = replay_recovery(steps, k)
        cells = cells[cells[:, 0] >= 0]
        assert (orient(steps["points"][cells]) > 0).all()
        assert np.isclose(simplex.volume(steps["points"][cells]).sum(), volume)
        if steps["kind"][k - 1] == "found":
            goal = set(steps["goal"][k - 1].tolist()) - {-1}
            assert any(goal <= set(cell) for cell in cells.tolist())
    assert {"refill", "found"} <= set(steps["kind"])
    goals = steps["goal"]
    for k in range(
        1, len(goals)
    ):  # a refill that follows another one for the same segment has fewer in its way
        if goals[k, 2] < 0 and steps["kind"][k - 1] == "refill" and (goals[k] == goals[k - 1]).all():
            assert steps["faces"][k] < steps["faces"][k - 1]


def test_no_record_in_the_plane() -> None:
    with pytest.raises(InputError, match="in space"):
        constrained_delaunay(Domain.polygon([(0, 0), (1, 0), (0, 1)]), history=True)
    with pytest.raises(InputError, match="no record"):
        replay_recovery({})


@pytest.mark.parametrize(("n", "gap"), [(3, 0.0625), (4, 0.25), (5, 0.25)])
def test_a_box_with_lines_of_a_saddle(n: int, gap: float) -> None:
    """Inner segments are there in parts, in either direction, and no part is missing between its points."""
    points, lines = saddle_lines(n, gap)
    box = Domain.box(points.min(axis=0) - 1, points.max(axis=0) + 1)
    lines[::2] = lines[::2, ::-1]
    domain = Domain(np.concatenate([box.points, points]), list(box.facets), inner=(lines + 8).tolist())
    mesh = filled(domain)
    on_lines = np.setdiff1d(mesh.segments, np.flatnonzero(mesh.origin >= 0))
    assert mesh.counts["added on pieces"] > 0 and np.array_equal(on_lines, mesh.steiner)
    assert len(mesh.segments) == len(lines) + len(mesh.steiner)
    assert (mesh.span[:, 0] < mesh.span[:, 1]).all()
