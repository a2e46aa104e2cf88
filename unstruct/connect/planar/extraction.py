"""The triangles of a domain within a planar complex, as the arrays of a mesh, compiled."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import fill, flagged, frozen
from ...base.jit import kernel
from ..insertion.engine import COUNT, extract_cells
from ..insertion.halfedges import SEGMENTS

__all__ = ["extract", "named_sets", "survey"]

FEW_MARKERS = 8  # more markers are found by sorting
NO_EDGES = frozen(np.empty((0, 2), dtype=np.int32))


@kernel
def number_kept(vertex, region, count, number, place):
    """Number the triangles of the domain and their vertices, the others -1; return how many there are."""
    fill(place, -1)
    cells = 0
    for t in range(count):
        if region[t] < 0:
            number[t] = -1
            continue
        number[t] = cells
        cells += 1
        for k in range(3):
            place[vertex[3 * t + k]] = 0
    vertices = 0
    for v in range(len(place)):
        if place[v] == 0:
            place[v] = vertices
            vertices += 1
    return cells, vertices


@kernel
def survey(triangles, subsegments, state, facets, number, place):
    """Count what `extract` will write, and number it.

    Parameters
    ----------
    triangles : tuple
        The arrays ``vertex``, ``twin`` and ``region`` of a `PlanarComplex`.
    subsegments : tuple
        Its arrays ``where``, ``ends``, ``piece`` and ``span``.
    state : ndarray of int64
    facets : int
    number, place : ndarray of int32
        Receive what `number_kept` writes, for each slot and each vertex.

    Returns
    -------
    cells, vertices, kept, outer : int
        How many triangles the domain has; how many vertices, and how many subsegments, belong to one of them;
        and how many of those subsegments are parts of facets.
    """
    vertex, twin, region = triangles
    where, _, piece, _ = subsegments
    cells, vertices = number_kept(vertex, region, state[COUNT], number, place)
    kept = outer = 0
    for s in range(state[SEGMENTS]):
        e = np.int64(where[s])
        if number[e // 3] >= 0 or number[twin[e] // 3] >= 0:
            kept += 1
            outer += piece[s] < facets
    return cells, vertices, kept, outer


@kernel
def extract(triangles, subsegments, state, number, place, cells, rows):
    """Write what `survey` has counted and numbered.

    ``cells`` gets the vertices, neighbors and regions of the triangles, ``rows`` the ends, pieces and spans
    of the subsegments.
    """
    vertex, twin, region = triangles
    where, ends, piece, span = subsegments
    simplices, neighbors, regions = cells
    pairs, pieces, spans = rows
    count = state[COUNT]
    extract_cells(vertex, twin, 3, count, place, number, simplices, neighbors)
    for t in range(count):
        if number[t] >= 0:
            regions[number[t]] = region[t]
    k = 0
    for s in range(state[SEGMENTS]):
        e = np.int64(where[s])
        if number[e // 3] >= 0 or number[twin[e] // 3] >= 0:
            pairs[k, 0], pairs[k, 1], pieces[k] = place[ends[s, 0]], place[ends[s, 1]], piece[s]
            spans[k, 0], spans[k, 1] = span[s, 0], span[s, 1]
            k += 1


@kernel
def _write_kinds(rows, pieces, facets, outer, inner):
    """Write the subsegments of facets to ``outer``, the others to ``inner``."""
    i = j = 0
    for s in range(len(rows)):
        if pieces[s] < facets:
            outer[i, 0], outer[i, 1] = rows[s, 0], rows[s, 1]
            i += 1
        else:
            inner[j, 0], inner[j, 1] = rows[s, 0], rows[s, 1]
            j += 1


def named_sets(
    ends: NDArray[np.int32],
    piece: NDArray[np.int32],
    outer: int,
    facets: int,
    markers: Mapping[str, ArrayLike] | None,
) -> dict[str, NDArray]:
    """The markers of edges: "facets" (``outer`` of them), "inner", and those of sets of pieces by name."""
    named: dict[str, NDArray] = {"facets": ends, "inner": NO_EDGES}
    if outer < len(ends):
        named["facets"] = np.empty((outer, 2), dtype=np.int32)
        named["inner"] = np.empty((len(ends) - outer, 2), dtype=np.int32)
        _write_kinds(ends, piece, facets, named["facets"], named["inner"])
    if markers and len(markers) > FEW_MARKERS:
        return named | _many_sets(ends, piece, markers)
    most = int(piece.max(initial=-1)) + 1
    for name, pieces in (markers or {}).items():
        known = np.asarray(pieces)
        named[name] = ends[flagged(most, known[known < most])[piece]]
    return named


def _many_sets(
    ends: NDArray[np.int32], piece: NDArray[np.int32], markers: Mapping[str, ArrayLike]
) -> dict[str, NDArray]:
    """The sets of many markers: subsegments are sorted by pieces once, not looked through for each name."""
    order = np.argsort(piece, kind="stable")
    start = np.searchsorted(piece[order], np.arange(int(piece.max(initial=-1)) + 2))
    named = {}
    for name, values in markers.items():
        pieces = np.unique(np.asarray(values))
        pieces = pieces[pieces < len(start) - 1]
        rows = [order[start[k] : start[k + 1]] for k in pieces.tolist()]
        named[name] = ends[np.sort(np.concatenate(rows))] if rows else ends[:0]
    return named
