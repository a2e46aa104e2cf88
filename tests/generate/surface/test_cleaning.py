"""Surfaces that broke `remesh` and `surface_delaunay`, as files from elsewhere may have them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import unstruct
from unstruct import Mesh, check, remesh
from unstruct.errors import IncompleteWarning, InputError
from unstruct.generate.surface import front_march
from unstruct.generate.surface.front import surface_front


def test_a_surface_of_flat_triangles_has_no_direction() -> None:
    for points in ([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], [[0, 0, 0], [1, 1, 1], [3, 3, 3]]):
        with pytest.raises(InputError, match="degenerate"):
            remesh(Mesh(points, [[0, 1, 2]]), 0.2)
        with pytest.raises(InputError, match="degenerate"):
            surface_front(Mesh(points, [[0, 1, 2]]), 0.2)


def test_a_surface_of_one_triangle_has_criteria() -> None:
    """Three points have no Delaunay mesh in space, and that was an error."""
    surface = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    for size in (None, 0.2):
        mesh = unstruct.surface_delaunay(surface, size)
        assert mesh.complete and unstruct.check(mesh, domain=surface)


def box(*sides: float) -> Mesh:
    points = [[x, y, z] for x in (0, sides[0]) for y in (0, sides[1]) for z in (0, sides[2])]
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    rows = [row for a, b, c, d in quads for row in ((a, b, c), (a, c, d))]
    return Mesh(np.array(points, dtype=float), np.array(rows))


@pytest.mark.parametrize("thickness", [1e-3, 1e-4])
def test_the_sheets_of_a_thin_plate_stay_apart(thickness: float) -> None:
    """Vertices of one sheet went to the other one, which is no farther away than what is allowed."""
    plate = box(1.0, 1.0, thickness)
    with pytest.warns(IncompleteWarning, match="creases"):
        mesh = remesh(plate, 0.1)
    assert unstruct.check(mesh, domain=plate) and mesh.size < 3000
    assert all("creases" in why for why in mesh.reasons)


def strip(n: int = 24, across: int = 4, width: float = 0.3) -> Mesh:
    """Moebius' strip."""
    points, rows = [], []
    for i in range(n):
        a = 2 * np.pi * i / n
        for s in np.linspace(-width, width, across):
            r = 1 + s * np.cos(a / 2)
            points.append([r * np.cos(a), r * np.sin(a), s * np.sin(a / 2)])
    for i in range(n):
        for j in range(across - 1):
            a, b = i * across + j, i * across + j + 1
            c, d = (a + across, b + across) if i < n - 1 else (across - 1 - j, across - 2 - j)
            rows += [[a, c, b], [c, d, b]]
    return Mesh(np.array(points), np.array(rows))


def test_a_strip_with_one_side_keeps_its_seam() -> None:
    """It was turned another way, with a seam elsewhere, than the surface that check compares it with."""
    surface = strip()
    mesh = remesh(surface, 0.15)
    assert mesh.complete and mesh.counts["turned triangles"] == 0 and unstruct.check(mesh, domain=surface)


def test_what_was_turned_and_repeated_passes_the_check() -> None:
    tetrahedron = [[0, 2, 1], [0, 1, 3], [3, 2, 1], [0, 3, 2], [1, 0, 2]]
    surface = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], tetrahedron)
    mesh = remesh(surface, 0.3)
    assert mesh.counts["turned triangles"] == mesh.counts["repeated triangles"] == 1
    report = unstruct.check(mesh, domain=surface)
    assert report and any(
        "1 triangles, which count once, and 1 were turned" in note for note in report.passed
    )
    broken = Mesh(mesh.points, np.vstack([mesh.simplices[:1, ::-1], mesh.simplices[1:]]))
    assert not unstruct.check(broken, domain=surface)


def test_the_front_takes_what_is_turned_and_repeated_as_remeshing_does() -> None:
    """It took the edges of turned and repeated triangles for curves, where sheets branch."""
    tetrahedron = [[0, 2, 1], [0, 1, 3], [3, 2, 1], [0, 3, 2], [1, 0, 2]]
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    surface = Mesh(points, tetrahedron, markers={"region": np.ones(5, dtype=int)}, regions={"rock": 1})
    mesh = surface_front(surface, 0.3)
    assert mesh.counts["turned triangles"] == mesh.counts["repeated triangles"] == 1
    assert mesh.complete and unstruct.check(mesh, domain=surface) and mesh.regions == {"rock": 1}


@pytest.mark.parametrize("scale", [1e160, 1e-160])
def test_a_front_on_coordinates_whose_squares_no_double_can_hold(scale: float) -> None:
    """Normals were products of lengths and not finite, in the front and in check."""
    surface = box(scale, scale, scale)
    mesh = surface_front(surface, 0.4 * scale)
    assert mesh.complete and unstruct.check(mesh, domain=surface)
    moved = mesh.points.copy()
    moved[0] += 0.1 * scale
    assert not unstruct.check(Mesh(moved, mesh.simplices), domain=surface)


def test_coordinates_that_are_rounded_more_than_the_usual_deviation() -> None:
    """It split everything, because rounded vertices are farther away than a hundredth of the size."""
    tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    points = 4.0 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + 1e14
    mesh = remesh(Mesh(points, tetrahedron), 1.0)
    assert mesh.size < 500


def bottle(n: int = 24, around: int = 12) -> Mesh:
    """Klein's bottle, as a figure eight that turns: it crosses itself."""
    u, v = np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(around) / around, indexing="ij")
    r = 2 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    z = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
    rows = []
    for i in range(n):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            c, d = a + around, b + around
            if i == n - 1:
                c, d = -j % around, (-j - 1) % around
            rows += [[a, c, b], [c, d, b]]
    return Mesh(np.stack([r * np.cos(u), r * np.sin(u), z], axis=2).reshape(-1, 3), np.array(rows))


def test_a_surface_that_crosses_itself_is_not_split_without_end() -> None:
    """Beside edges of more than two triangles, which stay, it split others without end where sizes fell."""
    mesh = remesh(bottle(), 0.4)
    assert mesh.size < 100_000 and any("crosses" in reason for reason in mesh.reasons)


def test_a_size_that_jumps_is_put_into_a_table_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The table, which is fine all along the jump, was made anew for each attempt: most of the time."""
    made: list[int] = []
    table = front_march.space_nodes

    def counted(*arguments: Any) -> Any:
        made.append(1)
        return table(*arguments)

    monkeypatch.setattr(front_march, "space_nodes", counted)
    x, y = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21), indexing="ij")
    z = 0.1 * np.sin(6 * x) * np.cos(5 * y)
    a = np.arange(21 * 20).reshape(20, 21)[:, :-1].ravel()
    rows = np.vstack([np.column_stack([a, a + 21, a + 22]), np.column_stack([a, a + 22, a + 1])])
    surface = Mesh(np.column_stack([x.ravel(), y.ravel(), z.ravel()]), rows)
    mesh = surface_front(surface, lambda x: np.where(x[:, 0] < 0.5, 0.3, 0.015))
    assert len(made) == 1 and unstruct.check(mesh, domain=surface)


TETRAHEDRON = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])


@pytest.mark.parametrize("make", [surface_front, remesh])
def test_a_flat_triangle_that_hangs_on_an_edge_goes(make: Any) -> None:
    points, rows = TETRAHEDRON
    more = [*points, (0.5, 0, 0), (0.25, 0, 0)]
    given = Mesh(more, [*rows, (0, 1, 4), (0, 4, 5)])
    mesh = make(given, 0.3)
    assert check(mesh, domain=given)
    assert mesh.complete and mesh.counts["degenerate triangles"] == 2
    assert np.array_equal(mesh.simplices, make(Mesh(more, rows), 0.3).simplices)


@pytest.mark.parametrize("make", [surface_front, remesh])
def test_a_flat_triangle_with_a_name_or_between_others_stays(make: Any) -> None:
    points, rows = TETRAHEDRON
    more = [*points, (0.5, 0, 0)]
    named = make(Mesh(more, [*rows, (0, 1, 4)], markers={"edge": [(0, 4)]}), 0.3)
    between = make(Mesh(more, [(0, 2, 4), (4, 2, 1), (0, 4, 1), *rows[1:]]), 0.3)
    for mesh in (named, between):
        assert mesh.counts["degenerate triangles"] == 0
    assert check(between) and "edge" in named.markers


def test_a_front_has_no_direction_on_a_closed_part_without_area() -> None:
    points, rows = TETRAHEDRON
    line = [(5.0 + x, 0, 0) for x in (0, 1, 2, 3)]
    surface = Mesh([*points, *line], [*rows, *(tuple(4 + v for v in row) for row in rows)])
    mesh = surface_front(surface, 0.3)
    assert len(mesh.unrefined) == mesh.size == 4 and check(mesh)


@pytest.mark.parametrize("rows", [2, 8])
def test_the_thin_side_of_a_plate_keeps_no_needles_but_those_it_must(rows: int) -> None:
    """Rows of vertices were left in a side that is far thinner than the size, and nothing was said."""
    k = np.arange(16 * rows)
    i, j = k % 16, k // 16
    a, b = i + 16 * j, (i + 1) % 16 + 16 * j
    sides = np.concatenate([np.stack([a, b, b + 16], 1), np.stack([a, b + 16, a + 16], 1)])
    ring = [(t, 0) for t in range(4)] + [(4, t) for t in range(4)]
    ring += [(4 - t, 4) for t in range(4)] + [(0, 4 - t) for t in range(4)]
    points = [(x / 4, y / 4, 1e-4 * z / rows) for z in range(rows + 1) for x, y in ring]
    bottom, top = len(points), len(points) + 1
    points += [(0.5, 0.5, 0.0), (0.5, 0.5, 1e-4)]
    caps = [(int((t + 1) % 16), t, bottom) for t in range(16)]
    caps += [(t + 16 * rows, (t + 1) % 16 + 16 * rows, top) for t in range(16)]
    given = Mesh(points, np.concatenate([sides, caps]))
    mesh = remesh(given, 0.2)
    assert check(mesh, domain=given)
    z = mesh.points[:, 2]
    assert np.isin(z, (0.0, 1e-4)).all()
    upright = np.ptp(z[mesh.simplices], axis=1) > 0
    assert np.array_equal(np.flatnonzero(upright), mesh.unrefined)
    assert all(reason.startswith("sharp: creases") for reason in mesh.reasons)
