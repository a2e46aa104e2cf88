"""The cells of fans of rays along creases, their signs, and the directions of the rays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.elementary import sines, turns
from ...geometry.jacobians import hexahedron_signs, pyramid_signs, wedge_signs
from ...mesh.mesh import Mesh
from ...predicates.batch import orient_rows, power_of_two
from .creases import Fans
from .remainder import padded_to_four
from .split import negative_parts, tetrahedra
from .stars import unit_normals

__all__ = [
    "NO_APEXES",
    "NO_PYRAMIDS",
    "SOLID_KINDS",
    "FanCells",
    "apex_heights",
    "apexes_of",
    "cap_of",
    "fan_cells",
    "fan_faults",
    "fan_quality",
    "on_cap",
    "spread_directions",
    "whole_fans",
]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Rows = NDArray[np.int32]

SOLID_KINDS = ("hexahedron", "wedge", "pyramid", "tetra")  # their order in a mesh
ON_CAP = {"whole": 1, "halves": 2, "pyramids": 4, "both": 4}  # faces of the cap, for each quadrilateral
NO_PYRAMIDS, NO_APEXES = np.empty(0, dtype=np.int64), np.empty((0, 3))
APEX_SHARE = 0.5  # height of pyramids; unit: the edge of the crease below
OPPOSITE_RAYS = 0.1  # two unit vectors whose sum is so short have no middle


class FanCells(NamedTuple):
    """Cells of fans, by kind; for all in the order of the kinds what they belong to, and the layer.

    Attributes
    ----------
    kinds : dict of str to array
    part : (c,) int64
        The row of `Fans.quads`, or after these of `Fans.corners`.
    cap : (c,) int64
        The row of `cap_of` above each: the first, where there are several.
    layer : (c,) int64
    """

    kinds: dict[str, Rows]
    part: Numbers
    cap: Numbers
    layer: Numbers


def on_cap(fans: Fans, how: str, values: NDArray[Any]) -> NDArray[Any]:
    """Values of quads and corners for the faces of the cap above them."""
    many = len(fans.quads)
    return np.concatenate([np.repeat(values[:many], ON_CAP[how]), values[many:]])


def cap_of(fans: Fans, how: str, top: NDArray[np.integer], apex: NDArray[np.integer]) -> Numbers:
    """The faces on top of fans: (f, 3), or with whole quadrilaterals (f, 4), triangles padded by -1.

    Parameters
    ----------
    fans : Fans
    how : "whole", "halves", "pyramids" or "both"
        Quadrilaterals as they are, cut from their lowest ray, with pyramids on top of them, or the halves of
        both diagonals.
    top : (r,) int
        The vertex on top of each ray.
    apex : (q,) int
        That of each pyramid.
    """
    a, b, c, d = top[fans.quads].T
    corners = top[fans.corners].astype(np.int64)
    if how == "whole":
        return np.concatenate([np.column_stack([a, b, c, d]), padded_to_four(corners)]).astype(np.int64)
    if how == "halves":
        return top[fans.caps].astype(np.int64)
    if how == "both":
        parts = (a, b, c), (a, c, d), (a, b, d), (b, c, d)
    else:
        parts = (a, b, apex), (b, c, apex), (c, d, apex), (d, a, apex)
    faces = np.stack([np.column_stack(part) for part in parts], axis=1)
    return np.concatenate([faces.reshape(-1, 3), corners]).astype(np.int64)


def fan_cells(fans: Fans, number: Rows, how: str, apex: NDArray[np.integer] = NO_PYRAMIDS) -> FanCells:
    """The cells over quads and corners.

    Parameters
    ----------
    fans : Fans
    number : (levels + 1, r) int32
        The vertex of each ray on each level, all different but for level 0.
    how : "whole", "halves" or "pyramids"
        The form of the cap; with pyramids one stands on each of the topmost hexahedra.
    apex : (q,) int
        The vertices of the pyramids.
    """
    rows: dict[str, list[NDArray]] = {kind: [] for kind in SOLID_KINDS}
    many, levels, per = len(fans.quads), len(number) - 1, ON_CAP[how]
    a, b, c, d = fans.quads.T

    def add(kind: str, cells: NDArray, corner: bool, layer: int) -> None:
        part = np.arange(len(cells)) + many * corner
        cap = np.where(part < many, per * part, part + (per - 1) * many)
        rows[kind].append(np.column_stack([cells, part, cap, np.full(len(cells), layer)]))

    for k in range(levels):
        low, high = number[k], number[k + 1]
        lower, upper = low[fans.corners], high[fans.corners]
        if k == 0:  # a wedge lying on its side: two triangles that begin at the ends of the edge
            add("wedge", np.column_stack([low[a], high[a], high[b], low[d], high[d], high[c]]), False, k)
            add("tetra", np.column_stack([lower[:, :1], upper]), True, k)
        else:
            add("hexahedron", np.column_stack([low[fans.quads], high[fans.quads]]), False, k)
            add("wedge", np.column_stack([lower, upper]), True, k)
    if how == "pyramids":
        add("pyramid", np.column_stack([number[-1][fans.quads], apex]), False, levels)
    kinds, rest = {}, [np.empty((0, 3), dtype=np.int64)]
    for kind, blocks in rows.items():
        found = np.concatenate(blocks).astype(np.int64) if blocks else np.empty((0, 3), dtype=np.int64)
        if len(found):
            kinds[kind] = found[:, :-3].astype(np.int32)
            rest.append(found[:, -3:])
    part, cap, layer = np.concatenate(rest).T
    return FanCells(kinds, part, cap, layer)


def apexes_of(fans: Fans, tops: Array, height: Array) -> Array:
    """Where pyramids of some heights on the top quadrilaterals end: (q, 3)."""
    x = tops[fans.quads]
    middle = x[:, 0] / 4 + x[:, 1] / 4 + x[:, 2] / 4 + x[:, 3] / 4
    near = tops * power_of_two(tops)  # so that no product underflows
    one, two = (unit_normals(near, fans.quads[:, corners])[0] for corners in ([0, 1, 2], [0, 2, 3]))
    return middle + height[:, None] * _unit(one + two)


def apex_heights(fans: Fans, points: Array) -> Array:
    """How high pyramids are to be: a part of the lengths of the edges of creases."""
    along = points[fans.base[fans.quads[:, 3]]] - points[fans.base[fans.quads[:, 0]]]
    factor = power_of_two(along)
    x, y, z = (along * factor).T
    return np.asarray(APEX_SHARE * np.sqrt(x * x + y * y + z * z) / factor)


def _chosen(fans: Fans, parts: Numbers) -> Fans:
    many = len(fans.quads)
    quads, corners = parts[parts < many], parts[parts >= many] - many
    return fans._replace(quads=fans.quads[quads], corners=fans.corners[corners])


def whole_fans(
    fans: Fans, places: Array, parts: Numbers, how: str, apexes: Array
) -> tuple[Array, FanCells, Numbers]:
    """The cells of some quads and corners over places, with their points, and the chosen parts in order."""
    parts = np.sort(parts)
    levels, rays = places.shape[:2]
    number = (np.arange(levels)[:, None] * rays + np.arange(rays)).astype(np.int32)
    number[0] = fans.base
    points = np.concatenate([places.reshape(-1, 3), apexes])
    apex = levels * rays + parts[parts < len(fans.quads)]
    return points, fan_cells(_chosen(fans, parts), number, how, apex), parts


def fan_faults(
    fans: Fans, places: Array, parts: Numbers, how: str, apexes: Array, simplices: bool = False
) -> Numbers:
    """The quads and corners, of some, with a cell that is not positive, exactly: sorted, each once.

    Parameters
    ----------
    fans : Fans
    places : (levels + 1, r, 3) float64
    parts : (p,) int64
        Rows of quads, and after these of corners.
    how : "whole", "halves" or "pyramids"
    apexes : (q, 3) float64
        Of pyramids.
    simplices : bool
        Whether all tetrahedra into which cells are divided have to be positive, too.
    """
    if not len(parts):
        return parts
    points, cells, order = whole_fans(fans, places, parts, how, apexes)
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


def fan_quality(fans: Fans, places: Array, how: str, apexes: Array) -> Array:
    """The least scaled Jacobian of the cells of quads and corners; of tetrahedra where the cap has halves."""
    result = np.full(len(fans.quads) + len(fans.corners), np.inf)
    if not len(result):
        return result
    points, cells, _ = whole_fans(fans, places, np.arange(len(result)), how, apexes)
    kinds, part = cells.kinds, cells.part
    if how == "halves":
        rows, owner = tetrahedra(kinds)
        kinds, part = {"tetra": rows}, part[owner]
    np.minimum.at(result, part, Mesh(points, None, cells=kinds).quality("scaled_jacobian"))
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
