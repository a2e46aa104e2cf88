"""A prism that is twisted until no tetrahedron fits into it."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ...geometry.simplex import volume
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["TWISTED_WALLS", "twisted_prism", "twisted_prism_state"]

FLAT_VOLUME = 1e-9  # of a tetrahedron whose volume is zero but for rounding; the prism's is more than 1
# The faces of the twisted prism, seen from outside: bottom, top, and two for each side.
TWISTED_WALLS = ((0, 2, 1), (3, 4, 5), *((i, (i + 1) % 3, 3 + (i + 1) % 3) for i in range(3)),
                 *((i, 3 + (i + 1) % 3, 3 + i) for i in range(3)))  # fmt: skip
NOT_JOINED = ((0, 5), (1, 3), (2, 4))  # the pairs of vertices without an edge


def twisted_prism(twist: float) -> np.ndarray:
    """Six vertices: a regular triangle, and the same triangle above, turned by so many degrees.

    Its faces are `TWISTED_WALLS`. At 30 degrees it is Schönhardt's polyhedron.
    """
    angles = np.radians([90.0, 210.0, 330.0, 90.0 + twist, 210.0 + twist, 330.0 + twist])
    return np.column_stack([np.cos(angles), np.sin(angles), np.repeat([0.0, 1.6], 3)])


def twisted_prism_state(twist: float = 30.0, seen_from: float = -60.0) -> fr.Frame:
    """A prism whose upper triangle is turned, with the three pairs of vertices that no edge joins.

    Parameters
    ----------
    twist : float
        In degrees, from -60 to less than 60. At 0 the three pairs are diagonals of the sides, which are flat
        then; with a negative twist the solid is convex, with a positive one the pairs are outside of it.
    seen_from : float
        The direction from which the reader looks, in degrees.

    Returns
    -------
    dict
        The solid, and whether there are tetrahedra on its six vertices that have its faces: if a pair is
        inside, the four around it are an example.
    """
    corners = twisted_prism(twist)
    fits = _around(corners, NOT_JOINED[0])
    flat = abs(float(volume(corners[[0, 2, 3, 5]]))) < FLAT_VOLUME  # one of the sides
    where = "on its sides" if flat else "inside" if fits else "outside"
    edges = sorted({tuple(sorted(pair)) for f in TWISTED_WALLS for pair in combinations(f, 2)})
    scene = [
        item3("polygons", "accepted", TWISTED_WALLS, corners, opacity=0.35),
        item3("segments", "edge", edges, corners),
        item3("segments", "waiting" if fits else "bad", NOT_JOINED, corners),
        item3("labels", "vertex", corners, text=range(6)),
    ]
    ending = "four tetrahedra fill it" if fits else "no tetrahedron fits its faces"
    number = f"the dashed segments are {where}: {ending}"
    return space_frame(scene, f"twisted by {twist:g}°", number=number, azimuth=seen_from, elevation=24)


def _around(corners: np.ndarray, pair: tuple[int, int]) -> bool:
    """Whether four tetrahedra around a pair fill the solid: one for each edge opposite to it."""
    a, b = pair
    turned = [(a, f[(f.index(a) + 2) % 3], f[(f.index(a) + 1) % 3]) for f in TWISTED_WALLS if a in f]
    return all(float(volume(corners[[*face, b]])) > FLAT_VOLUME for face in turned)
