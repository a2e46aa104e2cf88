"""Walls of bodies and of open surfaces, and what is refused, by name and place."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, Layers, Mesh, UnstructError, check, prismatic_layers
from unstruct.generate.prisms.walls import base_of

LAYERS = Layers(first=0.01, growth=1.2, count=3)


def octahedron(n: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """The unit sphere from an octahedron, with points exactly in the planes of coordinates."""
    corners = np.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    number: dict[tuple[int, ...], int] = {}
    rows = []
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (1, 0, 5), (2, 1, 5), (3, 2, 5), (0, 3, 5)]
    for a, b, c in corners[np.array(faces)]:

        def at(i: int, j: int, a: np.ndarray = a, b: np.ndarray = b, c: np.ndarray = c) -> int:
            return number.setdefault(tuple((a * (n - i - j) + b * i + c * j).tolist()), len(number))

        for i in range(n):
            for j in range(n - i):
                rows.append((at(i, j), at(i + 1, j), at(i, j + 1)))
                if i + j < n - 1:
                    rows.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
    points = np.array(list(number), dtype=float)
    return points / np.sqrt((points**2).sum(axis=1))[:, None], np.array(rows, dtype=np.int32)


def part(points: np.ndarray, rows: np.ndarray, keep: np.ndarray) -> Mesh:
    used = np.unique(rows[keep])
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    return Mesh(points[used], number[rows[keep]])


def upper_half() -> Mesh:
    points, rows = octahedron()
    return part(points, rows, (points[rows][:, :, 2] >= 0).all(axis=1))


def outward(walls: object, center: tuple[float, ...]) -> np.ndarray:
    x = walls.points[walls.triangles]  # type: ignore[attr-defined]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    return (normal * (x.mean(axis=1) - center)).sum(axis=1) > 0


@pytest.mark.parametrize("side", ["inside", "outside"])
@pytest.mark.parametrize("turned", [False, True])
def test_walls_face_the_layers(side: str, turned: bool) -> None:
    points, rows = octahedron()
    rows = rows[:, ::-1] if turned else rows
    for surface in (Domain(points, rows), Mesh(points, rows)):
        base = base_of(surface, None, side)
        assert (outward(base.walls, (0, 0, 0)) == (side == "outside")).all()
        assert (base.walls.points == points[base.walls.vertex]).all() and not len(base.others.triangles)
        assert (base.origin == np.arange(len(points))).all()


def test_named_walls_and_the_planes_beside() -> None:
    base = base_of(Domain.box(), ["bottom"], "inside")
    assert len(base.walls.triangles) == 2 and len(base.others.triangles) == 10
    assert (base.walls.planes >= 0).all() and len(base.walls.normals) == 4
    assert ((np.abs(base.walls.normals) == 1).sum(axis=1) == 1).all()
    assert (base.others.plane == -1).sum() == 2  # the top
    named = prismatic_layers(Domain.box(), layers=LAYERS, walls="bottom", side="inside")
    assert check(named) and len(named.markers["bottom"]) == 2
    assert named.markers["cap"].shape == (2, 3)
    numbers = prismatic_layers(Domain.box(), layers=LAYERS, walls=[4], side="inside")
    assert (numbers.points == named.points).all()


def test_an_open_surface_ends_in_its_plane() -> None:
    half = upper_half()
    for side in ("inside", "outside"):
        mesh = prismatic_layers(half, layers=LAYERS, side=side)
        assert check(mesh) and mesh.counts["wedges"] == 3 * len(half.simplices)
        assert (mesh.points[:, 2] >= 0).all()
        assert (mesh.points[:, 2] == 0).sum() == 4 * (half.points[:, 2] == 0).sum()
    reach = np.sqrt((mesh.points**2).sum(axis=1)).max()
    assert reach > 1.01


def test_a_prism_slides_along_its_edges() -> None:
    """The sides of a polygonal prism are planes, two at each vertex of the end: rays go along the axis."""
    rim = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    flat = Domain.polygon(np.column_stack([np.cos(rim), np.sin(rim)]))
    duct = Domain.extruded(flat, 1.0)
    mesh = prismatic_layers(duct, layers=LAYERS, walls=["bottom", "top"], side="inside")
    assert check(mesh)
    assert np.abs(np.abs(mesh.steps["direction"][:, 2]) - 1).max() < 1e-12
    refused(Domain.cylinder(size=0.3), "in 3 planes", "point", " at (", walls="bottom", side="inside")


def refused(surface: object, *words: str, **options: object) -> None:
    with pytest.raises(UnstructError) as error:
        prismatic_layers(surface, layers=LAYERS, **options)  # type: ignore[arg-type]
    assert all(word in str(error.value) for word in words), str(error.value)


def test_bad_surfaces_are_refused_by_name_and_place() -> None:
    points, rows = octahedron()
    crossing = points.copy()
    crossing[5] = [0, 0, -5]
    refused(Mesh(crossing, rows), "crosses", "facet", " at (")
    refused(Mesh(points, np.where((np.arange(len(rows)) == 5)[:, None], rows[:, ::-1], rows)),
            "facets 4 and 5", "turned against each other", "edge", " at (")  # fmt: skip
    refused(part(points, rows, (points[rows][:, :, 2] >= 0).all(axis=1) & (np.arange(len(rows)) != 3)),
            "open along a loop", "point", " at (")  # fmt: skip
    bad = points.copy()
    bad[7, 1] = np.nan
    with pytest.raises(InputError, match=r"points\[7\]"):
        Mesh(bad, rows)
    flat = np.concatenate([rows, [(0, 1, 1)]])
    with pytest.raises(UnstructError):
        Mesh(points, flat)
    same = points.copy()
    same[3] = same[2]
    refused(Mesh(same, rows), "points 2 and 3 are equal")
    line = points.copy()
    a, b, c = rows[0]
    line[c] = (line[a] + line[b]) / 2
    refused(Mesh(line, rows), "lie")
    twice = np.concatenate([rows, rows[:1]])
    refused(Mesh(points, twice), "facet")
    refused(Mesh(points[:, :2], rows), "planar")
    refused(42, "surface must be")
    refused(Domain.rectangle(), "bodies in space")


def test_walls_that_touch_are_refused() -> None:
    """Two cubes with a common vertex, and with a common edge."""
    box, other = Domain.box(), Domain.box((1, 1, 1), (2, 2, 2))
    points = np.concatenate([box.points, other.points])
    shells = [box.triangulated.triangles, other.triangulated.triangles + 8]
    same = {tuple(p): i for i, p in reversed(list(enumerate(points.tolist())))}
    number = np.array([same[tuple(p)] for p in points.tolist()])
    rows = number[np.concatenate(shells)]
    used = np.unique(rows)
    place = np.full(16, -1)
    place[used] = np.arange(len(used))
    refused(Domain(points[used], place[rows]), "touch at point", "(1, 1, 1)")
    other = Domain.box((1, 1, 0), (2, 2, 1))
    points = np.concatenate([box.points, other.points])
    same = {tuple(p): i for i, p in reversed(list(enumerate(points.tolist())))}
    number = np.array([same[tuple(p)] for p in points.tolist()])
    sides = [row for row in Domain.box().facets] + [row + 8 for row in other.facets]
    rows = [number[row] for row in sides]
    used = np.unique(np.concatenate(rows))
    place[:] = -1
    place[used] = np.arange(len(used))
    refused(Domain(points[used], [place[row] for row in rows]), "more than two facets", "edge")


def test_no_walls_and_unknown_names() -> None:
    box = Domain.box()
    refused(box, "nowhere", walls="nowhere")
    refused(box, "0..5", walls=[17])
    refused(box, "name no facet", walls=[])
    refused(box, "inside", side="left")
    with pytest.raises(InputError, match="count"):
        prismatic_layers(box, layers=Layers(first=0.1, growth=1.2))
    with pytest.raises(InputError, match="2 values"):
        prismatic_layers(box, layers=Layers(first=[0.1, 0.2], growth=1.2, count=3))
    with pytest.raises(InputError, match="scale the surface"):
        prismatic_layers(Domain(box.points * 1e-100, box.facets), layers=LAYERS)
