"""What a front has made becomes rounder: edges are flipped, vertices moved along surface and curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...connect.surface.complex import SurfaceComplex
from ...geometry.support import Support
from ...sizing.field import SizeField
from .run import RemeshRun

__all__ = ["made_rounder"]

FRONT_ROUNDS = 4  # of flips and moves
FRONT_TARGETS = (30.0, 35.0)  # degrees under which single triangles are looked at
ANYWHERE = 4.0  # scaled: no distance from the surface is too large here, where vertices stay on it


def made_rounder(
    support: Support,
    points: np.ndarray,
    rows: NDArray[np.int64],
    curves: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]],
    near: NDArray[np.int64],
    wanted: np.ndarray,
    size: SizeField,
) -> tuple[np.ndarray, NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """The mesh after some rounds of flips and moves, and its curves.

    Parameters
    ----------
    points : (n, 3)
        Scaled.
    rows : (m, 3) int64
    curves : tuple
        Edges on curves, the curve of each, and the vertices that must not move.
    near : (n,) int64
        A triangle of the surface at each vertex.
    wanted : (n,)
        The largest length at each vertex, scaled.
    size : SizeField

    Returns
    -------
    points, rows : ndarray
    edges, chain : ndarray
        The edges on curves, and the curve of each.
    """
    edges, chain, corners = curves
    complex = SurfaceComplex(
        points,
        rows.astype(np.int32),
        edges.astype(np.int32),
        chain.astype(np.int32),
        corners.astype(np.int32),
    )
    s, master = complex.sheets, complex.master
    s.near[: len(master)], s.cap[: len(master)] = near[master], wanted[master]
    run = RemeshRun(support, complex, size, ANYWHERE / support.factor, len(s.at))
    for _ in range(FRONT_ROUNDS):
        run.flip(False)
        run.move()
    run.flip(False)
    for degrees in FRONT_TARGETS:
        run.sharpen(degrees)
    taken = complex.taken()
    triangles, edges, chain = (a.astype(np.int64) for a in (taken.triangles, taken.edges, taken.curves))
    return taken.points, triangles, edges, chain
