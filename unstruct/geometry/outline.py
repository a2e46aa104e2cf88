"""Outline: what bounds a region in the plane or a body in space, as arrays and curves; part of a `Domain`.

Nothing is checked here. See the book, chapters 2.5, 2.6d and 2.8b.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import as_numbers, frozen
from ..base.errors import InputError
from ..base.jit import kernel
from .curves import Batch, CurveLike
from .polygons import Polygons

__all__ = ["Cuts", "Outline", "piece_name"]


class Cuts(NamedTuple):
    """The arrays from which a compiled kernel computes points on pieces.

    Attributes
    ----------
    kind : (p,) int8
        0 for a straight piece, 1 for an arc, 2 for any other curve, whose points `Outline.at` gives.
    arc : (p, 5) float64
        For arcs: center x, center y, radius, start and sweep, as in `Arc`; for other pieces 0.
    """

    kind: np.ndarray
    arc: np.ndarray


class Outline:
    """Vertices and pieces, straight or curved, with names; the functions that work on a `Domain` read it.

    Pieces are numbered consecutively: facets 0 to f - 1, then inner pieces f to f + g - 1.

    Parameters
    ----------
    points : ndarray, shape (n, 2) or (n, 3)
    facets : ndarray of int32, shape (f, 2)
        Pieces that bound the region, by the even-odd rule. In space they are triangles, shape (f, 3), or
        `Polygons`.
    inner : ndarray of int32, shape (g, 2)
        Pieces that do not bound the region. In space they are `Polygons`, segments among them.
    curves : dict of int to curve
        Piece -> the curve from its first vertex to its second; all other pieces are straight.
    markers : dict of str to ndarray of int
        Name -> pieces.
    regions : dict of str to ndarray, shape (r, 2)
        Name -> seeds.

    Notes
    -----
    Nothing is checked here. `Domain` checks its arguments before it makes an outline available.
    """

    def __init__(
        self,
        points: np.ndarray,
        facets: Any,
        inner: Any,
        curves: dict[int, CurveLike],
        markers: dict[str, np.ndarray],
        regions: dict[str, np.ndarray],
    ):
        self.points, self.facets, self.inner = points, facets, inner
        self.curves, self.markers, self.regions = curves, markers, regions
        self.spacings: dict[int, np.ndarray] = {}  # piece -> parameters of the points that it must have
        self.matches: list[Any] = []  # pairs of pieces of which one is the other, moved

    @property
    def pieces(self) -> Any:
        """Facets, then inner pieces: (f + g, 2) int32; in space `Polygons`."""
        return self._pieces

    @cached_property
    def _pieces(self) -> Any:
        if self.points.shape[1] == 3:
            return Polygons.joined(Polygons.of(self.facets), Polygons.of(self.inner))
        return frozen(np.concatenate([self.facets, self.inner])) if len(self.inner) else self.facets

    @cached_property
    def loose(self) -> np.ndarray:
        """Vertices that no piece uses: (k,) int32."""
        used = np.zeros(len(self.points), dtype=bool)
        used[self.pieces.ravel()] = True
        return frozen(np.nonzero(~used)[0].astype(np.int32))

    def held(self) -> np.ndarray:
        """For each piece whether it has the points that it must have, and gets no others: (p,) bool."""
        found = np.zeros(len(self.pieces), dtype=bool)
        found[[*self.spacings, *[piece for match in self.matches for piece in match[:2]]]] = True
        return found

    def name(self, piece: int) -> str:
        """The name of a piece in messages: "facet 3", "inner segment 0", "inner facet 2"."""
        polygon = self.points.shape[1] == 3 and self.pieces.corners[piece] > 2
        name = piece_name(piece, len(self.facets))
        return name.replace("segment", "facet") if polygon else name

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
            Points of the true curve; at 0 and 1 the stored vertices.
        """
        t = np.atleast_1d(as_numbers(t, "t"))
        if not 0 <= piece < len(self.pieces):
            raise InputError(f"piece = {piece} must lie in 0..{len(self.pieces) - 1}")
        if not ((t >= 0) & (t <= 1)).all():
            raise InputError(f"t = {t[~((t >= 0) & (t <= 1))][0]} must lie in [0, 1]")
        return self.points_at(np.full(len(t), piece), t)

    def points_at(self, piece: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points (k, 2) of many pieces (k,) by parameters (k,); nothing is checked."""
        x, piece, t = np.empty((len(t), 2)), np.asarray(piece, dtype=np.int64), np.ascontiguousarray(t)
        if self.curves:
            self.batch.fill(piece, t, x)
        _between(self.points, self.pieces, self.batch.kind, piece, t, x)
        return x

    @cached_property
    def batch(self) -> Batch:
        """All curves, to be asked together."""
        return Batch(self.curves, len(self.pieces))

    def cuts(self) -> Cuts:
        """The kind and the arc of every piece as plain arrays, for kernels."""
        if not self.curves:
            return Cuts(np.zeros(len(self.pieces), dtype=np.int8), np.zeros((len(self.pieces), 5)))
        return Cuts(np.minimum(self.batch.kind, 2).astype(np.int8), self.batch.arc.copy())


@kernel
def _between(points, pieces, kind, piece, t, x):
    """Write the points of straight pieces by parameter; of all pieces the vertices at 0 and 1."""
    for i in range(len(t)):
        a, b = pieces[piece[i], 0], pieces[piece[i], 1]
        for k in range(2):
            p, q = points[a, k], points[b, k]
            if t[i] == 0.0 or t[i] == 1.0:
                x[i, k] = p if t[i] == 0.0 else q
            elif kind[piece[i]] == 0:
                x[i, k] = p + t[i] * (q - p) if t[i] < 0.5 else q - (1.0 - t[i]) * (q - p)


def piece_name(piece: int, facets: int) -> str:
    """The name of a piece in messages."""
    return f"facet {piece}" if piece < facets else f"inner segment {piece - facets}"
