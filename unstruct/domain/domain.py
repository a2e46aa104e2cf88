"""Domain: a planar region to be meshed, bounded by segments, arcs and curves, even-odd.

See the book, chapters 2.5 and 2.6d.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import fsum
from typing import Any, NamedTuple

import numpy as np

from ..base.arguments import positive
from ..base.arrays import as_numbers, as_points, frozen
from ..base.errors import InputError
from ..geometry.curves import Arc, CurveLike
from ..geometry.parity import enclosed_area, even_odd, left_parity
from .arguments import as_curves, as_markers, as_seeds, as_segments
from .constructors import Constructors
from .plane.faults import check_ends, check_seeds, find_faults, piece_name
from .plane.lunes import areas_beyond_chords, lunes_hold
from .plane.repair import Repair, Repairer
from .plane.sample import Sampled, coarse, sized

__all__ = ["Cuts", "Domain"]


class Cuts(NamedTuple):
    """What a compiled kernel needs to find points on pieces.

    Attributes
    ----------
    kind : (p,) int8
        0 straight, 1 arc, 2 other: ask `Domain.at`.
    arc : (p, 5) float64
        For arcs center x, center y, radius, start and sweep, as in `Arc`; else 0.
    """

    kind: np.ndarray
    arc: np.ndarray


class Domain(Constructors):
    """A planar region: what is to be meshed.

    *Pieces* are numbered through: facets 0 to f - 1, then inner segments f to f + g - 1. Each is straight
    unless ``curves`` has a curve for it.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Vertices. Those that no piece uses are `loose`: they become vertices of the mesh if they lie inside.
    facets : array_like of int, shape (f, 2)
        Pieces that bound the region: inside is what an odd number of them separates from infinity, so
        that chains within chains are holes, islands, and so on, in any order and direction. At every vertex
        an even number must meet.
    inner : array_like of int, shape (g, 2), optional
        Interfaces, cracks, loose segments: present in the mesh where they lie inside; they may dangle or
        close and never make holes.
    curves : dict of int to curve, optional
        Piece -> `Arc`, `Curve`, `Bezier` or another object with ``point(t)``, from the first vertex of
        the piece to its second.
    markers : dict of str to array_like of int, optional
        Name -> pieces.
    regions : dict of str to array_like, shape (r, 2), optional
        Name -> seeds, points inside. A part of the region (as facets and inner pieces divide it) takes the
        name of the seed in it.
    resolve : bool, optional
        Repair what can be repaired instead of raising; `repairs` gives an account.

    Raises
    ------
    InputError
        For arrays of wrong shape or type, indices out of range, duplicate points, pieces of zero length,
        repeated, crossing or overlapping pieces, vertices on pieces, an odd number of facets at a vertex,
        curves that miss their ends, cross or touch, and seeds outside. The message names the first culprits,
        the place and the remedy.

    Attributes
    ----------
    points, facets, inner, curves, markers, regions
        As given (after repairs), arrays read-only.
    repairs : list of Repair
        What ``resolve`` did; empty without it, and where nothing was wrong.
    max_areas : dict of str to float
        Area bounds of regions by name, as `Domain.read` found them; `refine` takes them.
    origin : (n,) int32
        The input point that each point is, -1 for crossings; all of them but for ``resolve``.
    piece_origin : (f + g,) int32
        The input piece that each piece is part of, -1 for one that closes a gap.

    Notes
    -----
    Faults are found by exact signs in O(n log n): about a second for 10^5 segments. The region is meshed as
    it is stored, without tolerances. Book: 2.5, 2.6d.
    """

    def __init__(
        self,
        points: Any,
        facets: Any,
        *,
        inner: Any = None,
        curves: Mapping[int, CurveLike] | None = None,
        markers: Mapping[str, Any] | None = None,
        regions: Mapping[str, Any] | None = None,
        resolve: bool = False,
    ):
        coordinates = as_points(points)
        if coordinates.shape[1] != 2:
            raise InputError(f"points must have shape (n, 2), not {coordinates.shape}")
        self.points: np.ndarray = frozen(coordinates.copy())  # what was validated must not change
        self.facets: np.ndarray = as_segments(facets, "facets")
        self.inner: np.ndarray = as_segments(() if inner is None else inner, "inner")
        many = len(self.facets) + len(self.inner)
        self.curves: dict[int, CurveLike] = as_curves(curves or {}, many)
        self.markers: dict[str, np.ndarray] = as_markers(markers or {}, many)
        self.regions: dict[str, np.ndarray] = as_seeds(regions or {})
        self.repairs: list[Repair] = []
        self.max_areas: dict[str, float] = {}
        self.origin: np.ndarray = frozen(np.arange(len(self.points), dtype=np.int32))
        self.piece_origin: np.ndarray = frozen(np.arange(many, dtype=np.int32))
        if resolve:
            self._resolve()
        faults = find_faults(self)
        if faults:
            rest = len(faults) - 1
            more = f" (and {rest} more fault{'s' if rest > 1 else ''})" if rest else ""
            raise InputError(faults[0].text + more)
        check_ends(self)
        _ = self._coarse
        check_seeds(self)

    # ------------------------------------------------------------------ pieces

    @property
    def pieces(self) -> np.ndarray:
        """Facets, then inner segments: (f + g, 2) int32."""
        return self._pieces

    @cached_property
    def _pieces(self) -> np.ndarray:
        return frozen(np.concatenate([self.facets, self.inner]))

    @cached_property
    def loose(self) -> np.ndarray:
        """Vertices that no piece uses: (k,) int32."""
        used = np.zeros(len(self.points), dtype=bool)
        used[self.pieces.ravel()] = True
        return frozen(np.nonzero(~used)[0].astype(np.int32))

    def name(self, piece: int) -> str:
        """How messages call a piece: "facet 3", "inner segment 0"."""
        return piece_name(piece, len(self.facets))

    def at(self, piece: int, t: Any) -> np.ndarray:
        """Points of one piece by parameter.

        Parameters
        ----------
        piece : int
        t : array_like, shape (k,)
            Parameters from 0, the first vertex of the piece, to 1, its second.

        Returns
        -------
        (k, 2) float64
            Points of the true curve; the stored vertices at 0 and 1.
        """
        t = np.atleast_1d(as_numbers(t, "t"))
        if not 0 <= piece < len(self.pieces):
            raise InputError(f"piece {piece} outside 0..{len(self.pieces) - 1}")
        if not ((t >= 0) & (t <= 1)).all():
            raise InputError(f"parameter {t[~((t >= 0) & (t <= 1))][0]} must lie in [0, 1]")
        return self.points_at(np.full(len(t), piece), t)

    def points_at(self, piece: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points of many pieces by parameter: piece (k,), t (k,) to (k, 2); nothing is checked."""
        a, b = self.points[self.pieces[piece]].transpose(1, 0, 2)
        x = np.where((t < 0.5)[:, None], a + t[:, None] * (b - a), b - (1 - t)[:, None] * (b - a))
        if self.curves:
            for number, rows in self._curved_rows(piece):
                x[rows] = self.curves[number].point(t[rows])
            x = np.where((t == 0)[:, None], a, np.where((t == 1)[:, None], b, x))
        return x

    def _curved_rows(self, piece: np.ndarray) -> list[tuple[int, np.ndarray]]:
        rows = np.nonzero(np.isin(piece, list(self.curves)))[0]
        rows = rows[np.argsort(piece[rows], kind="stable")]
        heads = np.nonzero(np.diff(piece[rows], prepend=-1))[0]
        return [(int(piece[part[0]]), part) for part in np.split(rows, heads[1:]) if len(part)]

    def cuts(self) -> Cuts:
        """Kind and arc of every piece as plain arrays, for kernels."""
        kind, arc = np.zeros(len(self.pieces), dtype=np.int8), np.zeros((len(self.pieces), 5))
        for piece, curve in self.curves.items():
            kind[piece] = 1 if isinstance(curve, Arc) else 2
            if isinstance(curve, Arc):
                arc[piece] = *curve.center, curve.radius, curve.start, curve.sweep
        return Cuts(kind, arc)

    # ------------------------------------------------------------------ subsegments

    def sampled(self, size: Any = None, *, step: float = 1.0) -> Sampled:
        """The pieces cut into straight subsegments.

        Parameters
        ----------
        size : number, function (k, 2) -> (k,), or size field, optional
            The wanted edge length. Without it straight pieces stay whole, and curves are cut as coarsely as
            is safe: a turn of at most 60 degrees for each chord, no chord meets another, no vertex lies
            between a chord and its curve.
        step : float, optional
            The wanted length of subsegments, in units of the size.

        Returns
        -------
        Sampled
            With a size: on each piece the whole number of subsegments next to the integral of ds / (step
            size), at equal steps of it, and cut further where that is not safe.

        Raises
        ------
        InputError
            For sizes that are not positive and finite, with the place.
        """
        if size is None:
            return self._coarse
        return sized(self, size, positive(step, "step"))

    @cached_property
    def _coarse(self) -> Sampled:
        return coarse(self)

    # ------------------------------------------------------------------ inside and outside

    def contains(self, x: Any) -> np.ndarray:
        """Whether points lie inside, by the even-odd rule.

        Parameters
        ----------
        x : array_like, shape (..., 2)

        Returns
        -------
        ndarray of bool, shape (...)
            Exact for straight facets, points on them included, which count as inside. A point on a curve,
            up to rounding, may fall on either side.
        """
        queries = as_numbers(x, "x")
        if queries.ndim == 0 or queries.shape[-1] != 2:
            raise InputError(f"x must have shape (..., 2), not {queries.shape}")
        rows = as_points(queries.reshape(-1, 2), "x")
        sampled = self._coarse
        facets = sampled.piece < len(self.facets)
        bent = facets & np.isin(sampled.piece, list(self.curves))
        odd, on = even_odd(sampled.points, sampled.ends[facets], rows)
        if bent.any():
            odd ^= lunes_hold(self, sampled, np.nonzero(bent)[0], rows)
            on = even_odd(sampled.points, sampled.ends[facets & ~bent], rows)[1]
        return (odd | on).reshape(queries.shape[:-1])

    @cached_property
    def area(self) -> float:
        """The area inside: for straight facets correctly rounded; curves add to rounding error only."""
        sampled = self._coarse
        rows = np.nonzero(sampled.piece < len(self.facets))[0]
        ends = sampled.ends[rows]
        left = left_parity(sampled.points, ends)
        straight = enclosed_area(sampled.points, np.where(left[:, None], ends, ends[:, ::-1]))
        if not self.curves:
            return straight
        return fsum([straight, *areas_beyond_chords(self, sampled, rows, left)])

    @cached_property
    def bounds(self) -> np.ndarray:
        """((x least, y least), (x greatest, y greatest)) of the points and of curves (closely)."""
        sampled = self._coarse
        points = [sampled.points]
        if self.curves:
            piece = np.repeat(list(self.curves), 257)
            points.append(self.points_at(piece, np.tile(np.linspace(0, 1, 257), len(self.curves))))
        every = np.concatenate(points)
        return np.stack([every.min(axis=0), every.max(axis=0)])

    # ------------------------------------------------------------------ validation

    def _resolve(self) -> None:
        mended = Repairer(self.points, self.facets, self.inner, self.curves, self.markers)
        mended.run()
        pieces = [p for p in mended.pieces if p.facet] + [p for p in mended.pieces if not p.facet]
        many = sum(p.facet for p in pieces)
        rows = np.array([(p.a, p.b) for p in pieces], dtype=np.int32).reshape(-1, 2)
        self.points, self.origin = frozen(mended.points), frozen(mended.origin.astype(np.int32))
        self.facets, self.inner = frozen(rows[:many]), frozen(rows[many:])
        self.piece_origin = frozen(np.array([p.origin for p in pieces], dtype=np.int32))
        self.curves = {i: p.curve for i, p in enumerate(pieces) if p.curve is not None}
        self.markers = {
            name: frozen(np.array([i for i, p in enumerate(pieces) if name in p.names], dtype=np.int32))
            for name in self.markers
        }
        self.repairs = mended.repairs

    def __repr__(self) -> str:
        curves = f", {len(self.curves)} curved" if self.curves else ""
        inner = f", {len(self.inner)} inner" if len(self.inner) else ""
        loose = f", {len(self.loose)} loose" if len(self.loose) else ""
        return f"<Domain: {len(self.points)} points, {len(self.facets)} facets{inner}{loose}{curves}>"
