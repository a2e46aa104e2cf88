"""The classical front in space: signs, the plain one step by step, valid meshes of any body, names, rests."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from solids import cube, torus, twisted_star
from stuck_fronts import judged
from voxels import voxels

from unstruct import Domain, InputError, Mesh, UnstructError, advancing_front, check, delaunay, examples
from unstruct.generate.bodies.dividing import divided
from unstruct.generate.space_front.classical_open import new_space_front
from unstruct.generate.space_front.classical_rest import completed, front_of_cells, rests_of
from unstruct.generate.space_front.classical_run import (
    BODY_ORDERS,
    BODY_SEARCHES,
    BodyFaces,
    SpaceRun,
    body_faces,
    marched_in_space,
)
from unstruct.generate.space_front.classical_signs import cell_fault, meets_cell, set_cell
from unstruct.generate.space_front.classical_space import classical_in_space
from unstruct.plain import advancing_front_space as plain
from unstruct.sizing.field import as_size

ORDERS, FINDS = st.sampled_from(BODY_ORDERS), st.sampled_from(list(BODY_SEARCHES))
CORNERS = st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=8, max_size=12, unique=True)


def started(domain: Domain, size: float) -> BodyFaces:
    """The first front of a body that is divided by a size."""
    parts = divided(domain, as_size(size), True)
    return body_faces(domain if parts is None else parts.domain)


def hull(points: list[tuple[int, int, int]]) -> Domain:
    """The convex hull of points; further points stay loose."""
    try:
        faces = delaunay(np.array(points, dtype=float)).convex_hull
        return Domain(np.array(points, dtype=float), faces)
    except UnstructError:
        assume(False)
    raise AssertionError


# --- the signs ------------------------------------------------------------------------------------


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=7, max_size=7, unique=True), st.integers(0, 3))
def test_a_triangle_and_a_cell(points: list[tuple[int, int, int]], common: int) -> None:
    """Whether they have more in common than common corners span, on a lattice full of touches."""
    xyz = np.array(points, dtype=float) / 4
    other = (*range(common), *range(4, 7 - common))
    front = plain.front_of(points, [])
    cell = (0, 1, 2, 3) if not plain.is_behind_face(front, (0, 1, 2, 3)) else (1, 0, 2, 3)
    assume(not plain.is_behind_face(front, cell))
    u, v = xyz[other[1]] - xyz[other[0]], xyz[other[2]] - xyz[other[0]]
    assume(np.cross(u, v).any())
    expected = plain.is_overlapping(front, cell, other)
    assert meets_cell(xyz, np.array(cell, dtype=np.int64), *other) == expected


@settings(max_examples=5, deadline=None)
@given(CORNERS, st.integers(0, 10**6))
def test_faults_of_a_hull(points: list[tuple[int, int, int]], seed: int) -> None:
    """All cells on all faces of a hull with loose points and a segment: the plain tests say the same."""
    domain = hull(points)
    body = body_faces(domain)
    pairs = [tuple(sorted(p)) for p in combinations(body.needed.tolist(), 2)]
    threads = [pairs[seed % len(pairs)]] if pairs else []
    front = new_space_front(
        body.points / 4, body.faces, body.part, body.needed, np.array(threads).reshape(-1, 2)
    )
    told = plain.front_of(points, body.faces.tolist(), body.needed.tolist(), threads)
    for row, face in enumerate(plain.front_of(points, body.faces.tolist()).faces):
        for v in told.vertices() - set(face):
            set_cell(front, row, v)
            named = [name for name, fails in plain.SPACE_TESTS.items() if fails(told, (*face, v))]
            assert ["", "behind", "contains", "crosses"][cell_fault(front)] == (named or [""])[0]


# --- plain and fast -------------------------------------------------------------------------------


def told_and_made(body: BodyFaces, size: float, order: str) -> tuple[list[plain.Choice], SpaceRun]:
    """The plain and the fast front."""
    key = {"oldest": plain.by_age, "smallest": plain.by_size}[order]
    steps = plain.advancing_front_in_space(
        body.points.tolist(), body.faces.tolist(), lambda x: size, loose=body.needed.tolist(),
        threads=[(a, b) for a, b in body.threads.tolist()], key=key,
    )  # fmt: skip
    return list(steps), marched_in_space(body, as_size(size), order=order, history=True)


def same(steps: list[plain.Choice], run: SpaceRun) -> None:
    """Same faces, candidates and choices, bit for bit."""
    assert [(*step.face, step.chosen) for step in steps] == [tuple(row) for row in run.cells[:, :4].tolist()]
    assert run.steps is not None
    start = run.steps["start"]
    for i, step in enumerate(steps):
        tried = run.steps["vertex"][start[i] : start[i + 1]].tolist()
        assert tried == [-1 if one.vertex is None else one.vertex for one in step.candidates]
        assert run.steps["reason"][i] == step.reason
    if steps:
        left = {plain.lowest(*row) for row in run.left.tolist()}
        assert left == set(steps[-1].front)


@settings(max_examples=4, deadline=None)
@given(CORNERS, st.sampled_from(["oldest", "smallest"]), st.sampled_from([1.0, 2.0, 9.0]))
def test_the_plain_front_step_by_step(points: list[tuple[int, int, int]], order: str, size: float) -> None:
    same(*told_and_made(body_faces(hull(points)), size, order))


@pytest.mark.parametrize("name", ["twisted prism", "convex", "general", "ten faces"])
def test_the_plain_front_of_stuck_bodies(name: str) -> None:
    steps, run = told_and_made(
        body_faces(examples.stuck_body(name)), 20.0 if name[0] == "t" else 2.0, "smallest"
    )
    same(steps, run)


def test_the_plain_front_of_a_divided_box() -> None:
    same(*told_and_made(started(Domain.box([0, 0, 0], [1, 1, 1]), 0.5), 0.5, "oldest"))


# --- any body -------------------------------------------------------------------------------------


def whole(domain: Domain, size: Any, **options: Any) -> Mesh:
    """A mesh that passes the check."""
    mesh = classical_in_space(domain, size, finish=False, **options)
    report = check(mesh, domain=domain)
    assert report, report
    return mesh


@settings(max_examples=15, deadline=None)
@given(CORNERS, ORDERS, FINDS, st.sampled_from([0.7, 1.5, 9.0]), st.sampled_from([None, True, False]))
def test_hulls_with_loose_points(
    points: list[tuple[int, int, int]], order: str, search: str, size: float, split: bool | None
) -> None:
    """All points, on the faces of the hull or loose within, are vertices of the mesh."""
    mesh = whole(hull(points), size, order=order, search=search, split_boundary=split)
    assert set(mesh.origin.tolist()) >= set(range(len(points)))


@settings(max_examples=12, deadline=None)
@given(st.sets(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=9), st.sampled_from([0.5, 3.0]))
def test_voxels(cells: set[tuple[int, int, int]], size: float) -> None:
    """Bodies that touch themselves in edges and corners, with cavities."""
    points, faces = voxels(cells)
    try:
        domain = Domain(points, faces)
    except UnstructError:
        assume(False)
    whole(domain, size)


@pytest.mark.parametrize("seed", range(4))
def test_solids(seed: int) -> None:
    """Needles, holes, twists: the front sticks in some, and the rest is filled."""
    bodies = [torus(5 + seed, 4 + seed % 3), twisted_star(8, 2, 0.1 * seed + 0.1), cube(3, seed)]
    counts = [whole(Domain(*body), 0.7).counts for body in bodies]
    assert all(one["by recovery"] == 0 for one in counts)
    assert seed or sum(one["stuck rests"] for one in counts) > 0


def test_graded_shells() -> None:
    """A ball in a box, with a size that grows; names of facets and regions."""
    ball, box = Domain.ball(radius=0.4), Domain.box([-1, -1, -1], [1, 1, 1])
    domain = box.with_holes(ball)
    mesh = classical_in_space(domain, lambda x: 0.15 + 0.3 * np.abs(x).max(axis=1), search="ideal")
    assert check(mesh, domain=domain)
    assert mesh.figures["minimum dihedral after"] > 15
    assert np.isclose(mesh.volume, domain.volume)


def wall() -> Domain:
    """A box with a wall across, another one that ends inside, a segment and a loose point."""
    x = [[i, j, k] for i in (0, 1, 2) for j in (0, 1) for k in (0, 1)]
    facets = [
        [0, 1, 3, 2], [8, 9, 11, 10], [0, 1, 5, 4], [4, 5, 9, 8], [2, 3, 7, 6], [6, 7, 11, 10],
        [0, 2, 6, 4], [4, 6, 10, 8], [1, 3, 7, 5], [5, 7, 11, 9],
    ]  # fmt: skip
    x += [
        [1.5, 0.5, 0.2],
        [1.5, 0.5, 0.8],
        [1.7, 0.5, 0.5],
        [0.3, 0.3, 0.3],
        [0.6, 0.7, 0.6],
        [0.5, 0.2, 0.7],
    ]
    return Domain(
        np.array(x, dtype=float), facets, inner=[[4, 5, 7, 6], [12, 13, 14], [15, 16]],
        markers={"inlet": [0], "wall": [10], "sheet": [11], "wire": [12]},
        regions={"left": [[0.2, 0.5, 0.5]], "right": [[1.2, 0.5, 0.5]]},
    )  # fmt: skip


@pytest.mark.parametrize("size", [0.3, 3.0, {"left": 0.2, "right": 0.4}])
def test_walls_and_names(size: Any) -> None:
    """Inner facets are meshed on both sides, segments are edges, loose points are vertices, names stay."""
    domain = wall()
    mesh = whole(domain, size)
    x = mesh.points[mesh.simplices].mean(axis=1)[:, 0]
    assert (mesh.markers["region"] == (x > 1)).all() and mesh.regions == {"left": 0, "right": 1}
    assert set(mesh.origin.tolist()) >= set(range(18))
    assert len(mesh.markers["wire"]) and len(mesh.markers["sheet"]) and len(mesh.markers["inlet"])
    assert (mesh.points[mesh.markers["wall"]][:, :, 0] == 1).all()
    better = classical_in_space(domain, size)
    assert check(better, domain=domain)
    assert better.figures["minimum 3r/R after"] >= better.figures["minimum 3r/R before"]


# --- stuck fronts ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "size", "left"),
    [("twisted prism", 20, 8), ("convex", 2, 8), ("general", 2, 8), ("ten faces", 2, 10)],
)
def test_stuck(name: str, size: float, left: int) -> None:
    """One point inside of the rest; what was made before stays."""
    domain = examples.stuck_body(name)
    mesh = whole(domain, size)
    assert mesh.counts["stuck faces"] == left == mesh.counts["filled"] and mesh.counts["stuck rests"] == 1
    assert mesh.counts["added inside"] == 1 and mesh.counts["taken back"] == 0
    assert whole(domain, size, search="ideal").counts["stuck rests"] == (name == "twisted prism")


def test_the_front_of_any_cells() -> None:
    """Cells are taken back in any order: the front is what one gets face by face."""
    body = started(Domain.box([0, 0, 0], [1, 1, 1]), 0.5)
    run = marched_in_space(body, as_size(0.5))
    rng, cells = np.random.default_rng(0), run.cells.astype(np.int64)
    for share in (0.0, 0.3, 0.7, 1.0):
        some = cells[rng.random(len(cells)) < share]
        faces = {plain.lowest(*row) for row in body.faces.tolist()}
        for cell in some[:, :4].tolist():
            for a, b, c in plain.faces_of(tuple(cell)):
                faces.symmetric_difference_update(
                    {(a, b, c) if (a, b, c) in faces else plain.lowest(a, c, b)}
                )
        found, part = front_of_cells(body, some)
        assert {tuple(row) for row in found.tolist()} == faces and (part == body.part[0]).all()


def test_cells_are_taken_back() -> None:
    """All cells but some are made: the rest is filled, and with all of its neighbors if it must be."""
    domain = wall()
    body = body_faces(domain)
    run = marched_in_space(body, as_size(3.0), search="ideal")
    some = run.cells[::2].astype(np.int64)
    left, part = front_of_cells(body, some)
    again = completed(body, run._replace(cells=run.cells[::2], left=left, part=part))
    assert again.whole and len(rests_of(run.points, left, part, body, some)) >= 1
    used = np.unique(again.cells[:, :4])
    mesh = Mesh(again.points[used], np.searchsorted(used, again.cells[:, :4]))
    assert np.isclose(mesh.volume, domain.volume) and check(mesh)


def test_counts_of_many() -> None:
    sums, kinds = judged(Domain(*torus(5, 4)), 0.6)
    assert sums["stuck bodies"] == 1 and sum(kinds.values()) == sums["stuck rests"]


# --- the record and the arguments -----------------------------------------------------------------


def test_the_record() -> None:
    mesh = whole(Domain.box([0, 0, 0], [1, 1, 1]), 0.3, history=True)
    steps = mesh.steps
    assert steps is not None
    k = len(steps["apex"])
    assert (np.column_stack([steps["face"], steps["apex"]]) == mesh.simplices[:k]).all()
    last = steps["start"][1:] - 1
    assert (steps["verdict"][last] == "valid").all() and len(steps["start"]) == k + 1
    new = steps["reason"] == "new point"
    assert (steps["vertex"][last][new] == -1).all()
    assert (steps["vertex"][last][~new] == steps["apex"][~new]).all()
    assert (mesh.points[steps["apex"][new]] == steps["ideal"][new]).all()
    near = steps["reason"] != "all vertices"
    assert np.allclose(steps["size"][near], 0.3)


def test_a_budget() -> None:
    """Without points left the mesh is completed with the vertices that there are, and says so."""
    mesh = whole(Domain.box([0, 0, 0], [1, 1, 1]), 0.3, budget=5)
    assert mesh.counts["new point"] == 5 and not mesh.complete and set(mesh.reasons) == {"budget"}


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"order": "widest"}, "widest"), ({"search": "far"}, "far"),
        ({"budget": -1}, "budget"), ({"split_boundary": "inner"}, "split_boundary"),
    ],
)  # fmt: skip
def test_arguments(options: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError, match=text):
        classical_in_space(Domain.box([0, 0, 0], [1, 1, 1]), 0.5, **options)


def test_arguments_of_the_domain() -> None:
    with pytest.raises(InputError, match="space"):
        classical_in_space(Domain.rectangle(), 0.5)
    with pytest.raises(InputError, match="positive"):
        classical_in_space(Domain.box([0, 0, 0], [1, 1, 1]), -1.0)


@pytest.mark.parametrize("method", ["classical", "delaunay"])
@pytest.mark.parametrize("finish", [True, False])
def test_facets_that_stay_are_told_where_they_are_coarse(method: str, finish: bool) -> None:
    """Edges of seven times a constant size were said to be complete by the classical method."""
    mesh = advancing_front(Domain.box(), 0.2, method=method, split_boundary=False, finish=finish)
    assert not mesh.complete and check(mesh) and len(mesh.unrefined) == mesh.size
    assert all("split_boundary=True" in reason for reason in mesh.reasons)
