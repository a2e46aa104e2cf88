"""The work ``intrinsic`` of the suite ``surface``: intrinsic Delaunay flips on bad meshes, beside libigl.

libigl's `intrinsic_delaunay_triangulation` gets lengths and triangles, and gives the same; its time has the
finding of the lengths in it. Ours gets points and triangles, checks them for flat ones, and keeps directions
as well, so that edges can be drawn; the seconds of the flips alone are in a column of their own.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher, several

__all__ = [
    "MADE",
    "MESHERS",
    "PLAN",
    "Surface",
    "measures",
    "needles",
    "sheared",
    "squashed",
    "task",
    "warm_up",
]

Surface = tuple[NDArray[np.float64], NDArray[np.int32]]


def _turned(n: int, m: int, place: Callable[[Any, Any], Any]) -> Surface:
    """A grid that is closed in the first direction; place takes u and v in [0, 1]."""
    u, v = np.meshgrid(np.arange(n) / n, np.arange(m + 1) / m, indexing="ij")
    points = np.stack(np.broadcast_arrays(*place(u.ravel(), v.ravel())), axis=1).astype(float)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b = i * (m + 1) + j, (i + 1) % n * (m + 1) + j
    rows = np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])
    return points, rows.astype(np.int32)


def squashed(count: int) -> Surface:
    """A band of an ellipsoid of the axes 1, .1 and .05."""
    n = round((count / 2) ** 0.5)

    def place(u: Any, v: Any) -> Any:
        turn, high = 2 * np.pi * u, np.pi * (0.02 + 0.96 * v)
        return np.cos(turn) * np.sin(high), 0.1 * np.sin(turn) * np.sin(high), -0.05 * np.cos(high)

    return _turned(n, n, place)


def needles(count: int) -> Surface:
    """A cylinder of needles that run up it askew, as of turned parts in CAD."""
    n = round((count * 2) ** 0.5)
    m = max(1, count // (2 * n))

    def place(u: Any, v: Any) -> Any:
        turn = 2 * np.pi * (u + 0.25 * v * m)
        return np.cos(turn), np.sin(turn), v * m * 200 * np.pi / n

    return _turned(n, m, place)


def sheared(count: int) -> Surface:
    """A torus whose grid is sheared so that nearly all edges are illegal, several times over."""
    n = round((count / 2) ** 0.5)

    def place(u: Any, v: Any) -> Any:
        turn, other = 2 * np.pi * (u + 8 * v), 2 * np.pi * 0.98 * v
        far = 1 + 0.4 * np.cos(other)
        return far * np.cos(turn), far * np.sin(turn), 0.4 * np.sin(other)

    return _turned(n, n, place)


MADE: dict[str, Callable[[int], Surface]] = {
    "squashed ellipsoid": squashed,
    "needles of a cylinder": needles,
    "sheared torus": sheared,
}
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "intrinsic": dict.fromkeys(MADE, (10_000, 100_000)) | {"sheared torus": (10_000, 100_000, 1_000_000)}
}


def task(work: str, kind: str, n: int) -> Surface:
    """A bad mesh of about n triangles."""
    return MADE[kind](n)


def warm_up(work: str) -> Surface:
    """A small one."""
    return squashed(200)


def _ours(given: Surface) -> Any:
    from unstruct import Mesh
    from unstruct.studies import IntrinsicTriangulation

    found = IntrinsicTriangulation(Mesh(*given))
    begin = time.process_time()
    flips = found.delaunay()
    return flips, time.process_time() - begin, found


def _libigl(given: Surface) -> Any:
    import igl

    points, triangles = given
    faces = triangles.astype(np.int64)
    lengths = igl.edge_lengths(points, faces)
    igl.intrinsic_delaunay_triangulation(lengths, faces)
    return 0, 0.0, None


MESHERS = [
    Mesher("unstruct", "unstruct", "intrinsic", several(_ours)),
    Mesher("libigl", "libigl", "intrinsic", several(_libigl)),
]


def measures(flips: int, seconds: float, found: Any, work: str, given: Surface) -> dict[str, Any]:
    """How many triangles; of our result also the flips, their share of the time, and edges left that fail."""
    result: dict[str, Any] = {"cells": len(given[1])}
    if found is not None:
        result |= {"flips": flips, "flip_seconds": seconds, "illegal": len(found.illegal())}
    return result
