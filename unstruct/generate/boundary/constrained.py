"""Constrained Delaunay triangulation of a planar domain: every segment is an edge.

A triangulation that holds given segments is *constrained Delaunay* where no circle of a triangle holds a
vertex that is visible from within the triangle, the segments being opaque. It is enough (and what `check`
tests) that no edge but those of segments has the far corner of one triangle inside the circle of the
other. We make the Delaunay triangulation of all points, insert one segment after the other (`segments2`),
then flood the inside from the ghosts beyond the hull. See the book, 2.5.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...base.progress import progress_bar
from ...connect.planar.complex import SEGMENTS, PlanarComplex
from ...connect.planar.flood import flood, hold_seeds
from ...connect.planar.segments import (
    CROSSES,
    DONE,
    LEAVES,
    LOST,
    carriers,
    fill_corners,
    insert_segments,
    mark_present,
)
from ...domain.arguments import as_domain
from ...geometry.ordering import draws, radix_argsort
from ...mesh.domain_mesh import Refined

if TYPE_CHECKING:
    from ...domain.domain import Domain, Sampled

__all__ = ["complex_of", "constrained_delaunay", "insert_all", "planar_complex"]

PATIENCE = 32  # circle tests per corner of a polygon beside a segment, before its ears are cut instead
CHUNK = 20_000  # segments a kernel call: a fraction of a second, so that Ctrl-C is heard


def constrained_delaunay(domain: Domain, hull: bool = False, *, progress: bool = False) -> Refined:
    """The constrained Delaunay triangulation of a planar domain: no point is added to straight segments.

    Parameters
    ----------
    domain : Domain
        Vertices, facets and inner segments. Curves are replaced by chords, as coarsely as is safe.
    hull : bool
        Whether to mesh the whole convex hull and ignore holes; then ``domain.facets`` may be empty.
    progress : bool
        Show a bar while segments go in.

    Returns
    -------
    Refined
        Without ``hull`` vertices in holes or beyond the boundary are not in the mesh; ``origin`` tells which
        vertex of the domain each one is. Markers "facets" and "inner", those of the domain, and "region":
        cells in a part with a named seed have the place of the name in ``domain.regions``, those of the
        other connected parts further numbers, one for each part.

    Raises
    ------
    InputError
        Equal vertices, exponents too wide for one scale; facets that bound no area; a seed on a segment,
        outside, or in one part with a seed of another name.
    InputError
        Segments that cross or overlap (a `Domain` refuses them earlier).

    Notes
    -----
    Exact for any scaled doubles. A vertex on a segment splits it; both parts keep its number in ``piece``.
    Ties (four points on a circle) are decided by the Delaunay triangulation of the vertices, the same for the
    same input. After the O(n) practice of `delaunay`, a segment that crosses k triangles takes O(k log k) in
    practice, rows of points along it included. Sources: D. T. Lee, A. K. Lin, Discrete & Computational
    Geometry 1 (1986) 201-217; L. P. Chew, Algorithmica 4 (1989) 97-108; M. V. Anglada, Computers & Graphics
    21 (1997) 215-223.
    Book: 2.5.
    """
    sampled = as_domain(domain).sampled()
    complex_ = complex_of(domain, sampled, hull=hull, progress=progress)
    return complex_.mesh(
        facets=len(domain.facets), origin=sampled.origin, markers=domain.markers, points=sampled.points
    )


def planar_complex(domain: Domain, size: Any = None, *, progress: bool = False) -> PlanarComplex:
    """The constrained Delaunay triangulation of a domain whose pieces are cut by a size, ready to be refined.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), or size field, optional
        The wanted length of subsegments; see `Domain.sampled`.
    progress : bool
        Show a bar while segments go in.

    Returns
    -------
    PlanarComplex
        Regions flooded, as told in `constrained_delaunay`, which see for errors and sources.
    """
    return complex_of(domain, domain.sampled(size), progress=progress)


def complex_of(
    domain: Domain, sampled: Sampled, *, hull: bool = False, progress: bool = False
) -> PlanarComplex:
    """`planar_complex` for pieces that are cut already.

    Parameters
    ----------
    domain : Domain
    sampled : Sampled
        As `Domain.sampled` gives it; further points may follow.
    hull : bool
        Whether everything within the convex hull is inside.
    progress : bool
        Show a bar while segments go in.

    Returns
    -------
    PlanarComplex
    """
    facets = len(domain.facets)
    if not facets and not hull:
        raise InputError("the domain has no facets, so nothing is inside: give some, or take hull=True")
    complex_ = PlanarComplex(sampled.points, progress=progress)
    insert_all(complex_, sampled.ends, sampled.piece, sampled.span, facets=facets, progress=progress)
    mark_regions(complex_, facets, domain.regions, hull)
    return complex_


# ---------------------------------------------------------------------- segments


def insert_all(
    complex_: PlanarComplex,
    ends: NDArray[np.int32],
    piece: NDArray[np.int32],
    span: NDArray[np.float64],
    *,
    facets: int,
    progress: bool = False,
) -> NDArray[np.int64]:
    """Insert subsegments into a complex that has none: exact, every one ends up as an edge or several.

    Parameters
    ----------
    complex_ : PlanarComplex
    ends : ndarray of int32, shape (s, 2)
    piece : ndarray of int32, shape (s,)
    span : ndarray, shape (s, 2)
    facets : int
        How many pieces are facets; messages call the others inner segments (with -1, all are edges).
    progress : bool
        Show a bar.

    Returns
    -------
    ndarray of int64, shape (s,)
        How many triangles each of them crossed when its turn came: 0 for those that were there.

    Raises
    ------
    InputError
        For segments that cross or overlap: both are named. The complex is then of no use.
    """
    count, n = complex_.triangles, complex_.size
    corner = np.empty(n, dtype=np.int32)
    fill_corners(complex_.vertex, 3 * count, corner)
    missing = np.empty(len(ends), dtype=bool)
    where, pending = np.empty(len(ends), dtype=np.int32), np.empty(8 * count + 8, dtype=np.int32)
    status, i, other = mark_present(
        complex_.vertex, complex_.twin, complex_.mark, corner, ends, where, missing
    )
    if status != DONE:
        raise _refusal(status, int(i), int(other), ends, piece, facets)
    rows = np.flatnonzero(missing)
    order = rows[_order(corner[ends[rows, 0]], count)]
    chains, crossed = np.empty((3, count + 2), dtype=np.int64), np.zeros(len(ends), dtype=np.int64)
    scratch, stack = np.empty((8, count + 3), dtype=np.int64), np.empty((count + 3, 3), dtype=np.int64)
    bar = progress_bar(progress, " segments", total=len(ends))
    bar.update(len(ends) - len(order))
    for start in range(0, len(order), CHUNK):
        stop = min(start + CHUNK, len(order))
        status, i, other = insert_segments(
            complex_.xy, complex_.vertex, complex_.twin, complex_.mark, corner, ends, order, start, stop,
            crossed, PATIENCE, *chains, scratch, stack, where, pending,
        )  # fmt: skip
        if status != DONE:
            raise _refusal(status, int(i), int(other), ends, piece, facets)
        bar.update(stop - start)
    bar.close()
    _enter(complex_, ends, piece, span, where, known=len(order) == 0)
    return crossed


def _order(slots: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """Random rounds, each eight times as large as those before, along the curve that the triangles follow.

    Where many long segments cross many triangles, an order without rounds can cost a hundred times more.
    """
    draw = draws(len(slots), 2**32)
    rounds = np.full(len(slots), 15, dtype=np.int64)
    share = 3
    while len(slots) >> share > 32:
        rounds -= draw < 2 ** (32 - share)
        share += 3
    bits = int(count).bit_length() + 2
    return radix_argsort((rounds << bits) | slots, bits + 4)


def _refusal(status: int, i: int, other: int, ends: NDArray, piece: NDArray, facets: int) -> InputError:
    def name(s: int) -> str:
        p = int(piece[s])
        if facets < 0:
            kind = f"edges[{p}]"
        else:
            kind = f"facet {p}" if p < facets else f"inner segment {p - facets}"
        return f"{kind} (vertices {ends[s, 0]} and {ends[s, 1]})"

    if ends[i, 0] == ends[i, 1]:
        return InputError(f"{name(i)} leads nowhere: its ends must be different vertices")
    if status in (LEAVES, LOST):
        return InputError(f"{name(i)} leaves the mesh: take a mesh that covers it")
    verb = "crosses" if status == CROSSES else "overlaps"
    return InputError(
        f"{name(i)} {verb} {name(other)}: segments may meet at vertices only; "
        "a Domain with resolve=True cuts them"
    )


def _enter(
    complex_: PlanarComplex, ends: NDArray, piece: NDArray, span: NDArray, where: NDArray, known: bool
) -> None:
    """Number the subsegments that the segments have become, in their order, and enter them.

    ``known``: each is one edge, and ``where`` has its half-edge.
    """
    slots = 3 * complex_.triangles
    complex_.state[SEGMENTS] = len(ends)
    if known or carriers(complex_.vertex, complex_.mark, slots, ends, where) == 2 * len(ends):
        complex_.ends, complex_.piece, complex_.span, complex_.where = (
            ends.copy(),
            piece.copy(),
            span.copy(),
            where,
        )
        return
    half = np.flatnonzero(complex_.mark[:slots] >= 0)
    vertex, of = complex_.vertex, complex_.mark[half]
    start, stop = vertex[_next(half)], vertex[_prev(half)]
    a, b = complex_.xy[ends[of, 0]], complex_.xy[ends[of, 1]]
    axis = np.abs(b - a).argmax(axis=1)  # vertices on a segment are told apart along its longer side
    rows = np.arange(len(half))
    x, y = complex_.xy[start][rows, axis], complex_.xy[stop][rows, axis]
    low, high = a[rows, axis], b[rows, axis]
    keep = (x < y) == (low < high)
    order = np.lexsort([np.where(low < high, x, -x)[keep], of[keep]])
    pick = np.flatnonzero(keep)[order]
    t = np.clip((np.stack([x, y]) - low) / (high - low), 0.0, 1.0)[:, pick]
    segment = of[pick]
    s0, s1 = span[segment].T
    complex_.ends = np.column_stack([start[pick], stop[pick]]).astype(np.int32)
    complex_.piece, complex_.where = piece[segment], half[pick].astype(np.int32)
    complex_.span = (s0 + t * (s1 - s0)).T.copy()
    where = complex_.where
    complex_.mark[where] = np.arange(len(where), dtype=np.int32)
    complex_.mark[complex_.twin[where]] = np.arange(len(where), dtype=np.int32)
    complex_.state[SEGMENTS] = len(where)


def _next(e: NDArray) -> NDArray:
    return np.where(e % 3 == 2, e - 2, e + 1)


def _prev(e: NDArray) -> NDArray:
    return np.where(e % 3 == 0, e + 2, e - 1)


# ---------------------------------------------------------------------- regions


def mark_regions(complex_: PlanarComplex, facets: int, regions: dict[str, NDArray], hull: bool) -> None:
    """Flood the inside and number its connected parts; parts with a named seed first."""
    count = complex_.triangles
    part, mark, piece = complex_.region[:count], complex_.mark, complex_.piece
    stack = np.empty(3 * count + 3, dtype=np.int32)
    least = np.empty(count, dtype=np.int32)
    odd, parts = flood(complex_.vertex, complex_.twin, mark, piece, facets, hull, part, stack, least)
    if odd >= 0:
        a, b = complex_.ends[odd].tolist()
        raise InputError(
            f"facet {complex_.piece[odd]} (vertices {a} and {b}) has the same side of the boundary on both "
            "sides: the facets do not close; make them rings, or inner segments"
        )
    if parts == 0:
        raise InputError("the facets bound no area, so nothing is inside: check the domain")
    if parts == 1 and not regions:
        return
    number = np.zeros(parts, dtype=np.int32)  # by the least vertex in each, not by where the slots are
    if parts > 1:
        number[np.argsort(least[:parts], kind="stable")] = np.arange(parts)
    label = _named(complex_, regions, part, number) if regions else number
    part[:] = np.append(label, np.int32(-1))[part]


def _named(
    complex_: PlanarComplex, regions: dict[str, NDArray], part: NDArray, number: NDArray[np.int32]
) -> NDArray[np.int32]:
    """For each part the place of the name of its seed, or, in the order of ``number``, further numbers."""
    names, count = list(regions), complex_.triangles
    named = np.full(len(number), -1, dtype=np.int32)
    for k, name in enumerate(names):
        seeds = np.asarray(regions[name], dtype=np.float64).reshape(-1, 2)
        found = hold_seeds(complex_.xy, complex_.vertex, complex_.mark, count, seeds * complex_.factor)
        for row, slot in enumerate(found.tolist()):
            p = part[slot] if slot >= 0 else -1
            where = f"regions[{name!r}][{row}] = {seeds[row].tolist()}"
            if slot == -2:
                raise InputError(f"{where} lies on a segment: move it into one of the parts")
            if p < 0:
                raise InputError(f"{where} lies outside of the domain: move it inside")
            if named[p] not in (-1, k):
                raise InputError(f"{where} lies in one part with {names[named[p]]!r}: drop one of them")
            named[p] = k
    free = np.flatnonzero(named < 0)
    named[free[np.argsort(number[free])]] = len(names) + np.arange(len(free))
    return named
