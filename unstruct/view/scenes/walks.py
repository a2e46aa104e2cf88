"""A walk through a mesh to a point that the reader moves, with the powers on the way (chapter 1)."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from ...base.errors import InputError
from ...connect.insertion.delaunay import delaunay
from ...mesh.mesh import Mesh
from ...plain.adjacency import walk
from ..draw import frames as fr

__all__ = ["WALK_MESHES", "walk_mesh", "walk_powers", "walk_state"]

WALK_MESHES = ("Delaunay", "nasty: a pinwheel", "nasty: with a hole")
PINWHEEL = (
    [(10, 0), (-5, 9), (-5, -9), (-9, 12), (-6, -14), (15, 2), (0, 0)],
    [(6, 0, 1), (6, 1, 2), (6, 2, 0), (0, 3, 1), (1, 3, 4), (1, 4, 2), (2, 4, 5), (2, 5, 0), (0, 5, 3)],
)
HOLE = (7.0, 6.0)  # the triangles about this place are left out


@cache
def walk_mesh(name: str) -> tuple[Mesh, int]:
    """The mesh of a name in `WALK_MESHES`, in a box of 16 by 12, and the triangle where walks begin."""
    if name == "nasty: a pinwheel":
        points, cells = PINWHEEL
        return Mesh(np.array(points) * [0.5, 0.375] + [6.0, 6.0], cells), 3
    if name not in WALK_MESHES:
        raise InputError(f"no mesh {name!r}; use one of {', '.join(WALK_MESHES)}")
    x, y = np.meshgrid(np.arange(0.0, 17.0, 2.0), np.arange(0.0, 13.0, 2.0))
    moved = np.round(16 * np.random.default_rng(6).uniform(-0.6, 0.6, (*x.shape, 2))) / 16
    moved[[0, -1], :, 1] = 0.0
    moved[:, [0, -1], 0] = 0.0
    mesh = delaunay((np.stack([x, y], axis=2) + moved).reshape(-1, 2))
    if name == "nasty: with a hole":
        away = np.abs(mesh.corners.mean(axis=1) - HOLE).max(axis=1)
        mesh = mesh.select(np.flatnonzero(away > 2.0))
    return mesh, int(mesh.corners.sum(axis=(1, 2)).argmin())


def walk_powers(corners: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The power of q with respect to the circumcircle of each triangle ``(k, 3, 2)``."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], q - corners[:, 0]
    square = [(x * x).sum(axis=1) for x in (u, v, w)]
    twice = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    center_x = (square[0] * v[:, 1] - square[1] * u[:, 1]) / twice
    center_y = (square[1] * u[:, 0] - square[0] * v[:, 0]) / twice
    return square[2] - w[:, 0] * center_x - w[:, 1] * center_y


def walk_state(x: float = 12.0, y: float = 9.0, mesh: str = "Delaunay") -> fr.Frame:
    """The walk to the point (x, y), which the reader can drag.

    Parameters
    ----------
    x, y : float
        The point; outside of the mesh, too.
    mesh : str
        One of `WALK_MESHES`.

    Returns
    -------
    dict
        A frame. Its caption says how the walk ends; the number has the powers of the point with respect to
        the first and last circles, and whether they fell at every step.
    """
    found, start = walk_mesh(mesh)
    q = np.array([x, y], dtype=float)
    path = walk(found.points, found.simplices.tolist(), found.neighbors.tolist(), start, q)
    seen = [t for t in path if t >= 0]
    steps = len(path) - 1
    if path[-1] < 0:
        inside = int(found.find_simplex(q)) >= 0
        caption = f"{steps} steps, then the mesh ends" + (", though the point is in it" if inside else "")
    elif path.count(path[-1]) > 1:
        caption = f"triangle {path[-1]} for the second time: it goes round for ever"
    else:
        caption = f"it arrives after {steps} step{'s' if steps != 1 else ''}"
    powers = walk_powers(found.corners[seen], q)
    falls = bool((np.diff(powers) < 0).all())
    number = f"power {powers[0]:.1f} → {powers[-1]:.1f}, " + (
        "falling at each step" if falls else "not always falling"
    )
    middles = found.corners[seen].mean(axis=1)
    ends = [*pairwise(middles), (middles[-1], q)]
    items = [
        fr.polygons("cell", found.corners),
        fr.polygons("accepted", found.corners[sorted(set(seen))]),
        fr.polygons("highlight", found.corners[[start]]),
        fr.segments("layer", ends),
        fr.dots("inserted", [q], handles=["q"]),
    ]
    return fr.frame(caption, *items, number=number.replace("-", "−"), view=[-1.0, 17.0, -1.0, 13.0])
