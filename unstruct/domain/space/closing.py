"""The end of a repair in space: edges that are open up to rounding, flat sheets, directions of facets."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from ...geometry.inside_shell import front_inside, triangle_components
from .cutting import Shell, place
from .open_edges import flat_sheets, open_edges, seams

__all__ = ["join_seams", "set_sheets_apart", "turn_outward"]


def join_seams(repairer: Any) -> bool:
    """Split facets at vertices that lie on open edges of them up to rounding; return whether any did."""
    facets = repairer.polygons.select(np.flatnonzero(repairer.facet))
    found = seams(repairer.points, facets)
    gone = np.zeros(len(repairer.polygons), dtype=bool)
    rings: list[Any] = []
    sources: list[int] = []
    ends, owner = facets.sides
    at: dict[tuple[int, int], list[int]] = {}
    for (u, w), row in zip(ends.tolist(), owner.tolist()) if found else ():
        at.setdefault((min(u, w), max(u, w)), []).append(row)
    for edge, inside in found.items():
        # not a facet with such a vertex; and none twice, as there is another round
        free = [r for r in at[edge] if not gone[r] and not np.isin(facets.vertices_of(r), inside).any()]
        if not free:
            continue
        row = free[0]
        gone[row] = True
        new = [_with_inserted(ring.tolist(), edge, inside) for ring in facets.rings(row)]
        if len(new) == 1 and repairer.polygons.corners[row] == 3:
            k = next(k for k, v in enumerate(new[0]) if v not in (*edge, *inside))
            top, *rest = new[0][k:] + new[0][:k]
            parts = [[[top, *pair]] for pair in pairwise(rest)]
        else:
            parts = [new]
        rings += parts
        sources += [row] * len(parts)
        names = ", ".join(map(repairer.point, inside))
        text = f"{names} lies on an open edge of {repairer.called(row)} up to rounding; it was split there"
        repairer.account("vertex near an edge", text, place(repairer.points[inside[0]]), [row], inside)
    if sources:
        repairer.exchange(gone, rings, sources)
    return bool(sources)


def set_sheets_apart(repairer: Any) -> None:
    """Make flat sheets that end at open edges inner pieces; refuse other open surfaces."""
    while True:
        rows, still = flat_sheets(repairer.shell()[0])
        if len(rows) == 0 or len(rows) == int(repairer.facet.sum()):
            if still:
                repairer.refuse(open_edges(repairer.standing()))
            return
        text = (
            f"{repairer.called_all(rows.tolist())} cannot bound (a flat sheet that ends where an odd number "
            "of facets meets), and became inner"
        )
        vertices = repairer.polygons.vertices_of(int(rows[0]))
        middle = place(repairer.points[vertices].mean(axis=0))
        repairer.account("open boundary", text, middle, rows)
        repairer.facet[rows] = False
        repairer.sort()


def turn_outward(repairer: Any) -> None:
    """Turn facets whose normals point into the body."""
    shell, _ = repairer.shell()
    rows, piece = shell.bounding, shell.piece[shell.piece < shell.facets]
    front = front_inside(repairer.points, rows)
    if not front.any():
        return
    if _cut_two_sided(repairer, shell, np.setdiff1d(piece[~front], np.setdiff1d(piece, piece[front]))):
        return turn_outward(repairer)
    component = triangle_components(rows)[0]
    for part in np.unique(component[front]).tolist():
        found = np.unique(piece[front & (component == part)])
        some = f"{len(found)} facets" if len(found) > 1 else "a facet"
        text = f"{some} of a shell ({repairer.called_all(found.tolist())}) faced into the body; turned"
        middle = place(repairer.points[repairer.polygons.vertices_of(int(found[0]))].mean(axis=0))
        repairer.account("turned facets", text, middle, found.tolist())
    repairer.polygons = repairer.polygons.turned(np.unique(piece[front]))


def _cut_two_sided(repairer: Any, shell: Shell, rows: np.ndarray) -> bool:
    """Cut polygons that have the body on one side here and on the other there, beyond an edge on them."""
    gone = np.zeros(len(repairer.polygons), dtype=bool)
    gone[rows] = True
    parts = np.flatnonzero(gone[shell.piece])
    for row in rows.tolist():
        where = place(repairer.points[repairer.polygons.vertices_of(row)[0]])
        text = f"{repairer.called(row)} has the body on both of its sides; it was cut into triangles"
        repairer.account("turned facets", text, where, [row])
    if len(rows):
        repairer.exchange(gone, [[row] for row in shell.triangles[parts]], shell.piece[parts].tolist())
    return len(rows) > 0


def _with_inserted(ring: list[int], edge: tuple[int, ...], inside: list[int]) -> list[int]:
    """A ring with these vertices between the ends of an edge, if it is a side of the ring."""
    result = []
    for u, w in zip(ring, ring[1:] + ring[:1]):
        result.append(u)
        if (min(u, w), max(u, w)) == edge:
            result += inside if u < w else inside[::-1]
    return result
