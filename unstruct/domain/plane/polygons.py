"""A polygon with holes as a domain: its outer ring minus its holes, in whatever way they meet.

Straight rings are united by `covering`. Of rings with curves, and of whole domains, one is subtracted from
another piece by piece: after all crossings have been split, each piece lies inside or outside of the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...base.arrays import frozen
from ...base.errors import InputError
from ...geometry.boxes import BoxTree
from ...geometry.outline import Outline
from ...geometry.parity import on_the_right, right_parity
from ..arguments import as_curves, as_segments, composed, named_parts
from .account import Repair
from .covering import Rings, covered
from .faults import find_faults, first_copies

__all__ = ["polygon", "subtracted"]

Make = Callable[[dict[str, Any], Mapping[str, Any]], Any]  # arguments, further options -> Domain


def polygon(make: Make, parts: dict[str, Any], names: Sequence[str], options: Mapping[str, Any]) -> Any:
    """A `Domain` of an outer ring and holes.

    Parameters
    ----------
    make : function
        Makes a domain of ready-made arguments and the caller's options.
    parts : dict
        The corners and sides along all rings, and curves.
    names : sequence of str
        What messages call the rings.
    options : dict
        The caller's; numbers of points and pieces in them refer to ``parts``.

    Returns
    -------
    Domain
        If rings meet in more than common corners, they are split there; ``origin`` and ``piece_origin`` refer
        to ``parts``.

    Raises
    ------
    InputError
        For a hole outside of the outer ring, or that overlaps another one, unless this is to be resolved.

    Notes
    -----
    Only rings that do not fit together are triangulated. In the usual case each hole takes one ray.
    """
    if len(names) == 1:
        return make(parts, options)
    facets = np.asarray(parts["facets"], dtype=np.int32)
    ring = np.concatenate([[0], np.cumsum(facets[:, 1] < facets[:, 0])[:-1]])  # a ring's last side goes back
    number, kept, whole = _touching(parts["points"], ring)
    points, sides = parts["points"][kept], number[facets]
    straight = not parts.get("curves") and not options.get("curves")
    resolve = bool(options.get("resolve"))
    fault: InputError | None = None
    if not (resolve and straight) or _sound(points, sides, ring):
        try:
            domain = make({**parts, "points": points, "facets": sides}, _renumbered(options, number))
        except InputError as error:
            fault = error
        else:
            if straight and not len(_misplaced(domain, ring)):
                domain.origin = composed(kept.astype(np.int32), domain.origin)
                return domain
            if not straight:
                domain.origin = composed(kept.astype(np.int32), domain.origin)
                return _minus(make, domain, ring, names, resolve=resolve)
    if fault is not None and not (straight and whole):
        raise fault
    return _united(make, parts, facets, ring, names, options)


def _touching(points: np.ndarray, ring: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """(number, kept, whole): corners of different rings that are equal become one vertex.

    ``number`` is the vertex of each corner, ``kept`` the first corner of each vertex. Equal corners of one
    ring remain different, and then ``whole`` is false.
    """
    first = first_copies(points)
    other = ring[first] != ring
    whole = bool((other | (first == np.arange(len(first)))).all())
    first = np.where(other, first, np.arange(len(first)))
    keep = first == np.arange(len(first))
    number = (np.cumsum(keep, dtype=np.int32) - np.int32(1))[first]
    return number, np.flatnonzero(keep), whole


def _renumbered(options: Mapping[str, Any], number: np.ndarray) -> dict[str, Any]:
    """The options, inner segments between vertices instead of corners."""
    if options.get("inner") is None:
        return dict(options)
    rows = as_segments(options["inner"], "inner")
    known = (rows >= 0) & (rows < len(number))
    return {**options, "inner": np.where(known, number[np.where(known, rows, 0)], rows)}


def _sound(points: np.ndarray, sides: np.ndarray, ring: np.ndarray) -> bool:
    """Whether nothing has to be resolved."""
    outline = Outline(points, sides, sides[:0], {}, {}, {})
    return not find_faults(outline) and len(_wrong(points, sides, ring, _lowest(points, sides, ring))) == 0


# ---------------------------------------------------------------------- where holes lie


def _misplaced(domain: Any, ring: np.ndarray) -> np.ndarray:
    """Sides of straight holes that lie outside of the outer ring or within another hole, if there are any."""
    return _wrong(domain.points, domain.facets, ring, _lowest(domain.points, domain.facets, ring))


def _lowest(points: np.ndarray, sides: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """A side of each hole that begins at a lowest corner; the sides of each ring follow each other."""
    start = np.flatnonzero(np.diff(ring, prepend=-1))
    height = points[sides[:, 0], 1]
    least = np.repeat(np.minimum.reduceat(height, start), np.diff(start, append=len(ring)))
    lowest = np.flatnonzero(height == least)
    return lowest[np.flatnonzero(np.diff(ring[lowest], prepend=0))]


def _wrong(points: np.ndarray, sides: np.ndarray, ring: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Those of ``rows``, sides of holes, that do not lie inside of ring 0 and outside of all other holes.

    Rings do not cross, so one row is enough for a hole. If holes lie within others, at least one of them lies
    within exactly one other. Only holes whose box contains the beginning of a row can contain it.
    """
    inside = right_parity(points, sides[ring == 0], sides[rows])
    rest = np.flatnonzero(ring > 0)
    rest = rest[np.argsort(ring[rest], kind="stable")]
    start = np.flatnonzero(np.diff(ring[rest], prepend=0))
    corners, hole = points[sides[rest, 0]], ring[rest[start]]
    low, high = np.minimum.reduceat(corners, start), np.maximum.reduceat(corners, start)
    at = points[sides[rows, 0]]
    query, box = BoxTree(low, high).pairs(at, at)
    other = hole[box] != ring[rows[query]]
    near = np.flatnonzero(np.isin(ring, hole[box[other]]))
    some = np.unique(query[other])
    query, hit = on_the_right(points, sides[near], sides[rows[some]])
    query, hit = some[query], near[hit]
    other = ring[hit] != ring[rows[query]]
    within = np.bincount(query[other], minlength=len(rows)) % 2 == 1
    return rows[~inside | within]


# ---------------------------------------------------------------------- rings that meet


def _united(
    make: Make,
    parts: dict[str, Any],
    facets: np.ndarray,
    ring: np.ndarray,
    names: Sequence[str],
    options: Mapping[str, Any],
) -> Any:
    """The domain of straight rings that are split where they meet."""
    inner = as_segments(() if options.get("inner") is None else options["inner"], "inner")
    many, n = len(facets) + len(inner), len(parts["points"])
    wrong = np.flatnonzero(((inner < 0) | (inner >= n)).any(axis=1))
    if len(wrong):
        raise InputError(
            f"inner segment {wrong[0]} = {inner[wrong[0]].tolist()} refers to points outside 0..{n - 1}"
        )
    holes = np.arange(len(names)) > 0
    every = Rings(
        parts["points"],
        np.concatenate([facets, inner]).astype(np.int64),
        np.concatenate([ring, np.full(len(inner), -1)]),
        np.zeros(len(names), dtype=np.int64),
        holes,
    )
    result = covered(
        every,
        lambda r: names[r],
        lambda s: f"inner segment {s - len(facets)}",
        resolve=bool(options.get("resolve")),
    )
    if len(result.facets) == 0:
        raise InputError(f"the holes leave nothing of {names[0]}: correct them")
    as_curves(options.get("curves") or {}, many)
    marked = named_parts(options.get("markers") or {}, None, many, 2)[0]
    given, piece = result.parts.T
    markers = {name: np.unique(piece[np.isin(given, pieces)]) for name, pieces in marked.items()}
    made = {"points": result.points, "facets": result.facets, "markers": markers}
    rest = {key: value for key, value in options.items() if key not in ("inner", "markers")}
    domain = make(made, {**rest, "inner": result.inner if len(result.inner) else None})
    domain.repairs[:0] = result.repairs
    domain.origin = composed(result.origin, domain.origin)
    domain.piece_origin = composed(frozen(result.source), domain.piece_origin)
    return domain


# ---------------------------------------------------------------------- one domain minus others


def subtracted(
    make: Make, parts: dict[str, Any], group: np.ndarray, names: Sequence[str], *, resolve: bool
) -> Any:
    """Group 0 of facets minus all other groups; for ``group``, ``names`` and errors see `_minus`.

    ``parts`` are all arguments of a `Domain` of all groups together.
    """
    if resolve and not parts["curves"]:
        options = {name: parts[name] for name in ("inner", "markers", "regions")}
        return _united(make, parts, parts["facets"], group, names, {**options, "resolve": True})
    return _minus(make, make(parts, {"resolve": resolve}), group, names, resolve=resolve)


def _minus(make: Make, domain: Any, group: np.ndarray, names: Sequence[str], *, resolve: bool) -> Any:
    """A domain without the pieces that do not bound "group 0 minus all other groups".

    Parameters
    ----------
    make : function
        As for `polygon`.
    domain : Domain
        Its pieces may meet in vertices only.
    group : ndarray of int, shape (f,)
        The group of each facet that the domain was made of (`Domain.piece_origin` refers to them). The facets
        of a group bound a region.
    names : sequence of str
        What messages call the groups.
    resolve : bool
        Whether there may be such pieces; the account then says so.

    Raises
    ------
    InputError
        For a piece of another group that lies outside of group 0, and for one within another group. For
        pieces of two groups that coincide, which have cancelled each other.
    """
    for repair in domain.repairs:
        both = sorted({int(group[p]) for p in repair.pieces if p < len(group)})
        if repair.kind == "repeated segment" and len(both) > 1:
            x, y = repair.place
            raise InputError(
                f"{names[both[1]]} and {names[both[0]]} share a side near ({x:.6g}, {y:.6g}), which cannot "
                "be resolved beside curves: move one of them, or leave the side out"
            )
    if len(domain.facets) == 0:
        raise InputError(f"the holes leave nothing of {names[0]}: correct them")
    origin = domain.piece_origin[: len(domain.facets)]
    known = (origin >= 0) & (origin < len(group))
    of = np.where(known, group[np.where(known, origin, 0)], 0)
    keep, row, sampled = _bounding(domain, of)
    if keep.all():
        return domain
    piece = int(np.argmax(~keep & (of > 0))) if (~keep & (of > 0)).any() else int(np.argmin(keep))
    x, y = sampled.points[sampled.ends[row[piece]]].mean(axis=0).tolist()
    text = f"{names[int(of[piece])]} lies outside {names[0]} or within another hole near ({x:.6g}, {y:.6g})"
    if not resolve:
        raise InputError(
            f"{text}; correct it, let resolve=True subtract what lies inside, or give all rings as facets "
            "of one Domain, whose inside is even-odd"
        )
    left = np.flatnonzero(np.concatenate([keep, np.ones(len(domain.inner), dtype=bool)]))
    if not keep.any():
        raise InputError(f"the holes leave nothing of {names[0]}: correct them")
    number = np.full(len(domain.pieces), -1)
    number[left] = np.arange(len(left))
    points = np.unique(np.concatenate([domain.pieces[left].ravel(), domain.loose]))
    place = np.full(len(domain.points), -1)
    place[points] = np.arange(len(points))
    made = {
        "points": domain.points[points],
        "facets": place[domain.facets[keep]],
        "inner": place[domain.inner] if len(domain.inner) else None,
        "curves": {int(number[p]): curve for p, curve in domain.curves.items() if number[p] >= 0},
        "markers": {name: number[rows][number[rows] >= 0] for name, rows in domain.markers.items()},
        "regions": domain.regions,
    }
    result = make(made, {})
    result.origin = composed(domain.origin, points.astype(np.int32))
    result.piece_origin = composed(domain.piece_origin, left.astype(np.int32))
    text += "; what bounds nothing was left out"
    result.repairs = [*domain.repairs, Repair("hole outside", text, (x, y))]
    return result


def _bounding(domain: Any, of: np.ndarray) -> tuple[np.ndarray, np.ndarray, Any]:
    """Which facets are to stay; a subsegment of each; and all subsegments.

    A facet of group 0 must lie outside of all others; one of another group inside of group 0 and outside of
    the rest. Curves give way to their chords, which bound the same regions.
    """
    sampled = domain.sampled()
    facets = np.flatnonzero(sampled.piece < len(domain.facets))
    row = facets[np.unique(sampled.piece[facets], return_index=True)[1]]
    query, hit = on_the_right(sampled.points, sampled.ends[facets], sampled.ends[row])
    many = int(of.max()) + 1
    beyond = of[sampled.piece[facets[hit]]]
    other = beyond != of[query]
    keys, times = np.unique(query[other] * many + beyond[other], return_counts=True)
    keys = keys[times % 2 == 1]
    inside = np.bincount(keys[keys % many == 0] // many, minlength=len(of)) > 0
    within = np.bincount(keys[keys % many > 0] // many, minlength=len(of)) > 0
    return (inside | (of == 0)) & ~within, row, sampled
