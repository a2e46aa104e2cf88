"""What is lost or filled, by distance and by how surfaces are connected: one account for both methods."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generate.hexahedra.test_dominant import SIDES, UNIT
from unstruct import Domain, IncompleteWarning, isosurface_stuffing, octree
from unstruct.generate.stuffing.account import connected_otherwise, lost_or_filled

Surface = tuple[np.ndarray, np.ndarray]


def triangles(body: Domain) -> Surface:
    shell = body.triangulated
    return shell.points, np.asarray(shell.bounding)


def joined(*surfaces: Surface) -> Surface:
    start = np.cumsum([0, *(len(points) for points, _ in surfaces)])
    rows = [faces + k for (_, faces), k in zip(surfaces, start, strict=False)]
    return np.concatenate([points for points, _ in surfaces]), np.concatenate(rows)


def box(low: tuple[float, ...], high: tuple[float, ...]) -> Domain:
    return Domain.box(low, high)


def two(step: list[float]) -> Surface:
    """Two unit cubes."""
    points, number = np.unique(np.concatenate([UNIT, UNIT + step]), axis=0, return_inverse=True)
    return triangles(Domain(points, number.ravel()[np.concatenate([SIDES, SIDES + 8])]))


def test_connection() -> None:
    cube, torus = triangles(Domain(UNIT, SIDES)), triangles(Domain.torus(size=0.3))
    assert connected_otherwise(cube, triangles(Domain.ball(size=0.5))) == {}
    told = "the boundary there has 1 components and Euler characteristic 0, the body's surface has 1 and 2"
    assert connected_otherwise(cube, torus) == {0: told}
    assert "2 components and Euler characteristic 4" in connected_otherwise(cube, two([2, 0, 0]))[0]
    assert connected_otherwise(two([2, 0, 0]), two([2.1, 0, 0])) == {}
    assert list(connected_otherwise(two([3, 0, 0]), cube)) == [1]


@pytest.mark.parametrize("step", [[1, 1, 0], [1, 1, 1]])
def test_nothing_is_said_of_surfaces_that_touch_themselves(step: list[int]) -> None:
    assert connected_otherwise(two(step), two([2, 0, 0])) == {}
    assert connected_otherwise(two([2, 0, 0]), two(step)) == {}


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(0, 3), min_size=1, max_size=4), st.integers(0, 3))
def test_as_counted_one_by_one(kinds: list[int], lost: int) -> None:
    """Balls, cubes, tori and double tori in a row, of which one is lost, or is another."""
    ball, ring = triangles(Domain.ball(size=0.8)), triangles(Domain.torus(size=0.5))
    makes = [ball, (UNIT - 0.5, np.asarray(Domain(UNIT, SIDES).triangulated.bounding)), ring, ball]
    euler = [2, 2, 0, 2]
    row = [(makes[k][0] + [6.0 * i, 0, 0], makes[k][1]) for i, k in enumerate(kinds)]
    lost %= len(kinds)
    other = [s for i, s in enumerate(row) if i != lost]
    if other:
        assert list(connected_otherwise(joined(*row), joined(*other))) == [lost]
    other = list(row)
    other[lost] = (ring[0] + [6.0 * lost, 0, 0], ring[1])
    differ = connected_otherwise(joined(*row), joined(*other))
    assert list(differ) == ([] if euler[kinds[lost]] == 0 else [lost])


def by_place(mesh) -> list[list[float]]:
    found = [re.search(r"farthest place is near \(([^)]*)\)", why) for why in mesh.reasons.tolist()]
    return [[float(x) for x in hit[1].split(",")] for hit in found if hit]


def mesh_of(body: Domain, how: str, size: float):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        return isosurface_stuffing(body, size) if how == "stuffed" else octree(body, size).mesh("cut")


@pytest.mark.parametrize("how", ["stuffed", "cut"])
def test_a_lost_cavity_and_a_lost_component_are_named_by_place(how: str) -> None:
    body = box((0, 0, 0), (1, 1, 1)).with_holes(box((0.59, 0.59, 0.59), (0.61, 0.62, 0.61)))
    mesh = mesh_of(body, how, 0.13)
    assert not mesh.complete
    assert any(np.allclose(place, 0.6, atol=0.021) for place in by_place(mesh))
    crumb = box((1.31, 0.41, 0.41), (1.34, 0.43, 0.43))
    points = np.concatenate([UNIT, crumb.points])
    facets = [*SIDES.tolist(), *[[k + 8 for k in row] for row in crumb.facets]]
    mesh = mesh_of(Domain(points, facets), how, 0.13)
    assert any(place[0] > 1.3 for place in by_place(mesh))


@pytest.mark.parametrize("how", ["stuffed", "cut"])
def test_a_filled_tunnel_is_named_by_place(how: str) -> None:
    """A plate with a thin hole: no place is far from the boundary, but the Euler characteristic differs."""
    hole = [(0.505, 0.505), (0.525, 0.505), (0.525, 0.525), (0.505, 0.525)]
    plate = Domain.extruded(Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)], holes=[hole]), 0.21)
    mesh = mesh_of(plate, how, 0.1)
    assert not mesh.complete
    told = "Euler characteristic 2, the body's surface has 1 and 0"
    assert any(told in why for why in mesh.reasons.tolist())


@pytest.mark.parametrize("how", ["stuffed", "cut"])
def test_a_filled_slit_is_named_by_place(how: str) -> None:
    comb = [(0, 0), (1, 0), (1, 1), (0.54, 1), (0.54, 0.3), (0.52, 0.3), (0.52, 1), (0, 1)]
    mesh = mesh_of(Domain.extruded(Domain.polygon(comb), 0.5), how, 0.1)
    assert not mesh.complete
    assert any("thinner than a" in why and "away" in why for why in mesh.reasons.tolist())


def test_smooth_bodies_lose_nothing() -> None:
    for body in (Domain.ball(size=0.3), Domain.torus(size=0.2), box((0, 0, 0), (1, 0.7, 0.4))):
        for how in ("stuffed", "cut"):
            assert mesh_of(body, how, 0.15).complete


def test_without_places_of_a_component_any_place_is_named() -> None:
    surface = joined(triangles(Domain(UNIT, SIDES)), triangles(box((3, 0, 0), (4, 1, 1))))
    points, faces = triangles(Domain(UNIT, SIDES))
    samples = (points, np.ones(len(points)))
    reasons, most = lost_or_filled(samples, surface, (points, faces, np.arange(len(faces))), "cell")
    assert most == 0.0
    assert len(reasons) == 1
