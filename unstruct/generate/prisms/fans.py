"""The cells of fans of rays along creases, their signs, and the directions of the rays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import sines, turns
from ...geometry.jacobians import hexahedron_signs, pyramid_signs, wedge_signs
from ...mesh.cells import CELL_TYPES
from ...mesh.mesh import Mesh
from ...predicates.batch import orient_rows
from .creases import Fans
from .split import negative_parts

__all__ = [
    "SOLID_KINDS",
    "FanCells",
    "centers_of",
    "fan_cells",
    "fan_faults",
    "fan_quality",
    "spread_directions",
    "whole_fans",
]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Rows = NDArray[np.int32]

SOLID_KINDS = ("hexahedron", "wedge", "pyramid", "tetra")  # their order in a mesh
OPPOSITE_RAYS = 0.1  # two unit vectors whose sum is so short have no middle


class FanCells(NamedTuple):
    """Cells of fans, by kind; for all in the order of the kinds what they belong to, and the layer.

    Attributes
    ----------
    kinds : dict of str to array
    part : (c,) int64
        The row of `Fans.quads`, or after these of `Fans.corners`.
    cap : (c,) int64
        The row of `Fans.caps` above each.
    layer : (c,) int64
    centers : (q, 8) int32
        The vertices of which the mean is the center of the top cell of each of ``quads``; wedges lying on
        their side, six, have the first two twice. Rows of no cells where nothing is divided.
    """

    kinds: dict[str, Rows]
    part: Numbers
    cap: Numbers
    layer: Numbers
    centers: Rows


class _Blocks:
    """Cells that are collected by kind."""

    def __init__(self) -> None:
        self.rows: dict[str, list[NDArray]] = {kind: [] for kind in SOLID_KINDS}

    def add(self, kind: str, cells: NDArray, part: NDArray, cap: NDArray, layer: int) -> None:
        self.rows[kind].append(np.column_stack([cells, part, cap, np.full(len(cells), layer)]))

    def done(self, centers: Rows) -> FanCells:
        kinds, rest = {}, [np.empty((0, 3), dtype=np.int64)]
        for kind, blocks in self.rows.items():
            rows = np.concatenate(blocks).astype(np.int64) if blocks else np.empty((0, 3), dtype=np.int64)
            if len(rows):
                kinds[kind] = rows[:, :-3].astype(np.int32)
                rest.append(rows[:, -3:])
        part, cap, layer = np.concatenate(rest).T
        return FanCells(kinds, part, cap, layer, centers)


def _standing(fans: Fans, number: Rows, k: int) -> tuple[str, Rows]:
    """The cells over quads in layer k."""
    low, high = number[k], number[k + 1]
    a, b, c, d = fans.quads.T
    if k == 0:  # a wedge lying on its side: two triangles that begin at the ends of the edge
        return "wedge", np.column_stack([low[a], high[a], high[b], low[d], high[d], high[c]])
    return "hexahedron", np.column_stack([low[fans.quads], high[fans.quads]])


def fan_cells(fans: Fans, number: Rows, centers: int | None = None) -> FanCells:
    """The cells over quads and corners.

    Parameters
    ----------
    fans : Fans
    number : (levels + 1, r) int32
        The vertex of each ray on each level, all different but for level 0.
    centers : int, optional
        The number of the first center, of which each of ``quads`` gets one: the top cell is divided then, so
        that the cap has triangles only. By default nothing is divided.
    """
    blocks, top = _Blocks(), len(number) - 2
    many = len(fans.quads)
    quad, corner = np.arange(many), np.arange(len(fans.corners))
    middle = np.empty((0, 8), dtype=np.int32)
    for k in range(top + 1):
        kind, cells = _standing(fans, number, k)
        if k < top or centers is None:
            blocks.add(kind, cells, quad, 2 * quad, k)
        else:
            middle = np.column_stack([cells, cells[:, : 8 - cells.shape[1]]]).astype(np.int32)
            _divided(blocks, fans, number[-1], kind, cells, centers + quad, k)
        low, high = number[k][fans.corners], number[k + 1][fans.corners]
        part, cap = many + corner, 2 * many + corner
        if k == 0:
            blocks.add("tetra", np.column_stack([low[:, :1], high]), part, cap, k)
        else:
            blocks.add("wedge", np.column_stack([low, high]), part, cap, k)
    return blocks.done(middle)


def _divided(
    blocks: _Blocks, fans: Fans, top: NDArray, kind: str, cells: NDArray, center: NDArray, layer: int
) -> None:
    """Divide cells from a point inside: the face on top along the diagonal of the cap."""
    many = len(fans.quads)
    quad = np.arange(many)
    on_top = {4, 5, 6, 7} if kind == "hexahedron" else {1, 2, 4, 5}
    for facet in CELL_TYPES[kind][3]:
        rows = cells[:, facet]  # outward
        if set(facet) == on_top:
            continue
        if len(facet) == 4:
            blocks.add("pyramid", np.column_stack([rows[:, ::-1], center]), quad, 2 * quad, layer)
        else:
            blocks.add("tetra", np.column_stack([center, rows]), quad, 2 * quad, layer)
    caps = top[fans.caps[: 2 * many]]
    for half in range(2):
        rows = np.column_stack([center, caps[half::2]])
        blocks.add("tetra", rows, quad, 2 * quad + half, layer)


def centers_of(points: Array, rows: Rows) -> Array:
    """The means of eight points: (q, 3)."""
    total = np.zeros((len(rows), 3))
    for k in range(8):
        total += points[rows[:, k]] / 8
    return total


def _chosen(fans: Fans, parts: Numbers) -> Fans:
    many = len(fans.quads)
    quads, corners = parts[parts < many], parts[parts >= many] - many
    return fans._replace(quads=fans.quads[quads], corners=fans.corners[corners])


def whole_fans(fans: Fans, places: Array, parts: Numbers, divided: bool) -> tuple[Array, FanCells, Numbers]:
    """The cells of some quads and corners over places, with their points, and the chosen parts in order."""
    parts = np.sort(parts)
    some = _chosen(fans, parts)
    levels, rays = places.shape[:2]
    number = (np.arange(levels)[:, None] * rays + np.arange(rays)).astype(np.int32)
    number[0] = fans.base
    points = places.reshape(-1, 3)
    cells = fan_cells(some, number, len(points) if divided else None)
    points = np.concatenate([points, centers_of(points, cells.centers)]) if divided else points
    return points, cells, parts


def fan_faults(fans: Fans, places: Array, parts: Numbers, simplices: bool) -> Numbers:
    """The quads and corners, of some, with a cell that is not positive, exactly: sorted, each once.

    Parameters
    ----------
    fans : Fans
    places : (levels + 1, r, 3) float64
    parts : (p,) int64
        Rows of quads, and after these of corners.
    simplices : bool
        Whether all tetrahedra into which cells are divided have to be positive, too.
    """
    if not len(parts):
        return parts
    points, cells, order = whole_fans(fans, places, parts, True)
    bad = np.concatenate([_signs(points, kind, rows) != 1 for kind, rows in cells.kinds.items()])
    if simplices:
        bad[negative_parts(points, cells.kinds)] = True
    return np.unique(order[cells.part[bad]])


def _signs(points: Array, kind: str, rows: Rows) -> NDArray[np.int8]:
    if kind == "tetra":
        return np.asarray(orient_rows(points, rows), dtype=np.int8)
    x = points[rows]
    if kind == "hexahedron":
        return hexahedron_signs(x)[0]
    return wedge_signs(x) if kind == "wedge" else pyramid_signs(x)


def fan_quality(fans: Fans, places: Array) -> Array:
    """The least scaled Jacobian of wedges and hexahedra of quads and corners, before tops are divided."""
    result = np.full(len(fans.quads) + len(fans.corners), np.inf)
    if not len(result):
        return result
    points, cells, _ = whole_fans(fans, places, np.arange(len(result)), False)
    start = 0
    for kind, rows in cells.kinds.items():
        if kind != "tetra":
            found = Mesh(points, None, cells={kind: rows}).quality("scaled_jacobian")
            np.minimum.at(result, cells.part[start : start + len(rows)], found)
        start += len(rows)
    return result


# ---------------------------------------------------------------------- directions


def _unit(v: Array) -> Array:
    length = np.sqrt(v[:, 0] * v[:, 0] + v[:, 1] * v[:, 1] + v[:, 2] * v[:, 2])
    return v / np.where(length > 0.0, length, 1.0)[:, None]


def _arc(u: Array, v: Array, share: Array) -> Array:
    """Unit vectors on the arcs from u to v."""
    x, y, z = u.T
    a, b, c = v.T
    px, py, pz = y * c - z * b, z * a - x * c, x * b - y * a
    angle = turns(np.sqrt(px * px + py * py + pz * pz), x * a + y * b + z * c)
    return _unit(sines((1.0 - share) * angle)[:, None] * u + sines(share * angle)[:, None] * v)


def spread_directions(fans: Fans, direction: Array, single: Array) -> Array:
    """The directions of all rays.

    Parameters
    ----------
    fans : Fans
    direction : (sheets, 3) float64
        Of the rays of sheets.
    single : (n, 3) float64
        Of one ray at each vertex: in the middle of corners, and where the sides of a crease are opposite.
    """
    vertex = fans.base[fans.sheets :]
    middle = single[vertex]
    u, v = (np.where(fans.between[:, :1] >= 0, direction[fans.between[:, k]], middle) for k in range(2))
    total = u + v
    short = total[:, 0] ** 2 + total[:, 1] ** 2 + total[:, 2] ** 2 < OPPOSITE_RAYS**2
    half = np.where(short[:, None], middle, _unit(total))
    early = fans.share < 0.5
    one, two = np.where(early[:, None], u, half), np.where(early[:, None], half, v)
    rest = _arc(one, two, np.where(early, 2.0 * fans.share, 2.0 * fans.share - 1.0))
    rest = np.where(fans.between[:, :1] >= 0, rest, middle)
    return np.concatenate([direction, rest])
