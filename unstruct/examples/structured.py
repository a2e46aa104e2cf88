"""Structured grids, for comparison: graded rectangular grids, and grids mapped between two curves.

In a structured grid the neighbors follow from the indices, which is its advantage, and every line runs from
side to side, which is its disadvantage. See the book, chapter 1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import as_points
from ..base.errors import InputError
from ..mesh.mesh import Mesh

__all__ = ["graded_line", "ring_grid", "tensor_grid"]


def graded_line(low: float, high: float, spacing: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Points on an interval, with steps that nowhere exceed a wanted spacing (to first order).

    Parameters
    ----------
    low, high : float
    spacing : function (k,) -> (k,)
        The wanted step at each place; positive.

    Returns
    -------
    ndarray, shape (n,)
        Increasing numbers from ``low`` to ``high``, at equal steps of the integral of dx / spacing.
    """
    x = np.linspace(low, high, 4097)
    middle = (x[1:] + x[:-1]) / 2
    wanted = np.asarray(spacing(middle), dtype=float)
    if not (high > low and (wanted > 0).all()):
        raise InputError(
            f"the interval [{low}, {high}] must have a positive length, and spacing must be positive on it"
        )
    length = np.concatenate([[0.0], np.cumsum(np.diff(x) / wanted)])
    n = int(np.ceil(length[-1])) + 1
    return np.interp(np.linspace(0.0, length[-1], n), length, x)


def tensor_grid(x: ArrayLike, y: ArrayLike) -> Mesh:
    """The quadrilaterals between vertical lines at ``x`` and horizontal ones at ``y``.

    Parameters
    ----------
    x, y : array_like, shapes (nx,), (ny,)
        Increasing numbers, at least two each.

    Returns
    -------
    Mesh
        Vertex i * ny + j is the point (x[i], y[j]).
    """
    x, y = (np.asarray(line, dtype=float) for line in (x, y))
    for name, line in (("x", x), ("y", y)):
        if line.ndim != 1 or len(line) < 2 or not (np.diff(line) > 0).all():
            raise InputError(f"{name} must be a one-dimensional array of at least two increasing numbers")
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return Mesh(points, cells={"quad": _quads(len(x), len(y), closed=False)})


def ring_grid(inner: ArrayLike, outer: ArrayLike, fractions: ArrayLike) -> Mesh:
    """The quadrilaterals of a grid that is mapped between two closed curves (an O-grid).

    Parameters
    ----------
    inner, outer : array_like, shape (n, 2)
        Corresponding points on the two curves, both counterclockwise.
    fractions : array_like, shape (k,)
        The places of the rings on the straight lines between corresponding points, increasing from 0 (inner
        curve) to 1 (outer curve).

    Returns
    -------
    Mesh
        Vertex i * k + j lies on line i and ring j. The cells may fold over; `check` finds this.
    """
    inner, outer = as_points(inner, "inner"), as_points(outer, "outer")
    s = np.asarray(fractions, dtype=float)
    if inner.shape != outer.shape or inner.shape[1] != 2 or len(inner) < 3:
        raise InputError(
            f"inner and outer must both have shape (n, 2) with n >= 3, not {inner.shape} and {outer.shape}"
        )
    if s.ndim != 1 or len(s) < 2 or s[0] != 0 or s[-1] != 1 or not (np.diff(s) > 0).all():
        raise InputError("fractions must be a one-dimensional array that increases from 0 to 1")
    points = inner[:, None] + (outer - inner)[:, None] * s[:, None]
    points[:, -1] = outer
    return Mesh(
        points.reshape(-1, 2), cells={"quad": _quads(len(inner), len(s), closed=True)[:, [0, 3, 2, 1]]}
    )


def _quads(n: int, k: int, *, closed: bool) -> np.ndarray:
    i, j = np.meshgrid(np.arange(n if closed else n - 1), np.arange(k - 1), indexing="ij")
    after = (i + 1) % n
    corners = (i * k + j, after * k + j, after * k + j + 1, i * k + j + 1)
    return np.stack(corners, axis=-1).reshape(-1, 4)
