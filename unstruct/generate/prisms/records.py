"""What the steps of prismatic layers hand on: walls, what stands beside them, rays, and why they end.

A *ray* starts at a vertex of a wall. Over each triangle of the wall stands a *column* of cells between three
rays. The points of all layers are the rays' *places*; what is tested, and what the mesh has, are these
rounded places and nothing else.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "COLUMN",
    "CROSSING_RAY",
    "FULL",
    "GRADATION",
    "HIDDEN_RAY",
    "RAY_REASONS",
    "STEP_RAY",
    "Others",
    "Rays",
    "Walls",
]

# Why a ray ends where it does: codes of `Rays.reason`, and their names.
FULL, COLUMN, CROSSING_RAY, GRADATION, HIDDEN_RAY, STEP_RAY = range(6)
RAY_REASONS = ("full", "column", "crossing", "gradation", "hidden", "step")


class Walls(NamedTuple):
    """The part of a surface that carries layers, in its own numbers: n vertices, t triangles, p planes.

    Attributes
    ----------
    points : (n, 3) float64
        The vertices of walls only, as they were given.
    triangles : (t, 3) int32
        Their normals point to the side of the layers.
    vertex : (n,) int32
        The row of each vertex among the points of the surface.
    piece : (t,) int32
        The piece of the domain that each triangle is a part of; of a mesh, its triangle.
    planes : (n, 2) int32
        The planes in which the ray of a vertex has to stay, rows of ``normals``; -1 for none.
    normals : (p, 3) float64
        Unit normals of the planes.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    vertex: NDArray[np.int32]
    piece: NDArray[np.int32]
    planes: NDArray[np.int32]
    normals: NDArray[np.float64]


class Others(NamedTuple):
    """The rest of the surface, which layers must not meet: its points, and o triangles that are no walls.

    Attributes
    ----------
    points : (m, 3) float64
        All points of the surface.
    triangles : (o, 3) int32
        Rows of ``points``.
    plane : (o,) int32
        The plane, a row of `Walls.normals`, in which each lies and layers slide; -1 for none.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    plane: NDArray[np.int32]


class Rays(NamedTuple):
    """Rays, one at each vertex of a wall; with several normals at a vertex more than one.

    Attributes
    ----------
    base : (r,) int32
        Rows of `Walls.points`.
    direction : (r, 3) float64
        Of unit length, up to rounding.
    height : (r,) float64
        The total height of the layers along the ray; 0 where there are none.
    wanted : (r,) float64
        The total height that was asked for.
    level : (r,) int32
        How many layers there are; 0 where the height is 0.
    reason : (r,) int8
        Why there are no more: an index of `RAY_REASONS`.
    """

    base: NDArray[np.int32]
    direction: NDArray[np.float64]
    height: NDArray[np.float64]
    wanted: NDArray[np.float64]
    level: NDArray[np.int32]
    reason: NDArray[np.int8]
