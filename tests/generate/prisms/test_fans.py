"""The cells of fans: conforming, positive in rational numbers, faults found."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np

from unstruct import Domain, Mesh
from unstruct.generate.prisms.creases import Fans, creases_of, fans_of, usable
from unstruct.generate.prisms.fans import (
    NO_APEXES,
    apex_heights,
    apexes_of,
    cap_of,
    fan_cells,
    fan_faults,
    fan_quality,
    on_cap,
    spread_directions,
    whole_fans,
)
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


FORMS = ("whole", "halves", "pyramids")


def test_cells_are_positive_in_rational_numbers() -> None:
    """Each tetrahedron of every cell, from the corners as they are; and the cells fit."""
    fans, direction = cube()
    every = np.arange(len(fans.quads) + len(fans.corners))
    for levels, how in itertools.product((1, 3), FORMS):
        places = heights(fans, direction, levels, 0.125)
        apexes = (
            apexes_of(fans, places[-1], np.full(len(fans.quads), 0.5)) if how == "pyramids" else NO_APEXES
        )
        assert not len(fan_faults(fans, places, every, how, apexes, True))
        points, cells, _ = whole_fans(fans, places, every, how, apexes)
        simplices, _ = simplices_of_cells(cells.kinds)
        x = [[Fraction(v) for v in p] for p in points.tolist()]
        for a, b, c, d in simplices.tolist():
            u, v, w = ([x[i][k] - x[a][k] for k in range(3)] for i in (b, c, d))
            minor = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
            assert sum(minor[k] * w[k] for k in range(3)) > 0
        top = np.arange(levels * len(fans.base), (levels + 1) * len(fans.base))
        apex = (levels + 1) * len(fans.base) + np.arange(len(apexes))
        cap = cap_of(fans, how, top, apex)
        assert len(cells.part) == sum(map(len, cells.kinds.values()))
        assert cells.cap.max() < len(cap) == len(on_cap(fans, how, fans.owner))
        faces, found = Mesh(points, None, cells=cells.kinds), {tuple(sorted(row)) for row in cap.tolist()}
        boundary = {tuple(sorted(row)) for row in faces.boundary.tolist()}
        halves = how == "halves"  # of the faces of hexahedra
        assert found <= {row if len(row) == cap.shape[1] else row[1:] for row in boundary} or halves


def test_quality_is_that_of_the_cells() -> None:
    fans, direction = cube()
    places, many = heights(fans, direction, 3, 0.125), len(fans.quads)
    apexes = apexes_of(fans, places[-1], apex_heights(fans, places[0]))
    found = {how: fan_quality(fans, places, how, apexes if how == "pyramids" else NO_APEXES) for how in FORMS}
    assert found["whole"].min() > 0.5 > 0.05 > found["halves"].min()
    assert (found["pyramids"] <= found["whole"]).all()
    for how, form in found.items():
        own = apexes if how == "pyramids" else NO_APEXES
        points, cells, _ = whole_fans(fans, places, np.arange(many), how, own)
        kinds = {"tetra": simplices_of_cells(cells.kinds)[0]} if how == "halves" else cells.kinds
        assert Mesh(points, None, cells=kinds).quality("scaled_jacobian").min() == form[:many].min()


def test_pyramids_stand_upright() -> None:
    """Half as high as the edge below; on a quadrilateral at 45 degrees between two normals."""
    fans, direction = cube()
    places = heights(fans, direction, 2, 0.5)
    height = apex_heights(fans, places[0])
    np.testing.assert_allclose(height, 1.0)
    apexes = apexes_of(fans, places[-1], height)
    x = places[-1][fans.quads]
    rise = apexes - x.mean(axis=1)
    np.testing.assert_allclose((rise**2).sum(axis=1), 1.0)
    for k in range(4):
        np.testing.assert_allclose((rise * (x[:, k] - x[:, k - 1])).sum(axis=1), 0.0, atol=1e-12)
    assert ((rise * x.mean(axis=1)).sum(axis=1) > 0).all()
    tiny = apexes_of(fans, 2.0**-700 * places[-1], 2.0**-700 * height)
    np.testing.assert_allclose(tiny * 2.0**700, apexes)


def test_kinds_of_cells() -> None:
    fans, _ = cube()
    levels, rays = 3, len(fans.base)
    number = (np.arange(levels + 1)[:, None] * rays + np.arange(rays)).astype(np.int32)
    cells = fan_cells(fans, number, "whole")
    assert {kind: len(rows) for kind, rows in cells.kinds.items()} == {
        "hexahedron": 2 * 24,
        "wedge": 24 + 2 * 32,
        "tetra": 32,
    }
    assert set(cells.cap.tolist()) == set(range(24 + 32)) and cells.layer.max() == 2
    cells = fan_cells(fans, number, "pyramids", np.arange(24) + 1000)
    assert len(cells.kinds["pyramid"]) == 24 and cells.layer.max() == 3
    assert set(cells.cap.tolist()) == set(range(0, 4 * 24, 4)) | set(range(4 * 24, 4 * 24 + 32))


def test_faults_are_found_where_they_are() -> None:
    fans, direction = cube()
    places = heights(fans, direction, 2, 0.125)
    places[1, fans.quads[5, 0]] -= 2 * 0.125 * direction[fans.quads[5, 0]]
    every = np.arange(len(fans.quads) + len(fans.corners))
    found = fan_faults(fans, places, every, "whole", NO_APEXES)
    touched = np.asarray(np.isin(fans.quads, fans.quads[5, 0]).any(axis=1))
    assert 5 in found and touched[found[found < len(fans.quads)]].all()
    assert fan_faults(fans, places, np.array([5]), "whole", NO_APEXES).tolist() == [5]
    assert not len(fan_faults(fans, places, np.empty(0, dtype=np.int64), "whole", NO_APEXES))
    places = heights(fans, direction, 2, 0.125)
    apexes = apexes_of(fans, places[-1], np.where(np.arange(len(fans.quads)) == 7, -0.1, 0.1))
    assert fan_faults(fans, places, every, "pyramids", apexes).tolist() == [7]
