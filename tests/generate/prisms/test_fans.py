"""The cells of fans: conforming, positive in rational numbers, faults found."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from unstruct import Domain
from unstruct.generate.prisms.creases import Fans, creases_of, fans_of, usable
from unstruct.generate.prisms.fans import fan_cells, fan_faults, fan_quality, spread_directions, whole_fans
from unstruct.generate.prisms.stars import stars_of
from unstruct.generate.prisms.walls import base_of
from unstruct.mesh.split import simplices_of_cells


def cube() -> tuple[Fans, np.ndarray]:
    """The fans of a cube, and their directions: normals of the sides in the sheets."""
    walls = base_of(Domain.box((-1, -1, -1), (1, 1, 1)), None, "outside").walls
    stars = stars_of(walls.triangles, len(walls.points))
    creases = creases_of(walls, stars)
    kept, crease = usable(walls, stars, creases, np.ones(len(creases.ends), dtype=bool))
    fans = fans_of(walls, stars, creases, kept, crease)
    normal = np.zeros((fans.sheets, 3))
    for column in fans.columns:
        a, b, c = walls.points[fans.base[column]]
        n = np.cross(b - a, c - a)
        normal[column] = n / np.abs(n).max()
    return fans, spread_directions(fans, normal, walls.points / np.sqrt(3.0))


def heights(fans: Fans, direction: np.ndarray, levels: int, step: float) -> np.ndarray:
    walls = base_of(Domain.box((-1, -1, -1), (1, 1, 1)), None, "outside").walls
    rise = step * np.arange(levels + 1)[:, None, None]
    return walls.points[fans.base] + rise * direction


def test_directions_are_spread_evenly() -> None:
    fans, direction = cube()
    np.testing.assert_allclose((direction**2).sum(axis=1), 1.0, atol=1e-15)
    between = fans.between[:, 0] >= 0
    one, two = (direction[fans.between[between, k]] for k in range(2))
    middle = direction[fans.sheets :][between]
    np.testing.assert_allclose((one * middle).sum(axis=1), np.sqrt(0.5), atol=1e-12)
    np.testing.assert_allclose((two * middle).sum(axis=1), np.sqrt(0.5), atol=1e-12)
    # Opposite sides: by way of the single ray.
    flat = np.where(np.arange(fans.sheets)[:, None] % 2 == 0, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0])
    pair = fans._replace(between=np.array([[0, 1]] * 3), share=np.array([0.25, 0.5, 0.75]))
    pair = pair._replace(base=fans.base[: fans.sheets + 3])
    found = spread_directions(pair, flat, np.tile([1.0, 0.0, 0.0], (8, 1)))[fans.sheets :]
    half = np.sqrt(0.5)
    np.testing.assert_allclose(found, [[half, 0, half], [1, 0, 0], [half, 0, -half]], atol=1e-12)


def test_cells_are_positive_in_rational_numbers() -> None:
    """Each tetrahedron of every cell, from the corners as they are; and the cells fit."""
    fans, direction = cube()
    for levels in (1, 3):
        places = heights(fans, direction, levels, 0.125)
        every = np.arange(len(fans.quads) + len(fans.corners))
        assert not len(fan_faults(fans, places, every, True))
        points, cells, _ = whole_fans(fans, places, every, True)
        simplices, _ = simplices_of_cells(cells.kinds)
        x = [[Fraction(v) for v in p] for p in points.tolist()]
        for a, b, c, d in simplices.tolist():
            u, v, w = ([x[i][k] - x[a][k] for k in range(3)] for i in (b, c, d))
            minor = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
            assert sum(minor[k] * w[k] for k in range(3)) > 0
        assert len(cells.part) == sum(map(len, cells.kinds.values())) and set(cells.cap.tolist()) == set(
            range(len(fans.caps))
        )
        assert fan_quality(fans, places).min() > 0.5 or levels == 1


def test_kinds_without_division() -> None:
    fans, _ = cube()
    levels, rays = 3, len(fans.base)
    number = (np.arange(levels + 1)[:, None] * rays + np.arange(rays)).astype(np.int32)
    cells = fan_cells(fans, number)
    assert {kind: len(rows) for kind, rows in cells.kinds.items()} == {
        "hexahedron": 2 * 24,
        "wedge": 24 + 2 * 32,
        "tetra": 32,
    }
    assert not len(cells.centers)


def test_faults_are_found_where_they_are() -> None:
    fans, direction = cube()
    places = heights(fans, direction, 2, 0.125)
    places[1, fans.quads[5, 0]] -= 2 * 0.125 * direction[fans.quads[5, 0]]
    every = np.arange(len(fans.quads) + len(fans.corners))
    found = fan_faults(fans, places, every, False)
    touched = np.asarray(np.isin(fans.quads, fans.quads[5, 0]).any(axis=1))
    assert 5 in found and touched[found[found < len(fans.quads)]].all()
    assert fan_faults(fans, places, np.array([5]), False).tolist() == [5]
    assert not len(fan_faults(fans, places, np.empty(0, dtype=np.int64), False))
