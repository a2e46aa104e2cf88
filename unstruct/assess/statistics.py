"""How good a planar mesh is, in one row: angles, roundness, and how well its edges have the wanted length.

See the book, chapters 2.6b to 2.6d.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..base.arrays import distinct
from ..base.errors import InputError, MeshError
from ..geometry.simplex import angles, quality
from ..mesh.mesh import Mesh
from ..sizing.field import as_size

__all__ = ["Statistics", "angle_histogram", "compare", "statistics"]

NAMES = {
    "vertices": "vertices",
    "cells": "triangles",
    "least_angle": "least angle",
    "low_angle": "1 % of the least angles below",
    "greatest_angle": "greatest angle",
    "least_round": "least 2r/R",
    "mean_round": "mean 2r/R",
    "conforming": "edges within √2 of the size",
    "short": "shortest edge / size",
    "long": "longest edge / size",
    "median": "median edge / size",
}
DEGREES = ("least_angle", "low_angle", "greatest_angle")


@dataclass(frozen=True)
class Statistics:
    """Figures of a triangle mesh, as `statistics` makes them.

    Attributes
    ----------
    vertices, cells : int
        How many vertices are used, and how many triangles there are.
    least_angle, low_angle, greatest_angle : float
        Degrees: the least of all angles; the value that the least angles of one triangle in a hundred do not
        exceed; the greatest of all angles.
    least_round, mean_round : float
        2 r / R over the triangles: inradius over circumradius, 1 for equilateral ones.
    conforming : float
        The share of edges whose length is within a factor sqrt(2) of the size at their midpoint; NaN without
        a size, as are the next three.
    short, long, median : float
        The least, greatest and median quotient of length and size.
    """

    vertices: int
    cells: int
    least_angle: float
    low_angle: float
    greatest_angle: float
    least_round: float
    mean_round: float
    conforming: float
    short: float
    long: float
    median: float

    def rows(self) -> list[tuple[str, str]]:
        """(name, value) in words, what is not known left out."""
        found = []
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, int):
                found.append((NAMES[each.name], str(value)))
            elif not np.isnan(value):
                digits = f"{value:.1f}°" if each.name in DEGREES else f"{value:.3f}"
                found.append((NAMES[each.name], f"{value:.1%}" if each.name == "conforming" else digits))
        return found

    def __str__(self) -> str:
        width = max(len(name) for name, _ in self.rows())
        return "\n".join(f"{name:<{width}}  {value:>8}" for name, value in self.rows())

    __repr__ = __str__


def _triangles(mesh: Mesh) -> np.ndarray:
    if not isinstance(mesh, Mesh) or not mesh.is_simplicial or mesh.dimension != 2 or mesh.size == 0:
        raise MeshError(f"these statistics are for triangle meshes; this is {mesh!r}")
    return mesh.corners


def statistics(mesh: Mesh, size: Any = None) -> Statistics:
    """Angles, roundness and size conformity of a triangle mesh.

    Parameters
    ----------
    mesh : Mesh
        Triangles, in the plane or on a surface.
    size : float, callable or SizeField, optional
        The wanted edge length; it is compared with the lengths of the edges at their midpoints.

    Returns
    -------
    Statistics

    Raises
    ------
    MeshError
        For meshes of other cells, and for empty ones.

    Notes
    -----
    O(m). An edge counts once, however many triangles it has. Book: 2.6b.
    """
    corners = _triangles(mesh)
    least = quality("min_angle", corners)
    rounds = quality("2r/R", corners)
    quotients = np.full(1, np.nan)
    if size is not None:
        ends = mesh.points[mesh.edges]
        quotients = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / as_size(size)(ends.mean(axis=1))
    close = np.abs(np.log2(quotients)) <= 0.5
    return Statistics(
        vertices=len(distinct(mesh.simplices)),
        cells=mesh.size,
        least_angle=float(least.min()),
        low_angle=float(np.quantile(least, 0.01)),
        greatest_angle=float(quality("max_angle", corners).max()),
        least_round=float(rounds.min()),
        mean_round=float(rounds.mean()),
        conforming=float(close.mean()) if size is not None else float("nan"),
        short=float(quotients.min()),
        long=float(quotients.max()),
        median=float(np.median(quotients)),
    )


def angle_histogram(mesh: Mesh, bins: int = 36) -> tuple[np.ndarray, np.ndarray]:
    """All angles of a triangle mesh, counted.

    Parameters
    ----------
    mesh : Mesh
        Triangles.
    bins : int
        Equal intervals of 0 to 180 degrees.

    Returns
    -------
    counts : ndarray of int, shape (bins,)
        They sum to three times the number of triangles.
    edges : ndarray, shape (bins + 1,)
        The limits of the intervals, in degrees.
    """
    return np.histogram(np.degrees(angles(_triangles(mesh))), bins=bins, range=(0.0, 180.0))


def compare(meshes: Mapping[str, Mesh], size: Any = None) -> str:
    """The statistics of several meshes side by side, as a Markdown table.

    Parameters
    ----------
    meshes : mapping of str to Mesh
        Triangle meshes by the names of their columns.
    size : float, callable or SizeField, optional
        As for `statistics`.

    Returns
    -------
    str
        One line a figure, one column a mesh.
    """
    if not isinstance(meshes, Mapping):
        raise InputError(f"meshes must be a dict of names to meshes, not {type(meshes).__name__}")
    columns = {name: dict(statistics(mesh, size).rows()) for name, mesh in meshes.items()}
    lines = ["| | " + " | ".join(columns) + " |", "|---" + "|---:" * len(columns) + "|"]
    for row in next(iter(columns.values()), {}):
        lines.append(f"| {row} | " + " | ".join(column[row] for column in columns.values()) + " |")
    return "\n".join(lines)
