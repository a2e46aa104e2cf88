"""Airfoil sections from coordinate files, in Selig's and in Lednicer's order, as splines or as polygons.

Selig's order leads from the trailing edge along the upper side to the nose and back along the lower side.
Lednicer's has the numbers of points of both sides, then each side from the nose to the trailing edge. The
first line is a name. Source: M. S. Selig, UIUC airfoil coordinates database.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import frozen
from ...base.errors import InputError
from ...base.files import text_of
from ...geometry.curves import Curve
from .splines import open_slopes

__all__ = ["read_section", "section_parts"]


def read_section(path: Path) -> tuple[np.ndarray, str]:
    """The points of a file in Selig's order, without repeated ones, and the name in its first line.

    Raises
    ------
    InputError
        For a file that is neither; the message names file and line.
    """
    name = ""
    rows: list[list[float]] = []
    for number, line in enumerate(text_of(path).splitlines(), 1):
        words = line.replace(",", " ").split()
        if not words:
            continue
        try:
            x = [float(word) for word in words[:2]]
        except ValueError:
            x = []
        if len(x) == 2 and len(words) == 2 and np.isfinite(x).all():
            rows.append(x)
        elif not rows:  # the name, perhaps of several lines
            name = name or line.strip()
        else:
            raise InputError(
                f"{path.name}, line {number}: {line.strip()[:40]!r} is no point 'x y' of an airfoil; "
                "coordinates begin after a first line with the name"
            )
    points = np.array(rows).reshape(-1, 2)
    if len(points) and (points[0] > 1.5).all() and (points[0] == np.round(points[0])).all():
        upper = int(points[0, 0])
        if points[0].sum() != len(points) - 1:
            raise InputError(
                f"{path.name} announces {points[0, 0]:.0f} + {points[0, 1]:.0f} points (Lednicer's order), "
                f"but has {len(points) - 1}"
            )
        points = np.concatenate([points[upper:0:-1], points[upper + 1 :]])
    kept = np.append(True, (points[1:] != points[:-1]).any(axis=1))[: len(points)]
    points = points[kept]
    if len(points) < 4:
        raise InputError(
            f"{path.name} has {len(points)} different points: a section needs four, one in each line 'x y'"
        )
    return points, name


def section_parts(points: np.ndarray, shape: str) -> dict[str, Any]:
    """The arguments of a `Domain` for a section in Selig's order.

    Parameters
    ----------
    points : ndarray, shape (k, 2)
        If the first equals the last, the trailing edge is a corner; otherwise a straight piece closes it.
    shape : str
        "spline": two curves, trailing edge to nose and back, parts of one cubic spline by chord length with
        no curvature at the trailing edge. "polygon": straight pieces between the points.

    Returns
    -------
    dict
        Markers are "upper", "lower", and "trailing edge" where that is open.
    """
    if shape not in ("spline", "polygon"):
        raise InputError(f"shape = {shape!r} must be 'spline' or 'polygon'")
    n = len(points)
    sharp = bool((points[0] == points[-1]).all())
    tail = (points[0] + points[-1]) / 2
    nose = int(np.argmax(((points - tail) ** 2).sum(axis=1)))
    if not 0 < nose < n - 1:
        raise InputError("the points of a section must lead from the trailing edge around the nose and back")
    x, y = points.T
    area = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum()
    first, second = ("upper", "lower") if area > 0 else ("lower", "upper")
    if shape == "spline":
        step = np.hypot(*np.diff(points, axis=0).T)
        knots = np.append(0.0, np.cumsum(step))
        spline = partial(_on_spline, frozen(knots), frozen(points.copy()), frozen(open_slopes(points, step)))
        curves = {0: Curve(spline, 0.0, knots[nose]), 1: Curve(spline, knots[nose], knots[-1])}
        ends = [points[0], points[nose]] + ([] if sharp else [points[-1]])
        facets = [[0, 1], [1, 0]] if sharp else [[0, 1], [1, 2], [2, 0]]
        sides: dict[str, list[int]] = {first: [0], second: [1]}
    else:
        ends = list(points[:-1] if sharp else points)
        facets = [[i, (i + 1) % len(ends)] for i in range(len(ends))]
        curves = {}
        sides = {first: list(range(nose)), second: list(range(nose, n - 1))}
    if not sharp:
        sides["trailing edge"] = [len(facets) - 1]
    return {"points": np.array(ends), "facets": facets, "curves": curves, "markers": sides}


def _on_spline(knots: np.ndarray, points: np.ndarray, slopes: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points of the spline; at the knots exactly the given ones."""
    i = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    step = (knots[i + 1] - knots[i])[..., None]
    u = np.asarray(t - knots[i])[..., None] / step
    v = 1 - u
    ends = points[i] * (v * v * (1 + 2 * u)) + points[i + 1] * (u * u * (1 + 2 * v))
    return ends + step * (slopes[i] * (u * v * v) - slopes[i + 1] * (u * u * v))
