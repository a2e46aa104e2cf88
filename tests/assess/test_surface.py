"""Meshes of surfaces: good ones of many kinds pass; each mutation of them is refused by its name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, Mesh, check
from unstruct.domain.given_surface import given_surface
from unstruct.errors import InputError
from unstruct.mesh.domain_mesh import DomainMesh


def divided(surface: Domain | Mesh, n: int, **rest: Any) -> DomainMesh:
    """The surface itself with each triangle cut into n²: names follow."""
    own = given_surface(surface, None)
    points, triangles = own.support.points, own.support.triangles
    known: dict[tuple, int] = {}
    rows, owner = [], []
    for t, row in enumerate(triangles.tolist()):
        a, b, c = points[row]
        number = {}
        for i in range(n + 1):
            for j in range(n + 1 - i):
                x = tuple(((a * (n - i - j) + b * i + c * j) / n).tolist())
                number[i, j] = known.setdefault(x, len(known))
        for i in range(n):
            for j in range(n - i):
                rows.append([number[i, j], number[i + 1, j], number[i, j + 1]])
                if i + j < n - 1:
                    rows.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
        owner += [t] * (len(rows) - len(owner))
    cells = np.array(rows)
    x = np.array(list(known))
    first: dict[tuple, int] = {}
    for i, row in enumerate(points.tolist()):
        first.setdefault(tuple(row), i)
    origin = [first.get(tuple(row), -1) for row in x.tolist()]
    markers = own.markers(cells, np.array(owner))
    return DomainMesh(x, cells, origin=origin, markers=markers, **rest)


def changed(mesh: Mesh, points: Any = None, simplices: Any = None, **rest: Any) -> DomainMesh:
    """The mesh with other points or cells; names stay with the cells that are left."""
    cells = mesh.simplices if simplices is None else np.asarray(simplices)
    return DomainMesh(
        mesh.points if points is None else points,
        cells,
        origin=rest.pop("origin", mesh.origin if points is None or len(points) == len(mesh.points) else None),
        markers=rest.pop("markers", mesh.markers),
        **rest,
    )


def kinds(mesh: Mesh, surface: Domain | Mesh, **options: Any) -> set[str]:
    report = check(mesh, domain=surface, **options)
    assert all(p.cells or p.vertices or p.kind in ("marker", "corner", "curve", "component", "deviation")
               for p in report.problems), report  # fmt: skip
    return {p.kind for p in report.problems}


BOX = Domain.box((0, 0, 0), (1, 2, 1))
TORUS = Domain.torus(size=0.4)
TWO_BALLS = Mesh(
    np.concatenate([Domain.ball(size=0.8).points, Domain.ball((4, 0, 0), size=0.8).points]),
    np.concatenate([given_surface(Domain.ball(size=0.8)).support.triangles + 42 * k for k in range(2)]),
)
HILL = Mesh(
    [[i / 4, j / 4, (i - 2) * (j - 1) / 32] for i in range(5) for j in range(5)],
    [
        row
        for i in range(4)
        for j in range(4)
        for a in [5 * i + j]
        for row in ([a, a + 5, a + 6], [a, a + 6, a + 1])
    ],
    markers={"west": [[0, 1], [1, 2], [2, 3], [3, 4]], "path": [[0, 6], [6, 12], [12, 18], [18, 24]]},
)
THREE_SHEETS = Mesh(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
)
CYLINDER = Domain.cylinder(size=0.5)


def test_its_balls_are_two() -> None:
    assert len(TWO_BALLS.points) == 84


@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("surface", [BOX, TORUS, TWO_BALLS, THREE_SHEETS, CYLINDER])
def test_the_surface_itself(surface: Domain | Mesh, n: int) -> None:
    report = check(divided(surface, n), domain=surface)
    assert report, report
    assert any("exact" in line and "common vertices and edges" in line for line in report.passed)


def named_hill(n: int, **figures: Any) -> DomainMesh:
    """The hill divided, with its names of edges."""
    mesh = divided(HILL, n, **figures)
    x = mesh.points
    ends = np.concatenate([mesh.simplices[:, [0, 1]], mesh.simplices[:, [1, 2]], mesh.simplices[:, [2, 0]]])
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    west = ends[(x[ends][:, :, 0] == 0).all(axis=1)]
    path = ends[(np.abs(x[ends][:, :, 0] - x[ends][:, :, 1]) < 1e-12).all(axis=1)]
    return changed(mesh, markers={"west": west, "path": path}, **figures)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_names_of_edges(n: int) -> None:
    mesh = named_hill(n)
    assert check(mesh, domain=HILL), check(mesh, domain=HILL)
    west, path = mesh.markers["west"], mesh.markers["path"]
    assert kinds(changed(mesh, markers={"west": west[1:], "path": path}), HILL) == {"marker"}
    assert kinds(changed(mesh, markers={"west": path, "path": west}), HILL) == {"marker"}
    assert kinds(changed(mesh, markers={"path": path}), HILL) == {"marker"}
    assert kinds(changed(mesh, markers={"west": west, "path": mesh.simplices}), HILL) == {"marker"}


MUTATIONS: dict[str, tuple[Callable[[DomainMesh], DomainMesh], tuple[str, ...]]] = {}


def mutation(*expected: str) -> Callable:
    def note(change: Callable[[DomainMesh], DomainMesh]) -> Callable:
        MUTATIONS[change.__name__] = change, expected
        return change

    return note


def inner_vertex(mesh: Mesh) -> int:
    """A vertex in the middle of a side of the box."""
    x = mesh.points
    return int(
        np.flatnonzero((x[:, 0] == 0) & (np.abs(x[:, 1] - 1) < 0.3) & (np.abs(x[:, 2] - 0.5) < 0.3))[0]
    )


@mutation("hole", "Euler characteristic")
def a_hole(mesh: DomainMesh) -> DomainMesh:
    t = int(np.flatnonzero((mesh.simplices == inner_vertex(mesh)).any(axis=1))[0])
    return changed(mesh, simplices=np.delete(mesh.simplices, t, axis=0), markers=without(mesh, [t]))


def without(mesh: Mesh, cells: list[int]) -> dict:
    gone = {tuple(sorted(row)) for row in mesh.simplices[cells].tolist()}
    return {
        name: np.array([row for row in rows.tolist() if tuple(sorted(row)) not in gone])
        for name, rows in mesh.markers.items()
    }


@mutation("orientation", "turned")
def a_triangle_turned(mesh: DomainMesh) -> DomainMesh:
    t = int(np.flatnonzero((mesh.simplices == inner_vertex(mesh)).any(axis=1))[0])
    cells = mesh.simplices.copy()
    cells[t] = cells[t, ::-1]
    return changed(mesh, simplices=cells)


@mutation("turned", "meets itself")
def a_fold(mesh: DomainMesh) -> DomainMesh:
    v = inner_vertex(mesh)
    x = mesh.points.copy()
    x[v, 1:] += [0.55, 0.0625]
    return changed(mesh, points=x)


@mutation("off the surface", "deviation")
def a_vertex_off(mesh: DomainMesh) -> DomainMesh:
    x = mesh.points.copy()
    x[inner_vertex(mesh), 0] -= 1e-3
    return changed(mesh, points=x, figures={"deviation": 1e-6})


@mutation("off the surface")
def a_vertex_hardly_off(mesh: DomainMesh) -> DomainMesh:
    x = mesh.points.copy()
    x[inner_vertex(mesh), 0] -= 1e-12
    return changed(mesh, points=x)


@mutation("curve", "turned", "marker")
def a_crease_flipped(mesh: DomainMesh) -> DomainMesh:
    """The two triangles at an edge of a crease take the other diagonal: none follows the crease there."""
    x, cells = mesh.points, mesh.simplices.copy()
    on = (x[:, 0] == 0) & (x[:, 2] == 0)
    one, two = np.flatnonzero(on[cells].sum(axis=1) == 2)[:2].tolist()
    for one in np.flatnonzero(on[cells].sum(axis=1) == 2).tolist():
        others = [t for t in np.flatnonzero(on[cells].sum(axis=1) == 2).tolist()
                  if t != one and len(set(cells[t]) & set(cells[one])) == 2]  # fmt: skip
        if others:
            two = others[0]
            break
    while on[cells[one, 2]]:
        cells[one] = np.roll(cells[one], 1)
    a, b, c = cells[one].tolist()
    (d,) = set(cells[two].tolist()) - {a, b}
    cells[one], cells[two] = [c, a, d], [d, b, c]
    return changed(mesh, simplices=cells)


@mutation("marker")
def a_wrong_name(mesh: DomainMesh) -> DomainMesh:
    rows = dict(mesh.markers)
    rows["left"], rows["right"] = rows["left"][1:], np.concatenate([rows["right"], rows["left"][:1]])
    return changed(mesh, markers=rows)


@mutation("marker")
def a_name_less(mesh: DomainMesh) -> DomainMesh:
    return changed(mesh, markers={name: rows for name, rows in mesh.markers.items() if name != "top"})


@mutation("turned")
def all_inside_out(mesh: DomainMesh) -> DomainMesh:
    return changed(mesh, simplices=mesh.simplices[:, ::-1])


@mutation("moved", "corner", "curve")
def a_corner_moved(mesh: DomainMesh) -> DomainMesh:
    x = mesh.points.copy()
    v = int(np.flatnonzero((x == 0).all(axis=1))[0])
    x[v, 1] = 1e-9
    return changed(mesh, points=x)


@mutation("twice", "equal vertices")
def a_copy_of_a_cell(mesh: DomainMesh) -> DomainMesh:
    cells = np.concatenate([mesh.simplices, mesh.simplices[:1]])
    return changed(mesh, simplices=cells)


@mutation("flat cell")
def a_flat_cell(mesh: DomainMesh) -> DomainMesh:
    v = inner_vertex(mesh)
    t = int(np.flatnonzero((mesh.simplices == v).any(axis=1))[0])
    others = [int(w) for w in mesh.simplices[t] if w != v]
    x = mesh.points.copy()
    x[v] = x[others].sum(axis=0) / 2
    return changed(mesh, points=x)


@mutation("equal vertices")
def sheets_slit_open(mesh: DomainMesh) -> DomainMesh:
    """A cell with a vertex of its own, in the place of that of the others."""
    v = inner_vertex(mesh)
    t = int(np.flatnonzero((mesh.simplices == v).any(axis=1))[0])
    cells = mesh.simplices.copy()
    cells[t][cells[t] == v] = len(mesh.points)
    x = np.concatenate([mesh.points, mesh.points[v : v + 1]])
    return changed(mesh, points=x, simplices=cells, origin=np.append(mesh.origin, -1))


@pytest.mark.parametrize("name", MUTATIONS)
@pytest.mark.parametrize("n", [4, 8])
def test_mutations_of_a_box(name: str, n: int) -> None:
    """Each is refused, by one of its names, and by no other; the box itself passes."""
    change, expected = MUTATIONS[name]
    first, others = expected[0], set(expected)
    found = kinds(change(divided(BOX, n)), BOX)
    assert first in found and found <= others, (name, found)


def test_a_handle_closed() -> None:
    """A torus whose tube is cut and capped is a sphere; the caps lie off the surface, but near is enough."""
    n, m = 24, 8
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    wide = 2 + 0.1 * np.cos(v)
    points = np.stack([wide * np.cos(u), wide * np.sin(u), 0.1 * np.sin(v)], axis=-1).reshape(-1, 3)
    rows = []
    for i in range(n):
        for j in range(m):
            a, b, c, d = ((i + x) % n * m + (j + y) % m for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
            rows += [[a, b, c], [a, c, d]]
    torus = Mesh(points, rows)
    assert check(torus, domain=torus, sharp=180)
    kept = [
        row for row in rows if not (min(row) < m and any(m <= v < 2 * m for v in row) and max(row) < 2 * m)
    ]
    caps = [[0, j, j + 1] for j in range(1, m - 1)] + [[m, m + j + 1, m + j] for j in range(1, m - 1)]
    found = kinds(Mesh(points, kept + caps), torus, deviation=0.7, sharp=180)
    assert "Euler characteristic" in found


def test_sheets_glued_and_components() -> None:
    """Two balls with a common vertex; one ball alone; one of them twice, nested, is too near to be told."""
    mesh = divided(TWO_BALLS, 1)
    cells = mesh.simplices.copy()
    one = int(np.abs(mesh.points - [1, 0, 0]).sum(axis=1).argmin())
    two = int(np.abs(mesh.points - [3, 0, 0]).sum(axis=1).argmin())
    cells[cells == two] = one
    assert "pinched vertex" in kinds(changed(mesh, simplices=cells), TWO_BALLS)
    assert "pinched vertex" in kinds(changed(mesh, simplices=cells), TWO_BALLS, deviation=5.0)
    assert kinds(changed(mesh, simplices=mesh.simplices[: mesh.size // 2]), TWO_BALLS) >= {"component"}
    x = np.concatenate([mesh.points, mesh.points[: len(mesh.points) // 2] * 0.9])
    more = np.concatenate([mesh.simplices, mesh.simplices[: mesh.size // 2] + len(mesh.points)])
    assert kinds(Mesh(x, more), TWO_BALLS, deviation=0.2) == {"component"}


@pytest.mark.parametrize("gap", [0.1, 0.001, 1e-9])
def test_sheets_nearer_than_the_mesh_deviates(gap: float) -> None:
    """Two nested spheres. Middles of cells may be nearer to the other one; vertices lie on their own one."""
    rows = [[i, j, k][:: -1 if (i + j + k) % 2 else 1] for i in (0, 3) for j in (1, 4) for k in (2, 5)]
    octahedron = Mesh(np.concatenate([np.eye(3), -np.eye(3)]), rows)

    def nested(n: int, sheets: tuple[float, float] = (1.0, 1.0 - gap)) -> Mesh:
        ball = divided(octahedron, n)
        x = ball.points / np.sqrt((ball.points**2).sum(axis=1))[:, None]
        both = [ball.simplices, ball.simplices + len(x)]
        return Mesh(np.concatenate([r * x for r in sheets]), np.concatenate(both))

    surface, mesh = nested(8), nested(4)
    assert check(mesh, domain=surface, sharp=180)
    for rows in (mesh.simplices[: mesh.size // 2], mesh.simplices[mesh.size // 2 :]):
        assert kinds(Mesh(mesh.points, rows), surface, sharp=180) >= {"component"}
    for r in (1.0, 1.0 - gap):
        assert kinds(nested(4, (r, r)), surface, sharp=180) == {"equal vertices"}


def test_sheets_that_branch() -> None:
    """Three sheets at a line: one of them missing, or one turned, or a fourth, are told at the line."""
    mesh = divided(THREE_SHEETS, 2)
    assert kinds(changed(mesh, simplices=mesh.simplices[:8]), THREE_SHEETS) >= {"hole", "corner"}
    cells = mesh.simplices.copy()
    cells[8:] = cells[8:, ::-1]
    assert "orientation" in kinds(changed(mesh, simplices=cells), THREE_SHEETS)
    flat = Mesh(THREE_SHEETS.points[:4], THREE_SHEETS.simplices[:2])
    assert "branch" in kinds(mesh, flat)


def test_the_end_of_an_open_surface() -> None:
    mesh = named_hill(2)
    x = mesh.points
    outer = np.flatnonzero((x[mesh.simplices][:, :, 0] > 0.87).any(axis=1))
    found = kinds(changed(mesh, simplices=np.delete(mesh.simplices, outer, axis=0)), HILL)
    assert {"corner", "hole"} <= found
    report = check(changed(mesh, figures={"deviation": 0.0}), domain=HILL)
    assert report and any("allowed is 0" in line for line in report.passed)


def test_immersed_surface() -> None:
    """A surface that meets itself may be meshed as it is; what is said of it is said so."""
    cross = Mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, -1], [0.3, 0.2, 1], [0.2, 0.3, 1]],
        [[0, 1, 2], [3, 4, 5]],
    )
    report = check(divided(cross, 1), domain=cross)
    assert report and any("as the surface does" in line for line in report.skipped)


@pytest.mark.parametrize("exponent", [-200, 200])
def test_very_large_and_small(exponent: int) -> None:
    surface = Mesh(np.ldexp(HILL.points, exponent), HILL.simplices)
    mesh = divided(surface, 2)
    assert check(mesh, domain=surface), check(mesh, domain=surface)
    x = mesh.points.copy()
    x[1, 2] += np.ldexp(1e-3, exponent)
    assert "off the surface" in kinds(changed(mesh, points=x), surface)


def test_thin_plate() -> None:
    """Cells of a plate that is thinner than the deviation allowed lie on the side that they face."""
    plate = Domain.box((0, 0, 0), (1, 1, 1e-4))
    mesh = divided(plate, 3)
    assert check(mesh, domain=plate, deviation=1e-2)
    assert check(mesh, domain=plate)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32))
def test_random_changes_are_refused(seed: int) -> None:
    """A vertex moved, a cell removed, turned or with another vertex: never valid."""
    rng = np.random.default_rng(seed)
    surface = (BOX, TORUS, THREE_SHEETS)[rng.integers(3)]
    mesh = divided(surface, 2)
    cells, x = mesh.simplices.copy(), mesh.points.copy()
    t, k, v = rng.integers(len(cells)), rng.integers(3), rng.integers(len(x))
    match rng.integers(4):
        case 0:
            cells = np.delete(cells, t, axis=0)
        case 1:
            cells[t] = cells[t, ::-1]
        case 2:
            x[v] += rng.choice([1e-9, 1e-3, 0.3]) * rng.standard_normal(3)
        case _:
            if v in cells[t]:
                return
            cells[t, k] = v
    assert not check(Mesh(x, cells, markers=mesh.markers), domain=surface)


def test_wrong_arguments() -> None:
    mesh = divided(BOX, 1)
    for options in ({"deviation": -1.0}, {"sharp": 200.0}, {"deviation": "much"}):
        with pytest.raises(InputError):
            check(mesh, domain=BOX, **options)
    with pytest.raises(InputError, match="surface"):
        check(mesh, deviation=0.1)
    with pytest.raises(InputError, match="plane"):
        check(mesh, domain=Domain([[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 2], [2, 0]]))
    with pytest.raises(InputError, match="domain must be a Domain"):
        check(Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), domain=mesh)
