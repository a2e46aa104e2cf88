"""The work ``remeshing`` of the suite ``surface``: surfaces remeshed to a size beside pymeshlab.

*sphere*, *torus*, *implicit body* (what marching cubes of PyVista make of a level set, slivers and all) and
*wavy sheet* (open, scattered points) are given as scans are: with triangles half as long as the size, or less.
Their curvature is such that hardly any size must be lowered to stay within a hundredth of it: a size h leaves
the triangles about h^2 k / 6 from a surface of curvature k. A *plate with holes* is given as CAD systems write
it, triangles from hole to hole and needles along the walls, whose facets are about as wide as the size, or
wider: the default admits more distance there; *within .01* asks for a hundredth of the size all the same. Its
creases are to be kept. pymeshlab remeshes in ten rounds, with the same angle of creases, and moves its points
back onto the given surface. Our time has the distances, the exact test for crossings and all other accounts in
it.

Distances are measured for both alike, at samples, both ways, in sizes. ``corners`` is how far a corner of the
creases is from the nearest vertex, ``creases`` how far a place on them is from the nearest edge.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher, several

SHARP = 40.0
ROUNDS_OF_PEER = 10
FINER = 0.5  # the given triangles, in sizes
HUNDREDTH = 0.01  # the deviation that is asked for, in sizes
EQUILATERAL = 0.4330127  # the area of a triangle of size 1
SAMPLES_OF_CREASES = np.linspace(0.0, 1.0, 9)[:, None]
WAVES = 0.05  # the height of those of the sheet of side 1
PLATE, NEAR_PLATE = "plate with holes", "plate with holes, within .01"
AREAS = {"sphere": 12.566, "torus": 15.791, "implicit body": 25.57, "wavy sheet": 1.025, PLATE: 9.4}
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "remeshing": {
        "wavy sheet": (10_000,), "sphere": (100_000,), "torus": (100_000,), "implicit body": (100_000,),
        PLATE: (10_000, 100_000), NEAR_PLATE: (10_000, 100_000),
    }
}  # fmt: skip
__all__ = ["MESHERS", "PLAN", "Rough", "measures", "task", "warm_up"]


class Rough(NamedTuple):
    """A task: a surface of any triangles, the wanted length of edges, the distance allowed (None: default)."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    size: float
    deviation: float | None


def _of_domain(domain: Any) -> tuple[NDArray, NDArray]:
    return np.array(domain.points), np.array(domain.triangulated.triangles)


def _implicit(h: float) -> tuple[NDArray, NDArray]:
    """A body of three merged balls with a dent, by marching cubes."""
    import pyvista

    count = round(4.4 / h) + 1
    grid = pyvista.ImageData(dimensions=(count,) * 3, spacing=(h,) * 3, origin=(-2.2,) * 3)
    x = np.asarray(grid.points)
    centers = np.array([[-0.7, 0.1, 0.0], [0.6, 0.2, 0.1], [0.0, -0.6, -0.2]])
    value = sum(np.exp(-1.4 * ((x - c) ** 2).sum(axis=1)) for c in centers)
    value = value - 0.3 * np.exp(-3.0 * ((x - [0.1, 0.5, 0.7]) ** 2).sum(axis=1))
    grid["value"] = value
    made = grid.contour([0.25], scalars="value").triangulate()
    return np.array(made.points, dtype=np.float64), np.array(made.faces.reshape(-1, 4)[:, 1:], dtype=np.int32)


def _sheet(h: float) -> tuple[NDArray, NDArray]:
    """A wavy sheet over the unit square: a grid whose inner points are shaken."""
    from unstruct import delaunay

    n = round(1.0 / h)
    x = np.stack(np.meshgrid(*2 * [np.arange(n + 1) / n], indexing="ij"), axis=-1).reshape(-1, 2)
    inner = ((x > 0.0) & (x < 1.0)).all(axis=1)
    x[inner] += np.random.default_rng(8).uniform(-0.35 / n, 0.35 / n, (int(inner.sum()), 2))
    z = WAVES * np.cos(2 * np.pi * x[:, 0]) * np.cos(2 * np.pi * x[:, 1])
    return np.column_stack([x, z]), np.array(delaunay(x).simplices)


def _plate(_: float) -> tuple[NDArray, NDArray]:
    from unstruct import Domain

    angle = 2 * np.pi * np.arange(48) / 48
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    holes = [
        0.3 * ring + [0.6, 0.6],
        0.2 * ring + [1.4, 0.5],
        0.25 * ring + [1.5, 1.3],
        0.15 * ring + [0.5, 1.5],
    ]
    planar = Domain.polygon([[0, 0], [2, 0], [2, 2], [0, 2]], holes)
    return _of_domain(Domain.extruded(planar, 0.25))


def task(work: str, kind: str, n: int) -> Rough:
    """A surface on which about n triangles of the size have room."""
    from unstruct import Domain

    body = PLATE if kind == NEAR_PLATE else kind
    h = float(np.sqrt(AREAS[body] / (EQUILATERAL * n)))
    made: dict[str, Callable[[], tuple[NDArray, NDArray]]] = {
        "sphere": lambda: _of_domain(Domain.ball(size=FINER * h)),
        "torus": lambda: _of_domain(Domain.torus(size=FINER * h)),
        "implicit body": lambda: _implicit(FINER * h),
        "wavy sheet": lambda: _sheet(FINER * h),
        PLATE: lambda: _plate(h),
    }
    points, triangles = made[body]()
    return Rough(points, triangles, h, HUNDREDTH * h if kind == NEAR_PLATE else None)


def warm_up(work: str) -> Rough:
    """A small task with creases: compiled code is loaded."""
    return task(work, PLATE, 2000)


def _ours(given: Rough) -> Any:
    import warnings

    from unstruct import Mesh, remesh

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = remesh(Mesh(given.points, given.triangles), given.size, sharp=SHARP, deviation=given.deviation)
    return mesh.points, mesh.simplices, mesh


def _pymeshlab(given: Rough) -> Any:
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(given.points, given.triangles))
    meshes.meshing_isotropic_explicit_remeshing(
        iterations=ROUNDS_OF_PEER, targetlen=pymeshlab.PureValue(given.size), featuredeg=SHARP
    )
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix(), None


MESHERS = [
    Mesher("unstruct", "unstruct", "remeshing", several(_ours)),
    Mesher("pymeshlab", "pymeshlab", "remeshing", several(_pymeshlab)),
]


def _character(triangles: NDArray) -> int:
    """The Euler characteristic."""
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return len(np.unique(triangles)) - len(np.unique(sides, axis=0)) + len(triangles)


def measures(points: NDArray, triangles: NDArray, mesh: Any, work: str, given: Rough) -> dict[str, Any]:
    """Angles, distances in sizes, and whether the result has the topology, is embedded and has the creases."""
    from scipy.spatial import KDTree

    from unstruct import Mesh
    from unstruct.geometry.embedded import meeting_pairs
    from unstruct.geometry.support import Support
    from unstruct.geometry.triangle_tree import TriangleTree

    rows = np.ascontiguousarray(triangles, dtype=np.int32)
    angle = Mesh(points, rows).quality("min_angle")
    support = Support(given.points, given.triangles, sharp=SHARP)
    there, back = support.deviation(points, rows)
    sides = np.sort(rows[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    found: dict[str, Any] = {
        "cells": len(rows),
        "given": len(given.triangles),
        "min_angle": float(angle.min()),
        "percentile": float(np.percentile(angle, 0.1)),
        "below_30": float((angle < 30.0).mean()),
        "deviation": max(there, back) / given.size,
        "topology": bool((count <= 2).all()) and _character(rows) == _character(given.triangles),
        "crossings": len(meeting_pairs(points, rows)),
        "corners": 0.0,
        "creases": 0.0,
    }
    if len(support.corners):
        away = KDTree(points).query(given.points[support.corners])[0]
        found["corners"] = float(away.max()) / given.size
    if len(support.features):
        x = given.points[support.features]
        x = (x[:, :1] * (1.0 - SAMPLES_OF_CREASES) + x[:, 1:] * SAMPLES_OF_CREASES).reshape(-1, 3)
        corners = points[edges][:, [0, 1, 1]]
        which, weights = TriangleTree(corners).nearest(x)
        near = (corners[which] * weights[:, :, None]).sum(axis=1)
        found["creases"] = float(np.sqrt(((near - x) ** 2).sum(axis=1).max())) / given.size
    if mesh is not None:
        found |= {"unrefined": len(mesh.unrefined), "lowered": mesh.counts["lowered"] / len(points)}
    return found
