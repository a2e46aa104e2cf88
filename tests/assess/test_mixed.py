"""`check` for cells of all kinds: valid meshes pass, and every defect is found with its culprits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_cells import GOOD, cloud, planar, spatial

from unstruct import Domain, Mesh, MeshError, Report, check
from unstruct.mesh.split import simplices_of_cells
from unstruct.predicates.batch import orient_rows

BOX = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]


def kinds(report: Report) -> set[str]:
    return {problem.kind for problem in report.problems}


def culprits(report: Report, kind: str) -> tuple[tuple[int, ...], tuple[int, ...]]:
    found = next(p for p in report.problems if p.kind == kind)
    return found.cells, found.vertices


VALID = {
    "flat": planar(4),
    "bent": planar(5, jitter=0.15, seed=1),
    **{f"solid {seed}": spatial(2, seed=seed) for seed in range(2)},
    "bent solid": spatial(3, jitter=0.1),
}


@pytest.mark.parametrize("name", VALID)
def test_valid_meshes(name: str) -> None:
    mesh = VALID[name]
    report = check(mesh, brute=False)
    assert report, report
    assert not report.skipped
    assert any("Euler characteristic: 1" in name for name in report.passed)
    assert mesh.size > 60 or check(mesh, brute=True)
    some = mesh.select(np.random.default_rng(0).random(mesh.size) < 0.6)
    assert kinds(check(some, brute=False)) <= {"pinched vertex", "pinched edge", "link"}
    assert "the Delaunay property, which needs simplices" in check(mesh, delaunay=True, brute=False).skipped


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 3), st.booleans(), st.data())
def test_a_vertex_moved_too_far_is_found(seed: int, solid: bool, data: st.DataObject) -> None:
    """Valid exactly when every Jacobian is positive: the boundary stays, and an inner vertex moves."""
    mesh = spatial(2, seed=seed) if solid else planar(4, seed=seed)
    points = np.array(mesh.points)
    high = points.max()
    inner = np.nonzero(((points > 0) & (points < high)).all(axis=1))[0]
    v = data.draw(st.sampled_from(inner.tolist()))
    move = data.draw(st.lists(st.integers(-6, 6), min_size=points.shape[1], max_size=points.shape[1]))
    points[v] += np.array(move) / (1 if solid else 3)
    moved = Mesh(points, cells=mesh.cells)
    report = check(moved, brute=False)
    good = (moved.jacobian_signs() == 1).all()
    assert bool(report) == good, report
    if not good:
        blamed = {t for p in report.problems if p.kind == "negative cell" for t in p.cells}
        assert blamed == set(np.nonzero(moved.jacobian_signs() != 1)[0].tolist())


def test_arrays_that_were_written_to() -> None:
    mesh = spatial(2)
    bad = Mesh(mesh.points, cells={kind: np.array(block) for kind, block in mesh.cells.items()})
    kind = next(iter(bad.cells))
    rows = np.array(bad.cells[kind])
    rows[0, 0], rows[1, 0] = 10**6, rows[1, 1]
    bad.cells[kind] = rows
    report = check(bad)
    assert culprits(report, "index")[0] == (0,) and culprits(report, "repeated vertex")[0] == (1,)
    assert kinds(check(mesh.select([]))) == {"empty"}


def test_vertices() -> None:
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [1, 1], [3, 3]]
    mesh = Mesh(points, cells={"quad": [[0, 1, 2, 3]]}, duplicates=[[4, 2]])
    report = check(mesh)
    assert kinds(report) == {"unused vertex"} and culprits(report, "unused vertex")[1] == (5,)
    wrong = Mesh(points[:5], cells={"quad": [[0, 1, 2, 3]]}, duplicates=[[4, 1]])
    assert culprits(check(wrong), "duplicate")[1] == (4,)


def test_facets_of_three_cells() -> None:
    points = [*BOX, [0.5, 0.5, 2], [0.5, 0.5, 3]]
    mesh = Mesh(points, cells={"hexahedron": [range(8)], "pyramid": [[4, 5, 6, 7, 8], [4, 5, 6, 7, 9]]})
    report = check(mesh)
    assert culprits(report, "facet") == ((0, 1, 2), (4, 5, 6, 7)) and "valid adjacency" in report.skipped[-1]
    with pytest.raises(MeshError, match=r"\[4, 5, 6, 7\] is shared by 3 cells, \[0, 1, 2\]"):
        _ = mesh.facet_cells


def test_facets_seen_from_one_side_or_twisted() -> None:
    points = np.array([*BOX, [0.5, 0.5, 2.0]])
    folded = Mesh(points, cells={"hexahedron": [range(8)], "pyramid": [[7, 6, 5, 4, 8]]})
    report = check(folded)
    assert culprits(report, "orientation") == ((0, 1), (4, 5, 6, 7)) and culprits(report, "negative cell")[
        0
    ] == (1,)
    twisted = Mesh(points, cells={"hexahedron": [range(8)], "pyramid": [[4, 6, 5, 7, 8]]})
    assert culprits(check(twisted), "facet") == ((0, 1), (4, 5, 6, 7))


def test_pinched_vertices_and_edges() -> None:
    squares = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]], dtype=float)
    corner = Mesh(squares, cells={"quad": [[0, 1, 2, 3]], "polygon": [[2, 4, 5, 6]]})
    assert culprits(check(corner), "pinched vertex") == ((), (2,))
    x = np.array(BOX, dtype=float)
    along = np.vstack([x, x[[1, 2, 5, 6]] + [1, 0, 0], x[[2, 6]] + [0, 1, 0], x[[2, 6]] + [1, 1, 0]])
    second = [2, 9, 14, 12, 6, 11, 15, 13]
    used, rows = np.unique([list(range(8)), second], return_inverse=True)
    mesh = Mesh(along[used], cells={"hexahedron": rows.reshape(2, 8)})
    report = check(mesh)
    assert set(culprits(report, "pinched edge")[1]) >= {2, 6} or kinds(report) == {"pinched edge"}, report


def test_overlaps_in_space() -> None:
    """Every cell is positive; they lie in each other, or the whole is wound twice around an edge."""
    x = np.array(BOX, dtype=float)
    report = check(Mesh(np.vstack([x, x + 0.5]), cells={"hexahedron": np.arange(16).reshape(2, 8)}))
    assert kinds(report) == {"crossing", "overlap"} and culprits(report, "overlap")[0] == (0, 1)
    inside = np.vstack([4 * x, np.array(GOOD["wedge"]) / 4 + 1])
    within = Mesh(inside, cells={"hexahedron": [range(8)], "wedge": [range(8, 14)]})
    assert kinds(check(within)) == {"crossing", "overlap"}, "some facets of tetrahedra cross as well"
    report = check(within, brute=False)
    assert kinds(report) == {"overlap"} and culprits(report, "overlap")[0] == (0,)
    turns = 2 * np.pi * np.arange(12) * 2 / 12
    ring = np.column_stack([np.cos(turns), np.sin(turns)]) * (1 + 0.01 * np.arange(12))[:, None]
    low = np.column_stack([np.vstack([[0, 0], ring]), np.zeros(13)])
    i = np.arange(12)
    rows = np.column_stack([np.zeros(12, dtype=int), i + 1, (i + 1) % 12 + 1])
    book = Mesh(np.vstack([low, np.add(low, [0, 0, 1])]), cells={"wedge": np.hstack([rows, rows + 13])})
    assert (book.jacobian_signs() == 1).all()
    assert "overlap" in kinds(check(book))


def test_cells_that_cannot_be_cut_are_proved_all_the_same() -> None:
    """Hexahedra whose Jacobian is positive, though for some a tetrahedron of their cut is not."""
    rng = np.random.default_rng(0)
    x = np.array(GOOD["hexahedron"]) + 1.0 * rng.normal(size=(3000, 8, 3))
    x = x[cloud("hexahedron", x).jacobian_signs() == 1]
    meshes = [Mesh(p, cells={"hexahedron": [range(8)]}) for p in x[:80]]
    cut = [(orient_rows(mesh.points, simplices_of_cells(mesh.cells)[0]) > 0).all() for mesh in meshes]
    assert 0 < sum(cut) < len(cut)
    for mesh in meshes:
        report = check(mesh)
        assert report and not report.skipped, report


def test_overlaps_in_the_plane() -> None:
    two = [[0, 0], [2, 0], [2, 2], [0, 2]]
    report = check(Mesh(np.vstack([two, np.add(two, 1)]), cells={"quad": np.arange(8).reshape(2, 4)}))
    assert kinds(report) == {"crossing"}
    small = np.array(two) / 4 + 0.5
    report = check(Mesh(np.vstack([two, small]), cells={"quad": [range(4)], "polygon": [range(4, 8)]}))
    assert culprits(report, "overlap") == ((0,), (4, 5, 6, 7))


def test_surfaces() -> None:
    cube = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    report = check(Mesh(BOX, cells={"quad": cube}))
    assert report and any("Euler characteristic: 2, boundary 0" in name for name in report.passed)
    flat = Mesh([*BOX, [0.5, 0, 0]], cells={"quad": cube, "polygon": [[0, 8, 1]]})
    assert "flat cell" in kinds(check(flat)) or "facet" in kinds(check(flat))
    line = Mesh([[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]], cells={"quad": [[0, 1, 2, 3]]})
    assert culprits(check(line), "flat cell")[0] == (0,)


# ---------------------------------------------------------------------- domains


def in_quads(domain: Domain, n: int = 4) -> Mesh:
    """A square, meshed by quadrilaterals and two polygons."""
    mesh = planar(n, seed=6)
    points = mesh.points / n
    ends = mesh.boundary
    origin = np.full(len(points), -1)
    for i, p in enumerate(domain.points):
        origin[np.nonzero((points == p).all(axis=1))[0]] = i
    markers = {"facets": ends, "inner": np.empty((0, 2), dtype=int), "region": np.zeros(mesh.size, dtype=int)}
    return Mesh(points, cells=mesh.cells, origin=origin, markers=markers)


def test_a_domain_in_quadrilaterals() -> None:
    square = Domain.polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    mesh = in_quads(square)
    report = check(mesh, domain=square)
    if any("domain" in text for text in report.skipped):  # a hexagon with straight corners has flat triangles
        flat = [t for t, row in enumerate(mesh.cells.get("polygon", ())) if len(row) > 4]
        keep = {kind: block for kind, block in mesh.cells.items() if kind != "polygon"}
        corners = [row for t, row in enumerate(mesh.cells["polygon"]) if t not in flat]
        quads = [[row[0], row[1], row[4], row[5]] for row in (mesh.cells["polygon"][t] for t in flat)]
        quads += [[row[1], row[2], row[3], row[4]] for row in (mesh.cells["polygon"][t] for t in flat)]
        cells = {**keep, "polygon": [*corners, *quads]}
        many = sum(map(len, cells.values()))
        mesh = Mesh(mesh.points, cells=cells, origin=mesh.origin,
                    markers={**mesh.markers, "region": np.zeros(many, dtype=int)})  # fmt: skip
        report = check(mesh, domain=square)
    assert report, report
    assert any("covers what the chains enclose" in name for name in report.passed)
    wide = Domain.polygon([[0, 0], [2, 0], [1, 1], [0, 1]])
    assert not check(mesh, domain=wide)
    part = mesh.select(np.arange(mesh.size) > 0)
    assert "boundary" in kinds(check(part, domain=square))
    missing = Mesh(mesh.points, cells=mesh.cells)
    assert not check(missing, domain=square)


def test_a_solid_has_no_planar_domain() -> None:
    square = Domain.polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    assert "domain" in kinds(check(spatial(2), domain=square))
