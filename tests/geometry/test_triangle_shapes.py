"""Shapes of planar triangles in one pass: those of `unstruct.simplex`, up to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import unstruct
from unstruct.geometry import simplex
from unstruct.geometry.triangle_shapes import PLANAR_QUALITIES, planar_angles, planar_edges, planar_shapes

RNG = np.random.default_rng(4)
CELLS = np.arange(900, dtype=np.int32).reshape(-1, 3)
SCATTERED = RNG.random((900, 2))
POINTS = {
    "scattered": SCATTERED,
    "integers, often flat or equal": RNG.integers(0, 3, (900, 2)).astype(float),
    "huge": SCATTERED * 1e307,
    "tiny": SCATTERED * 1e-290,
    "subnormal": SCATTERED * 1e-310,
    "wide exponents": np.ldexp(SCATTERED - 0.5, RNG.integers(-60, 60, (900, 2))),
    "exponents too wide for squares": np.ldexp(SCATTERED - 0.5, RNG.integers(-900, 900, (900, 2))),
}


@pytest.mark.parametrize("kind", POINTS)
@pytest.mark.parametrize("name", PLANAR_QUALITIES)
def test_as_of_single_triangles(name: str, kind: str) -> None:
    wanted = simplex.quality(name, POINTS[kind][CELLS])
    found = planar_shapes(name, POINTS[kind], CELLS)
    if found is None:  # left to the general function, as it must be for these only
        assert kind in ("subnormal", "exponents too wide for squares")
    else:
        np.testing.assert_allclose(found, wanted, rtol=1e-14, atol=1e-13)
    np.testing.assert_allclose(
        unstruct.Mesh(POINTS[kind], CELLS).quality(name), wanted, rtol=1e-14, atol=1e-13
    )


def test_others_are_left_to_the_general_function() -> None:
    assert planar_angles(RNG.random((9, 3)), CELLS[:3]) is None
    assert planar_shapes("2r/R", RNG.random((9, 2)), CELLS[:3].astype(np.int64)) is None
    assert planar_shapes("aspect", SCATTERED, CELLS) is None


def test_edges_are_those_that_sorting_finds() -> None:
    mesh = unstruct.refine(unstruct.Domain.naca("2412"), 0.1)
    lengths, middles = planar_edges(mesh.points, mesh.simplices, mesh.neighbors)
    ends = mesh.points[mesh.edges]
    wanted = np.column_stack([np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), ends.mean(axis=1)])
    found = np.column_stack([lengths, middles])
    assert np.array_equal(*(rows[np.lexsort(rows.T)] for rows in (wanted, found)))


def test_neighbors_that_are_not_mutual_are_not_believed() -> None:
    mesh = unstruct.refine(unstruct.Domain.rectangle(), 0.3)
    for wrong in (np.roll(mesh.neighbors, 1, axis=1), np.roll(mesh.neighbors, 1, axis=0)):
        assert planar_edges(mesh.points, mesh.simplices, wrong) is None
        damaged = unstruct.Mesh(mesh.points, mesh.simplices, neighbors=wrong)
        assert repr(unstruct.statistics(damaged, 0.3)) == repr(unstruct.statistics(mesh, 0.3))
    assert planar_edges(mesh.points, mesh.simplices, mesh.neighbors.astype(np.int64)) is None
