"""The fast steps of prismatic layers beside the plain ones, on small random bodies and on integers."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, Layers, delaunay, prismatic_layers
from unstruct.generate.prisms.columns import bad, limits
from unstruct.generate.prisms.directions import most_normal, staged
from unstruct.generate.prisms.heights import edges_of_columns, graded
from unstruct.generate.prisms.records import Walls
from unstruct.generate.prisms.stars import unit_normals
from unstruct.generate.prisms.visibility import visible
from unstruct.generate.prisms.walls import base_of
from unstruct.plain import prism_normals, prisms


def walls_of(seed: int, count: int, unit: float) -> Walls:
    """A hull of points of a grid: flat sides of several triangles, ridges, corners."""
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(-3, 4, (count, 3)), axis=0) * unit
    hull = delaunay(points).boundary
    used, number = np.unique(hull, return_inverse=True)
    return base_of(Domain(points[used], number.reshape(-1, 3)), None, "outside").walls


def plain(walls: Walls) -> tuple[list, list]:
    return [tuple(p) for p in walls.points.tolist()], [tuple(t) for t in walls.triangles.tolist()]


SEEDS, COUNTS = st.integers(0, 10**6), st.integers(12, 40)


@settings(max_examples=25)
@given(SEEDS, COUNTS, st.sampled_from([1.0, 2.0**-40, 1e20]), st.sampled_from([20.0, 40.0, 75.0]))
def test_stages(seed: int, count: int, unit: float, ridge: float) -> None:
    walls = walls_of(seed, count, unit)
    normals = unit_normals(walls.points, walls.triangles)[0]
    pairs = np.abs(np.degrees(np.arccos(np.clip(normals @ normals.T, -1, 1))) - ridge)
    if pairs.min() < 1e-6:
        return  # which edges are geometric is up to rounding
    found = prism_normals.staged_normals(*plain(walls), ridge)
    np.testing.assert_allclose(staged(walls, ridge), found, atol=1e-9)


@settings(max_examples=15)
@given(SEEDS, COUNTS)
def test_most_normal_directions_and_what_they_see(seed: int, count: int) -> None:
    walls = walls_of(seed, count, 1.0)
    points, triangles = plain(walls)
    directions, least = most_normal(walls)
    seen = visible(walls, directions)
    normals = [prisms.unit(prisms.normal_of(points, t)) for t in triangles]
    for v, direction in enumerate(directions.tolist()):
        around = [n for n, t in zip(normals, triangles) if v in t]
        best = prism_normals.most_normal(around)
        assert best is not None and seen[v]
        assert least[v] == pytest.approx(min(prisms.scalar(best, n) for n in around), abs=1e-9)
        assert seen[v] == prism_normals.sees(points, triangles, v, tuple(direction))


@settings(max_examples=25)
@given(SEEDS, st.floats(0.05, 3.0), st.floats(0.1, 2.0))
def test_limits_and_heights(seed: int, tall: float, slope: float) -> None:
    walls = walls_of(seed, 20, 1.0)
    points, triangles = plain(walls)
    rng = np.random.default_rng(seed)
    directions, _ = most_normal(walls)
    directions = directions + 0.2 * rng.normal(size=directions.shape)
    found = limits(walls.points, directions, walls.triangles)
    for t, limit in zip(walls.triangles, found.tolist()):
        base, rays = walls.points[t].tolist(), directions[t].tolist()
        if min(q[0] for q in prisms.quadratics(base, rays)) > 1e-9:
            assert limit == pytest.approx(prisms.column_limit(base, rays), rel=1e-6)
    height = tall * rng.random(len(points))
    lowered, _ = graded(
        walls.points, edges_of_columns(walls.triangles), height, np.zeros(len(height), np.int8), slope
    )
    expected = prisms.graded_heights(points, triangles, height.tolist(), slope)
    np.testing.assert_allclose(lowered, expected, rtol=1e-12)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from([1, 2, 4]))
def test_wedges_of_columns_on_integers(seed: int, levels: int) -> None:
    """Rays over one triangle with corners and steps of small integers: degenerate in every way."""
    rng = np.random.default_rng(seed)
    start = np.concatenate([rng.integers(-2, 3, (1, 3, 3)), rng.integers(-1, 3, (levels, 3, 3))])
    places = np.cumsum(start, axis=0).astype(float)
    columns = np.array([[0, 1, 2], [1, 2, 0], [0, 2, 1]], dtype=np.int32)
    found = set(bad(places, columns).tolist())
    for i, row in enumerate(columns.tolist()):
        rows = places[:, row].astype(int).tolist()
        good = all(prisms.wedge_is_positive(low, high) for low, high in pairwise(rows))
        assert (i in found) != good


@pytest.mark.filterwarnings("ignore")
def test_every_wedge_of_a_small_mesh_by_fractions() -> None:
    walls = walls_of(5, 30, 1.0)
    mesh = prismatic_layers(
        Domain(walls.points, walls.triangles), layers=Layers(first=0.3, growth=1.3, count=4)
    )
    for row in mesh.points[np.asarray(mesh.cells["wedge"])].tolist():
        assert prisms.wedge_is_positive(row[:3], row[3:])
    share = mesh.steps["height"] / mesh.steps["wanted"]
    assert share.max() <= 1.0 and (mesh.steps["height"] > 0).all()
