"""Polygons in space cut into triangles: what all that follows works on.

A polygon is seen along the axis along which it appears largest, and triangulated there, exactly, as a
constrained Delaunay triangulation. Sides of other pieces that join two of its vertices are edges of it, so
that an inner piece may end in its plane. The vertices of a polygon seldom lie in a plane exactly. So the rule
is: the facet *is* its triangles. It must be flat up to `PLANAR` of its extent, because the triangles would
else depend on the choice of the view.
"""

from __future__ import annotations

from math import fsum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import frozen
from ...base.jit import kernel
from ...geometry.polygons import Polygons
from ...geometry.triangle_pairs import side, turn, unit_points
from ..plane.faults import Fault
from .flat import NO_ENDS, chords_of, sides_of, triangulated

__all__ = ["PLANAR", "Shell", "at", "cut", "place", "views"]

TIE = 2.0**-40  # squares of diagonals differ by less, in parts of their sum, if both are as long
PLANAR = 1e-3  # a vertex may be so far from the plane of its polygon; unit: the extent of the polygon


def place(point: np.ndarray) -> tuple[float, ...]:
    """The coordinates of a point as a tuple."""
    return tuple(map(float, point))


def at(point: np.ndarray) -> str:
    """The same for messages."""
    return "at (" + ", ".join(f"{x:.17g}" for x in point) + ")"


class Shell(NamedTuple):
    """The pieces of a body as triangles and segments.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (t, 3) int32
        Those of all facets and inner facets, in the direction of their polygons.
    piece : (t,) int32
        The piece of each triangle.
    segments : (s, 2) int32
        The inner segments.
    segment_piece : (s,) int32
        Their pieces.
    facets : int
        How many pieces are facets; these come first.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    piece: NDArray[np.int32]
    segments: NDArray[np.int32]
    segment_piece: NDArray[np.int32]
    facets: int

    @property
    def bounding(self) -> NDArray[np.int32]:
        """The triangles of facets."""
        return self.triangles[self.piece < self.facets]


@kernel
def _quads(xyz, rows, view, outward, cells):
    """Cut convex quadrilaterals along the diagonal that is shorter; of others the first entry is -1.

    If they are as long as each other, up to rounding, the corners lie on a circle, and seldom in a plane
    exactly. The diagonal on the inner side is taken then: the flat tetrahedron of the corners lies outside,
    and is no cell of any mesh. ``outward`` is 1 if facets face outward, else -1. Returns how many were cut.
    """
    done = 0
    for i in range(rows.shape[0]):
        a, b, c, d = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]
        j, k = view[i] // 3, view[i] % 3
        s = turn(xyz, j, k, a, b, c)
        cells[i, 0] = -1
        if (
            s == 0
            or turn(xyz, j, k, b, c, d) != s
            or turn(xyz, j, k, c, d, a) != s
            or turn(xyz, j, k, d, a, b) != s
        ):
            continue
        one = two = 0.0
        for m in range(3):
            one += (xyz[a, m] - xyz[c, m]) ** 2
            two += (xyz[b, m] - xyz[d, m]) ** 2
        first = one < two or (one == two and min(a, c) < min(b, d))
        if abs(one - two) <= TIE * (one + two):
            above = outward * side(xyz, a, b, c, d)
            first = above > 0 or (above == 0 and first)
        if first:
            cells[i, 0], cells[i, 1], cells[i, 2] = a, b, c
            cells[i, 3], cells[i, 4], cells[i, 5] = a, c, d
        else:
            cells[i, 0], cells[i, 1], cells[i, 2] = a, b, d
            cells[i, 3], cells[i, 4], cells[i, 5] = b, c, d
        done += 1
    return done


def views(xyz: np.ndarray, polygons: Polygons) -> tuple[np.ndarray, np.ndarray]:
    """For each polygon its normal by Newell's sum, (f, 3), and the two coordinates to look at, as 3 i + j."""
    ends, owner = polygons.sides
    low = np.full((len(polygons), 3), np.inf)
    np.minimum.at(low, owner, xyz[ends[:, 0]])  # subtracted, so that the sums keep their digits
    a, b = xyz[ends[:, 0]] - low[owner], xyz[ends[:, 1]] - low[owner]
    normal = np.zeros((len(polygons), 3))
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        normal[:, axis] = np.bincount(
            owner, (a[:, i] - b[:, i]) * (a[:, j] + b[:, j]), minlength=len(polygons)
        )
    axis = np.abs(normal).argmax(axis=1)
    return normal, 3 * ((axis + 1) % 3) + (axis + 2) % 3


def cut(points: np.ndarray, polygons: Polygons, facets: int) -> tuple[Shell, list[Fault]]:
    """The triangles of polygons, and the faults of those that have none.

    Parameters
    ----------
    points : (n, 3) float64
    polygons : Polygons
        Facets, then inner pieces. Indices are valid, no ring repeats a vertex next to itself.
    facets : int

    Returns
    -------
    Shell
    list of Fault
        Polygons that are not flat, or that cross or touch themselves. Their triangles are missing.
    """
    whole = polygons.triangles
    if whole is not None:
        piece = np.arange(len(whole), dtype=np.int32)
        return Shell(points, whole, piece, whole[:0, :2], piece[:0], facets), []
    corners, single = polygons.corners, np.diff(polygons.first_ring) == 1
    starts = polygons.ring_start[polygons.first_ring[:-1]]
    segments = np.flatnonzero(corners == 2)
    triangles = np.flatnonzero(single & (corners == 3))
    quads = np.flatnonzero(single & (corners == 4))
    xyz = unit_points(points)
    normal, view = views(xyz, polygons)
    faults = _bent(points, xyz, polygons, normal)
    bent = np.zeros(len(polygons), dtype=bool)
    bent[[fault.pieces[0] for fault in faults]] = True
    rows = [polygons.vertices[starts[triangles][:, None] + np.arange(3)]]
    owner = [triangles]
    four = polygons.vertices[starts[quads][:, None] + np.arange(4)]
    cells = np.empty((len(quads), 6), dtype=np.int32)
    _quads(xyz, four, view[quads], _facing(xyz, polygons, normal, facets), cells)
    chords = chords_of(polygons)
    whole_quad = np.ones(len(polygons), dtype=bool)
    whole_quad[list(chords)] = False
    good = (cells[:, 0] >= 0) & ~bent[quads] & whole_quad[quads]
    rows.append(cells[good].reshape(-1, 3))
    owner.append(np.repeat(quads[good], 2))
    done = bent.copy()
    done[segments], done[triangles], done[quads[good]] = True, True, True
    for i in np.flatnonzero(~done).tolist():
        found, wrong = triangulated(
            xyz, sides_of(polygons.rings(i)), int(view[i]), chords=chords.get(i, NO_ENDS)
        )
        if wrong is not None:
            faults.append(_crossed(points, polygons, i, wrong))
            continue
        rows.append(found if normal[i, _axis(view[i])] > 0 else found[:, ::-1])
        owner.append(np.full(len(found), i))
    piece = np.concatenate(owner).astype(np.int32)
    order = np.argsort(piece, kind="stable")
    shell = Shell(
        points,
        frozen(np.concatenate(rows)[order].astype(np.int32)),
        frozen(piece[order]),
        frozen(polygons.vertices[starts[segments][:, None] + np.arange(2)]),
        frozen(segments.astype(np.int32)),
        facets,
    )
    return shell, sorted(faults, key=lambda fault: fault.pieces)


def _facing(xyz: np.ndarray, polygons: Polygons, normal: np.ndarray, facets: int) -> int:
    """1 if facets face outward, -1 if inward, by the sign of the volume; of no meaning where they do both."""
    tip = xyz[polygons.vertices[polygons.ring_start[polygons.first_ring[:facets]]]]
    away = tip - tip[:1]
    return 1 if fsum((away * normal[:facets]).ravel().tolist()) >= 0.0 else -1


def _axis(view: int) -> int:
    """The axis along which a view looks."""
    return 3 - view // 3 - view % 3


def _bent(points: np.ndarray, xyz: np.ndarray, polygons: Polygons, normal: np.ndarray) -> list[Fault]:
    """Polygons with vertices too far from their plane, which goes through the mean of the vertices."""
    many = np.flatnonzero(polygons.corners > 3)
    if len(many) == 0:
        return []
    owner = np.repeat(np.arange(len(polygons)), polygons.corners)
    x = xyz[polygons.vertices]
    count = np.bincount(owner, minlength=len(polygons))
    center = np.stack(
        [np.bincount(owner, x[:, k], minlength=len(polygons)) / count for k in range(3)], axis=1
    )
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0.0, length, 1.0)[:, None]
    away = x - center[owner]
    off = np.abs((away * unit[owner]).sum(axis=1))
    extent, most = np.zeros(len(polygons)), np.zeros(len(polygons))
    np.maximum.at(extent, owner, 2 * np.linalg.norm(away, axis=1))
    np.maximum.at(most, owner, off)
    result = []
    for i in many[most[many] > PLANAR * extent[many]].tolist():
        v = int(polygons.vertices[owner == i][off[owner == i].argmax()])
        text = (
            f"the vertices of {{name}} do not lie in a plane: point {v} is off by {most[i] / extent[i]:.2g} "
            f"of its extent (allowed are {PLANAR:g}), {at(points[v])}; cut it into triangles"
        )
        result.append(Fault("not flat", text, place(points[v]), (i,), (v,)))
    return result


def _crossed(points: np.ndarray, polygons: Polygons, i: int, wrong: Fault) -> Fault:
    """What is wrong with the rings of a polygon, said of the polygon."""
    number = np.unique(np.concatenate(polygons.rings(i)))
    v = int(number[wrong.vertices[0]]) if wrong.vertices else int(number[0])
    text = (
        f"{{name}} crosses or touches itself ({wrong.kind}, where it looks largest), near point {v}, "
        f"{at(points[v])}; a facet needs an outline that is simple, and holes inside of it"
    )
    return Fault("crossing itself", text, place(points[v]), (i,), (v,))
