"""Matching sides of a region: pieces that are others, moved by a translation or turned about a point."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...base.errors import InputError
from ...geometry.motion import Motion
from ...geometry.outline import Outline
from ...geometry.segment_tree import SegmentTree
from .prescribed import Match

__all__ = ["Matching", "matching", "pieces_of"]

MATCHING_SLACK = 2.0**-36  # of the extent: how far vertices may be from where they match, by default
CANDIDATES = 64  # translations from one vertex to its image that are tried as that of all
LOOKED_AT = np.linspace(0.0, 1.0, 17)  # parameters at which curves are compared


class Matching(NamedTuple):
    """What was found: the matches, and the points with those of the second pieces moved to match exactly."""

    matches: list[Match]
    points: np.ndarray
    moved: np.ndarray


def pieces_of(outline: Outline, which: Any, what: str) -> np.ndarray:
    """Piece numbers by the name of a marker, a number, or a list of numbers."""
    many = len(outline.pieces)
    if isinstance(which, str):
        if which not in outline.markers:
            raise InputError(f"{what} names marker {which!r}, but the markers are {sorted(outline.markers)}")
        return outline.markers[which]
    array = np.atleast_1d(np.asarray(which))
    if array.ndim != 1 or array.dtype.kind not in "iu" or len(array) == 0:
        raise InputError(f"{what} must be the name of a marker or piece numbers, not {which!r:.60}")
    if not 0 <= array.min() <= array.max() < many:
        raise InputError(f"{what} names pieces outside 0..{many - 1}: {which!r:.60}")
    return np.unique(array)


def matching(
    outline: Outline, first: Any, second: Any, motion: Motion | None, tolerance: float | None
) -> Matching:
    """Find for each of the first pieces its image among the second ones; see `Domain.matched`."""
    one, two = pieces_of(outline, first, "first"), pieces_of(outline, second, "second")
    taken = {piece for match in outline.matches for piece in match[:2]}
    for piece in [*sorted(taken & {*one.tolist(), *two.tolist()}), *np.intersect1d(one, two).tolist()]:
        raise InputError(f"{outline.name(piece)} would be matched twice: a piece has one image")
    a, b = np.unique(outline.pieces[one]), np.unique(outline.pieces[two])
    if len(one) != len(two) or len(a) != len(b):
        raise InputError(
            f"{first!r} has {len(one)} pieces and {len(a)} vertices, {second!r} {len(two)} and {len(b)}: "
            "they must have the same, with vertices at the same places"
        )
    points = outline.points
    slack = MATCHING_SLACK * float(np.ptp(points, axis=0).max()) if tolerance is None else tolerance
    guess = motion or Motion.translation(points[b].mean(axis=0) - points[a].mean(axis=0))
    away, nearest = SegmentTree(points[b]).least(guess(points[a]), 1.0)
    far = int(np.argmax(away))
    if away[far] > 2 * slack or len(np.unique(nearest)) < len(b):
        x, y = points[a[far]]
        raise InputError(
            f"point {a[far]} at ({x:.6g}, {y:.6g}), {guess}, is {away[far]:.3g} from the nearest vertex of "
            f"{second!r}, more than the tolerance {slack:.3g}: {first!r} and {second!r} must be equal up to "
            f"a {'rotation' if any(guess.center) or guess.matrix[1][0] else 'translation'}"
        )
    b = b[nearest]
    exact = motion or Motion.translation(_translation(points[a], points[b], slack))
    new = points.copy()
    new[b] = exact(points[a])
    if not np.array_equal(new[b], exact(new[a])):
        raise InputError(
            f"{first!r} and {second!r} share vertices, which cannot all be moved to match exactly"
        )
    image = dict(zip(a.tolist(), b.tolist()))
    matches = _paired(outline, one, two, image, exact, 4 * slack)
    for match in outline.matches:
        p, q = outline.pieces[match.first], outline.pieces[match.second]
        if not np.array_equal(new[q[::-1] if match.turned else q], match.motion(new[p])):
            raise InputError(
                f"{first!r} and {second!r} match only if vertices move that others match: give points that "
                "match exactly"
            )
    return Matching(matches, new, np.flatnonzero((new != points).any(axis=1)))


def _translation(a: np.ndarray, b: np.ndarray, slack: float) -> np.ndarray:
    """A translation that is exact for all vertices, if one of those between two is; else their median."""
    every = b - a
    for candidate in np.unique(every, axis=0)[:CANDIDATES]:
        if np.array_equal(a + candidate, b):
            return candidate
    middle = np.median(every, axis=0)
    return np.where(np.abs(middle) <= slack, 0.0, middle)


def _paired(
    outline: Outline, one: np.ndarray, two: np.ndarray, image: dict[int, int], motion: Motion, slack: float
) -> list[Match]:
    """For each of the first pieces the second one with the same ends, and the same curve."""
    between: dict[tuple[int, int], list[int]] = {}
    for piece in two.tolist():
        u, v = outline.pieces[piece].tolist()
        between.setdefault((min(u, v), max(u, v)), []).append(piece)
    found = []
    for piece in one.tolist():
        u, v = (image[end] for end in outline.pieces[piece].tolist())
        for other in between.get((min(u, v), max(u, v)), []):
            turned = outline.pieces[other, 0] != u
            if piece in outline.curves or other in outline.curves:
                x, y = motion(outline.at(piece, LOOKED_AT)), outline.at(other, LOOKED_AT)
                if np.abs(x - (y[::-1] if turned else y)).max() > slack:
                    continue
            found.append(Match(piece, other, bool(turned), motion))
            between[min(u, v), max(u, v)].remove(other)
            break
        else:
            raise InputError(
                f"{outline.name(piece)} has no image between points {u} and {v}: the second pieces must be "
                "the first ones moved, with the same curves"
            )
    return found
