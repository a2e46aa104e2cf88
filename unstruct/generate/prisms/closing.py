"""A surface that ends in planes, closed by polygons there, so that it encloses a body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.space.surfaces import parts_of
from ...geometry.polygons import Polygons
from ...mesh.mesh import Mesh

__all__ = ["Closed", "closed_in_planes"]

Array = NDArray[np.float64]
NEAR_PLANE = 1e-6  # of the extent of a loop: how far another one may be from its plane, to lie in it


class Closed(NamedTuple):
    """A closed surface.

    Attributes
    ----------
    domain : Domain
        The facets of the mesh, then a polygon for each end, named "end 0", "end 1", ...
    walls : (f,) int64
        The facets of the mesh.
    origin : (n,) int32
        The vertex of the mesh that each point is.
    """

    domain: Domain
    walls: NDArray[np.int64]
    origin: NDArray[np.int32]


def closed_in_planes(surface: Mesh) -> Closed | None:
    """The body that a surface and the planes of its border enclose; None if there is no border.

    Parameters
    ----------
    surface : Mesh
        Of triangles in space. A loop of its border within another one in the same plane is a hole of the end.

    Raises
    ------
    InputError
        If the border is no set of loops; and as `Domain` does.
    """
    found = parts_of(surface, "surface")
    parts = found.parts
    loops = _loops(parts["facets"])
    if not loops:
        return None
    ends = _with_holes(parts["points"], loops)
    many = len(parts["facets"])
    names = {f"end {k}": [many + k] for k in range(len(ends))}
    domain = Domain(
        parts["points"],
        Polygons.joined(Polygons.of(parts["facets"]), Polygons.of_rings(ends)),
        markers=dict(parts["markers"]) | names,
        regions=parts.get("regions"),
    )
    return Closed(domain, np.arange(many), np.asarray(found.origin))


def _loops(facets: Polygons) -> list[list[int]]:
    """The border, loop by loop, in the direction of its facets."""
    ends = facets.sides[0].astype(np.int64)
    low, high = np.sort(ends, axis=1).T
    _, which, count = np.unique(low << 32 | high, return_inverse=True, return_counts=True)
    border = ends[count[which.ravel()] % 2 == 1]
    follow = dict(border.tolist())
    if len(follow) != len(border):
        vertex = int(np.argmax(np.bincount(border[:, 0])))
        raise InputError(
            f"several loops of the border of the surface meet at point {vertex}: move them apart"
        )
    loops = []
    while follow:
        first = next(iter(follow))
        loop, v = [], first
        while v in follow:
            loop.append(v)
            v = follow.pop(v)
        if v != first:
            raise InputError(f"the border of the surface is no loop at point {v}: turn its triangles alike")
        loops.append(loop)
    return loops


def _with_holes(points: Array, loops: list[list[int]]) -> list[list[list[int]]]:
    """Each loop that is in no other one, or in an even number, with those directly within."""
    many = len(loops)
    within = np.array(
        [[i != j and _is_within(points, a, b) for j, b in enumerate(loops)] for i, a in enumerate(loops)]
    )
    depth = within.reshape(many, many).sum(axis=1)
    polygons = []
    for j in np.flatnonzero(depth % 2 == 0).tolist():
        holes = [i for i in range(many) if within[i, j] and depth[i] == depth[j] + 1]
        polygons.append([loops[j], *(loops[i] for i in holes)])
    return polygons


def _is_within(points: Array, one: list[int], other: list[int]) -> bool:
    """Whether the first loop lies in the plane of the second, and inside of it."""
    x = points[other] - points[other[0]]
    after = np.roll(x, -1, axis=0)
    normal = np.cross(x, after).sum(axis=0)
    normal = normal / max(float(np.sqrt((normal * normal).sum())), 1e-300)
    y = points[one] - points[other[0]]
    if np.abs((y * normal).sum(axis=1)).max() > NEAR_PLANE * float(np.ptp(x, axis=0).max()):
        return False
    i, j = np.delete(np.arange(3), int(np.abs(normal).argmax()))
    a, b, p = x[:, [i, j]], after[:, [i, j]], y[0, [i, j]]
    crosses = (a[:, 1] > p[1]) != (b[:, 1] > p[1])
    rise = np.where(crosses, b[:, 1] - a[:, 1], 1.0)
    place = a[:, 0] + (p[1] - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return bool((crosses & (place > p[0])).sum() % 2)
