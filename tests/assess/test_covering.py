"""Overlaps of solids by their boundary alone: cells that no division into tetrahedra would tell."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Mesh, Report, check
from unstruct.assess import covering, mixed
from unstruct.assess.covering import check_covering, outer_faces
from unstruct.mesh.split import simplices_of_cells
from unstruct.predicates.batch import orient_rows

BOX = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
# Hexahedra with a positive Jacobian that cannot be cut into positive tetrahedra from their lowest vertices.
# The tetrahedra of two faces of the second one overlap.
UNCUT = np.array([[0, -1, 0], [9, 2, -1], [8, 6, 2], [2, 9, 1], [1, -1, 9], [9, 1, 8], [8, 11, 8], [1, 6, 9]])
NEAR = np.array([[1, 1, 0], [5, -2, 0], [10, 8, 1], [0, 5, 1], [0, -2, 9], [8, 4, 5], [7, 8, 8], [1, 9, 9]])
FREE = "boundary faces, bilinear ones too, meet in common corners and edges alone"
ONCE = "no cells overlap: the boundary winds once around all that is inside (exact)"


def kinds(report: Report) -> set[str]:
    return {problem.kind for problem in report.problems}


def hexahedra(*bodies: np.ndarray) -> Mesh:
    points = np.vstack(bodies).astype(float)
    return Mesh(points, cells={"hexahedron": np.arange(len(points)).reshape(-1, 8)})


def with_pyramid(x: np.ndarray, height: float = 20.0) -> Mesh:
    """A hexahedron with a pyramid on its last face."""
    points = np.vstack([x, np.add(x[4:].mean(axis=0), [0, 0, height])]).astype(float)
    return Mesh(points, cells={"hexahedron": [range(8)], "pyramid": [[4, 5, 6, 7, 8]]})


@pytest.mark.parametrize("x", [UNCUT, NEAR], ids=["apart", "near"])
def test_valid_cells_that_cannot_be_cut(x: np.ndarray) -> None:
    for mesh in (hexahedra(x), with_pyramid(x), hexahedra(x, x + 100)):
        rows, _ = simplices_of_cells(mesh.cells)
        assert (orient_rows(mesh.points, rows) <= 0).any() and (mesh.jacobian_signs() == 1).all()
        report = check(mesh)
        assert report and not report.skipped, report
        assert {FREE, ONCE} <= set(report.passed)


@pytest.mark.parametrize("x", [UNCUT, NEAR], ids=["apart", "near"])
def test_overlapping_cells_that_cannot_be_cut(x: np.ndarray) -> None:
    report = check(hexahedra(x, x + 3))
    assert kinds(report) == {"crossing"}, report
    assert all(problem.cells == (0, 1) for problem in report.problems)
    one = with_pyramid(x)
    other = {kind: block + 9 for kind, block in one.cells.items()}
    cells = {kind: np.vstack([block, other[kind]]) for kind, block in one.cells.items()}
    assert kinds(check(Mesh(np.vstack([one.points, np.add(one.points, [3, 2, 1])]), cells=cells))) == {
        "crossing"
    }


@pytest.mark.parametrize("x", [UNCUT, NEAR], ids=["apart", "near"])
def test_a_cell_within_another(x: np.ndarray) -> None:
    """Boundaries do not meet; the inner one would have to be directed inward."""
    for mesh in (hexahedra(100 * BOX - 45, x), hexahedra(20 * x - 100, x)):
        assert (mesh.jacobian_signs() == 1).all()
        report = check(mesh)
        assert kinds(report) == {"overlap"} and report.problems[0].cells == (1,), report
    report = check(hexahedra(1000 * BOX - 450, 100 * BOX - 45, x))
    assert kinds(report) == {"overlap"} and 1 in report.problems[0].cells


def test_a_cavity_is_no_overlap() -> None:
    """26 cubes around a hole, and a cell in the hole that cannot be cut."""
    i = np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(64).reshape(4, 4, 4)
    corners = [number[a : a + 3, b : b + 3, c : c + 3].ravel() for a, b, c in BOX]
    rows = np.delete(np.stack(corners, axis=1), 13, axis=0)
    for x in (UNCUT, NEAR):
        points = np.vstack([20.0 * i - 25, x])
        mesh = Mesh(points, cells={"hexahedron": np.vstack([rows, 64 + np.arange(8)])})
        assert check(mesh), check(mesh)
        middle = number[1:3, 1:3, 1:3].ravel()[[0, 4, 6, 2, 1, 5, 7, 3]]
        filled = Mesh(points, cells={"hexahedron": np.vstack([rows, middle, 64 + np.arange(8)])})
        report = check(filled)
        assert kinds(report) == {"overlap"} and report.problems[0].cells == (27,)


def test_both_ways_of_telling_what_lies_within_agree() -> None:
    meshes = [
        hexahedra(100 * BOX - 45, UNCUT), hexahedra(UNCUT, UNCUT + 30), hexahedra(BOX), with_pyramid(UNCUT),
        hexahedra(900 * BOX - 45, 100 * BOX, UNCUT + 9),
    ]  # fmt: skip
    for mesh in meshes:
        faces, _ = outer_faces(mesh)
        triangles, of = covering._hulls(faces, np.zeros(len(faces), dtype=bool))
        bent = orient_rows(mesh.points, faces) != 0
        found = covering._sides(mesh.points, faces, bent, triangles, of)
        assert found is not None and np.array_equal(found, covering.front_inside(mesh.points, triangles))


def test_bilinear_faces_may_cross_where_their_triangles_do_not() -> None:
    """A pyramid pokes into a saddle: not into the triangles of its division, which lie below it."""
    low = BOX.astype(float)
    low[4:, 2] += [0.3, -0.3, 0.3, -0.3]
    numbers = [1, 2, 3, 0, 5, 6, 7, 4]  # the division of the last face runs through the lower corners
    apex = [0.5, 0.5, 0.85]
    base = np.array([[0.4, 0.4, 3], [0.4, 0.6, 3], [0.6, 0.6, 3], [0.6, 0.4, 3]])
    points = np.vstack([low[np.argsort(numbers)], base, apex])
    mesh = Mesh(points, cells={"hexahedron": [numbers], "pyramid": [[8, 9, 10, 11, 12]]})
    assert (mesh.jacobian_signs() == 1).all()
    report = check(mesh)
    assert kinds(report) == {"crossing"} and "bilinear" in report.problems[0].text
    points[12, 2] = 1.05
    assert check(Mesh(points, cells=mesh.cells))


def test_a_jacobian_that_cannot_be_decided_is_a_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = hexahedra(UNCUT)
    monkeypatch.setattr(mixed, "jacobian_signs", lambda _: (np.zeros(1, np.int8), np.zeros(1, np.int64)))
    report = check(mesh)
    assert kinds(report) == {"undecided"} and report.problems[0].cells == (0,)


# ---------------------------------------------------------------------- beside winding numbers


def winding(points: np.ndarray, faces: np.ndarray, y: np.ndarray, parts: int = 8) -> np.ndarray:
    """The winding numbers of bilinear faces by solid angles of many triangles."""
    t = np.arange(parts + 1) / parts
    u, v = (w[..., None] for w in np.meshgrid(t, t, indexing="ij"))
    total = np.zeros(len(y))
    for a, b, c, d in points[faces]:
        x = (1 - u) * ((1 - v) * a + v * d) + u * ((1 - v) * b + v * c)
        p, q, r, s = x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]
        for corners in ((p, q, r), (p, r, s)):
            e, f, g = (w.reshape(-1, 3)[None] - y[:, None] for w in corners)
            ee, ff, gg = (np.linalg.norm(w, axis=2) for w in (e, f, g))
            volume = (e * np.cross(f, g)).sum(axis=2)
            base = ee * ff * gg + (e * f).sum(2) * gg + (f * g).sum(2) * ee + (g * e).sum(2) * ff
            total += 2 * np.arctan2(volume, base).sum(axis=1) / (4 * np.pi)
    return total


@settings(max_examples=2, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 2.0), st.sampled_from([0.1, 0.25]))
def test_where_points_are_covered_twice_it_is_found(seed: int, shift: float, jitter: float) -> None:
    """Two columns of hexahedra, jittered, of which one is moved into the other by a random vector."""
    rng = np.random.default_rng(seed)
    one, other = (
        np.vstack([BOX, np.add(BOX[4:], [0, 0, 1])]) + jitter * rng.uniform(-1, 1, (12, 3)) for _ in range(2)
    )
    step = rng.normal(size=3)
    points = np.vstack([one, other + shift * step / np.linalg.norm(step)])
    rows = np.array([range(8), range(4, 12)])
    mesh = Mesh(points, cells={"hexahedron": np.vstack([rows, rows + 12])})
    if (mesh.jacobian_signs() != 1).any():
        return
    report = Report("")
    check_covering(mesh, report)
    faces, _ = outer_faces(mesh)
    u = rng.random((24, 3, 1))
    weights = np.prod(np.where(BOX.T[None] == 1, u, 1 - u), axis=1)
    inside = np.concatenate([weights @ points[row] for row in np.vstack([rows, rows + 12])])
    most = winding(points, faces, inside).max()
    if most > 1.5:
        assert not report
    if report:
        assert most < 1.5
