"""Recombination: a planar mesh of triangles becomes one of quadrilaterals, with few triangles left.

See the book, chapter 6c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_flag
from ...base.errors import MeshError
from ...connect.swapping import constraints, first_fault, planar_coordinates
from ...geometry.scaled_jacobian import ring_angles, unit_scaled
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.marked import marked_sides
from ...mesh.mesh import Mesh
from ...mesh.periodic import renumbered
from ..improve.smoothing import staying
from .improving import improved
from .pairing import pairs_of_triangles

__all__ = ["Middles", "on_pieces", "recombine", "recombined"]

SHARPEST_PAIR = 0.97  # the largest cosine of an angle of a pair that is improved later: 14 degrees


def recombine(mesh: Mesh, *, improve: bool = True) -> DomainMesh:
    """Quadrilaterals from the triangles of a planar mesh.

    Parameters
    ----------
    mesh : Mesh
        Counterclockwise triangles in the plane.
    improve : bool
        Whether triangles that found no partner walk until two of them meet, cells are joined, collapsed and
        turned so that most vertices have four, and vertices move to where angles are nearer to right ones.
        Without it all vertices stay, and pairs have angles between 39.6 and 140.4 degrees.

    Returns
    -------
    DomainMesh
        ``cells`` has "quad", and "triangle" if some are left. Every cell is convex. Names, regions and pieces
        are those of the mesh, which has lost some inner vertices; ``origin`` has what it had for those that
        remain. ``counts``: "quadrilaterals" and "triangles", then "pairs", "pairs won by walking",
        "doublets", "collapsed" and "turned" cells, and "moves". ``figures``: "share of quadrilaterals" among
        the cells, "mean deviation" (of the angles of quadrilaterals from 90 degrees), "minimum angle" and
        "maximum angle" of all cells, in degrees. ``unrefined`` lists the triangles that are left; if there
        are some after the improvement, a warning tells it.

    Raises
    ------
    MeshError
        For a mesh that is not made of counterclockwise triangles of the plane, or has none.

    Notes
    -----
    There are no pairs across marked edges, pieces of a domain, and borders between cells with different
    markers; the ends of these, vertices that a marker names and, in the mesh of a domain, those of the domain
    stay. In a part with an odd number of sides at least one triangle remains, since each quadrilateral has
    four. Pairs: those nearest to right angles first, then exchanges along alternating paths.
    O(n log n). Sources: C. K. Lee, S. H. Lo, Computers and Structures 52 (1994) 847-857; J.-F. Remacle and
    others, Int. J. Numer. Methods Eng. 89 (2012) 1102-1119. Book: 6c.

    Examples
    --------
    >>> import unstruct
    >>> mesh = unstruct.voronoi_segment(unstruct.Domain.rectangle((0, 0), (1, 1)), 0.25)
    >>> unstruct.recombine(mesh).figures["share of quadrilaterals"] > 0.9
    True
    """
    result = recombined(mesh, as_flag(improve, "improve"))
    return noticed(result) if improve else result


class Middles(NamedTuple):
    """Which subsegments of a mesh may be divided, and where: on sides with cells on one side only."""

    segment: NDArray[np.int64]
    points: NDArray[np.float64]


def recombined(mesh: Mesh, improve: bool, middles: Middles | None = None) -> DomainMesh:
    """`recombine` without a warning.

    Parameters
    ----------
    mesh, improve
        As there.
    middles : Middles, optional
        In a mesh of a domain: at these places the boundary is divided where triangles are left.
    """
    coordinates, wide = planar_coordinates(mesh)
    if mesh.size == 0:
        raise MeshError(f"there is nothing to recombine: {mesh!r}")
    fault = first_fault(coordinates, mesh.simplices, mesh.neighbors, wide)
    if wide or fault >= 0:
        what = "its coordinates span too many exponents" if wide else f"simplices[{fault}] is not valid"
        raise MeshError(f"this mesh cannot be recombined: {what}; see unstruct.check")
    markers, locked = constraints(mesh, None)
    closed = locked | (mesh.neighbors < 0)
    if isinstance(mesh, DomainMesh):
        closed |= on_pieces(mesh)
    rows = np.asarray(mesh.simplices)
    single, quads, both = pairs_of_triangles(
        mesh.points, rows, mesh.neighbors, closed, *([SHARPEST_PAIR] if improve else [])
    )
    cells = np.concatenate([np.column_stack([rows[single], np.full(len(single), -1)]), quads]).astype(
        np.int64
    )
    owner = np.concatenate([single, both[:, 0]])
    points, counts = np.array(mesh.points), {"pairs": len(quads)}
    if improve:
        t, i = np.nonzero(closed)
        sides = np.column_stack([rows[t, (i + 1) % 3], rows[t, (i + 2) % 3]]).astype(np.int64)
        fixed = staying(mesh, None)
        fixed[sides.ravel()] = True
        middle = np.full(len(sides), -1)
        if middles is not None and isinstance(mesh, DomainMesh):
            middle = _by_side(mesh, sides, middles)
            points = np.concatenate([points, middles.points])
            fixed = np.concatenate([fixed, np.ones(len(middles.points), dtype=bool)])
        points, cells, more = improved(points, cells, fixed, sides, middle)
        counts |= more
    return _assembled(mesh, points, cells, owner, markers, counts, middles)


def _by_side(mesh: DomainMesh, sides: NDArray[np.int64], middles: Middles) -> NDArray[np.int64]:
    """The number of the middle of each of these sides (s, 2), after the points of the mesh; -1 for none."""
    n = len(mesh.points)
    ends = np.sort(mesh.segments[middles.segment].astype(np.int64), axis=1)
    keys = ends[:, 0] * n + ends[:, 1]
    order = np.argsort(keys)
    wanted = np.sort(sides, axis=1)
    wanted_keys = wanted[:, 0] * n + wanted[:, 1]
    place = np.minimum(np.searchsorted(keys[order], wanted_keys), max(0, len(keys) - 1))
    if not len(keys):
        return np.full(len(sides), -1)
    return np.where(keys[order][place] == wanted_keys, n + order[place], -1)


def on_pieces(mesh: DomainMesh) -> NDArray[np.bool_]:
    """The sides (m, 3) opposite corners that lie on pieces of the domain."""
    return marked_sides(np.asarray(mesh.simplices), mesh.segments, len(mesh.points))[0]


def _assembled(
    mesh: Mesh,
    points: NDArray[np.float64],
    cells: NDArray[np.int64],
    owner: NDArray[np.int64],
    markers: dict[str, NDArray],
    counts: dict[str, int],
    middles: Middles | None,
) -> DomainMesh:
    """The mesh of these cells, without the vertices that only collapsed cells had."""
    there = cells[:, 0] >= 0
    cells, owner = cells[there], owner[there]
    n = len(mesh.points)
    used, now = np.ones(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
    used[:n] = False
    used[mesh.simplices.ravel()] = True
    now[cells[cells >= 0]] = True
    kept = now | ~used
    number = np.cumsum(kept) - 1
    three = cells[:, 3] < 0
    order = np.argsort(~three, kind="stable")  # triangles come first
    blocks = {"triangle": number[cells[three, :3]], "quad": number[cells[~three]]}
    blocks = {name: rows.astype(np.int32) for name, rows in blocks.items() if len(rows)}
    rest: dict[str, Any] = {}
    halves = np.empty((0, 3), dtype=np.int64)
    if isinstance(mesh, DomainMesh):
        ends, span, of = mesh.segments.astype(np.int64), mesh.span, np.arange(len(mesh.segments))
        if middles is not None:
            there = now[n:]
            halves = np.column_stack([ends[middles.segment[there]], n + np.flatnonzero(there)])
        ends, of, second = _in_halves(ends, halves, n)
        span = span[of]
        middle = span.mean(axis=1)
        span = np.column_stack(
            [np.where(second == 1, middle, span[:, 0]), np.where(second == 0, middle, span[:, 1])]
        )
        rest = {"segments": number[ends].astype(np.int32), "piece": mesh.piece[of], "span": span}
        counts = mesh.counts | counts
    named: dict[str, Any] = {}
    for name, rows in markers.items():
        if rows.ndim == 1:
            named[name] = rows[owner[order]]
        else:
            rows = _in_halves(rows.astype(np.int64), halves, n)[0] if rows.shape[1] == 2 else rows
            named[name] = number[rows].astype(np.int32)
    result_points = points[kept]
    many = int(three.sum())
    return DomainMesh(
        result_points,
        None,
        cells=blocks,
        origin=np.concatenate([mesh.origin, np.full(len(points) - n, -1, dtype=mesh.origin.dtype)])[kept],
        duplicates=number[mesh.duplicates].astype(np.int32),
        markers=named,
        regions=mesh.regions,
        periodic=renumbered(mesh.periodic, number),
        unrefined=np.arange(many),
        reasons=["triangle"] * many,
        counts=counts | {"quadrilaterals": len(cells) - many, "triangles": many},
        figures=_figures(result_points, blocks),
        **rest,
    )


def _in_halves(
    rows: NDArray[np.int64], halves: NDArray[np.int64], n: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """The edges in rows (k, 2), those in ``halves`` (a, b, middle) as two.

    Also which row each was, and whether it is the first half, 0, the second, 1, or the whole, -1.
    """
    keys = np.minimum(halves[:, 0], halves[:, 1]) * n + np.maximum(halves[:, 0], halves[:, 1])
    order = np.argsort(keys)
    low, high = rows.min(axis=1, initial=n), rows.max(axis=1, initial=0)
    place = np.searchsorted(keys[order], low * n + high)
    inside = place < len(keys)
    place[~inside] = 0
    found = inside & (keys[order][place] == low * n + high) if len(keys) else inside
    of = np.repeat(np.arange(len(rows)), np.where(found, 2, 1))
    second = np.where(found[of], 0, -1)
    again = np.flatnonzero(of[1:] == of[:-1]) + 1
    second[again] = 1
    result = rows[of]
    middle = np.full(len(of), -1)
    if len(keys):
        middle[found[of]] = halves[order, 2][place[of][found[of]]]
    result[second == 0, 1], result[second == 1, 0] = middle[second == 0], middle[second == 1]
    return result, of, second


def _figures(points: NDArray[np.float64], blocks: dict[str, NDArray[np.int32]]) -> dict[str, float]:
    """The share of quadrilaterals, and what their angles are."""
    angles = {name: np.degrees(ring_angles(unit_scaled(points[rows]))) for name, rows in blocks.items()}
    every = np.concatenate([a.ravel() for a in angles.values()])
    quads = angles.get("quad", np.empty((0, 4)))
    return {
        "share of quadrilaterals": len(quads) / sum(map(len, blocks.values())),
        "mean deviation": float(np.abs(90.0 - quads).mean()) if len(quads) else float("nan"),
        "minimum angle": float(np.nanmin(every)),
        "maximum angle": float(np.nanmax(every)),
    }
