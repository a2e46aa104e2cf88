"""Chords in place of curves: so short that no cell is large enough to notice.

The states of cells are exact for straight pieces. A curve is cut into chords that deviate from it by less
than a small part of the smallest cell, so that only cells which the curve enters by less than that may be
taken for uncut. See the book, chapter 4a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.domain import Domain, as_domain
from ...domain.plane.sample import assemble, fine_chains, halve, safe, turning

__all__ = ["MOST_CHORDS", "Straight", "straightened"]

MOST_CUTS = 48  # a curve that is still rough has a kink
MOST_CHORDS = 1 << 22


class Straight(NamedTuple):
    """A planar domain of straight pieces in place of one with curves.

    Attributes
    ----------
    domain : Domain
    piece : (s,) int32
        The piece of the domain with curves of which each facet is a part.
    """

    domain: Domain
    piece: NDArray[np.int32]


def straightened(domain: Domain, deviation: float, turn: float = np.inf, most: int = MOST_CHORDS) -> Straight:
    """A planar domain with its curves cut into chords; straight pieces stay whole.

    Parameters
    ----------
    domain : Domain
    deviation : float
        No chord is farther from its curve than this, at eight places of each chord.
    turn : float
        No curve turns by more than this over a chord, in radians.
    most : int
        Beyond so many chords they are not halved for the sake of `turn`.

    Raises
    ------
    InputError
        If curves are not smooth, so that this takes more than four million chords.
    """
    sampled = domain.sampled()
    rows = np.flatnonzero(flagged(len(domain.pieces), list(domain.curves))[sampled.piece])
    for _ in range(MOST_CUTS):
        chains = fine_chains(domain, sampled, rows)
        rough = np.zeros(len(sampled.ends), dtype=bool)
        far, bent = _heights(chains) > deviation, turning(chains) > turn
        if len(rough) + int((far | bent).sum()) > most < MOST_CHORDS:
            turn, bent = np.inf, np.zeros(len(rows), dtype=bool)
        rough[rows] = far | bent
        if not rough.any():
            break
        if len(rough) + int(rough.sum()) > MOST_CHORDS:
            x, y = sampled.points[sampled.ends[np.argmax(rough), 0]]
            raise InputError(
                f"more than {MOST_CHORDS:,} chords are needed to follow the curves to within {deviation:g}, "
                f"most of them near ({x:.6g}, {y:.6g}): give a smaller max_level, or a vertex at each kink"
            )
        cut = rough[np.repeat(np.arange(len(rough)), np.where(rough, 2, 1))]
        sampled = assemble(domain, *halve(sampled, rough))
        rows = np.flatnonzero(cut)
    first, last = sampled.span.T.copy()
    done = safe(domain, sampled.piece, first, last, np.inf)
    return Straight(as_domain(done), done.piece[done.piece < len(domain.facets)])


def _heights(chains: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the points of each chain are from the chord between its ends, at most."""
    first, along = chains[:, :1], chains[:, -1:] - chains[:, :1]
    scale = np.ldexp(1.0, -np.frexp(np.abs(along).max(axis=(1, 2)))[1])[:, None]
    u, away = along * scale[:, :, None], (chains - first) * scale[:, :, None]
    cross = np.abs(u[..., 0] * away[..., 1] - u[..., 1] * away[..., 0]).max(axis=1)
    return cross / np.sqrt((u * u).sum(axis=(1, 2))) / scale[:, 0]
