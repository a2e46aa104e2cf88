"""How good a mesh is, in a few figures: angles, roundness, and how well its edges have the wanted length.

See the book, chapters 2.6b to 2.6d.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from ..base.errors import InputError, MeshError
from ..geometry.edge_vectors import LEAST_LENGTH, exponents, lengths
from ..geometry.simplex import angles, dihedral_angles
from ..geometry.triangle_shapes import planar_angles, planar_edges
from ..mesh.cells import cell_rows, counted
from ..mesh.mesh import Mesh
from ..sizing.field import SizeField, as_size
from ..sizing.metric import Metric

__all__ = ["Statistics", "angle_histogram", "compare", "metric_quality", "statistics"]

NAMES = {
    "vertices": "vertices",
    "cells": "triangles",
    "min_angle": "minimum angle",
    "low_angle": "1 % of the minimum angles below",
    "max_angle": "maximum angle",
    "min_dihedral": "minimum dihedral angle",
    "low_dihedral": "1 % of the minimum dihedral angles below",
    "max_dihedral": "maximum dihedral angle",
    "least_round": "minimum 2r/R",
    "mean_round": "mean 2r/R",
    "least_scaled": "minimum scaled Jacobian",
    "mean_scaled": "mean scaled Jacobian",
    "conforming": "edges within √2 of the size",
    "short": "shortest edge / size",
    "long": "longest edge / size",
    "median": "median edge / size",
    "least_metric": "minimum metric quality",
    "mean_metric": "mean metric quality",
}
DEGREES = ("min_angle", "low_angle", "max_angle", "min_dihedral", "low_dihedral", "max_dihedral")


@dataclass(frozen=True)
class Statistics:
    """Figures of a mesh, as `statistics` returns them.

    Attributes
    ----------
    vertices, cells : int
        How many vertices are used, and how many cells there are.
    min_angle, low_angle, max_angle : float
        In degrees: the smallest of all angles; the value that the minimum angles of one cell in a hundred do
        not exceed; the largest of all angles. For solids, these are the angles of all faces.
    least_round, mean_round : float
        2 r / R of triangles, 3 r / R of tetrahedra: inradius over circumradius, scaled to 1 for regular
        cells; NaN if the mesh has other cells.
    conforming : float
        The share of edges whose length is within a factor sqrt(2) of the size at their midpoint. This and
        the next three are NaN without a size.
    short, long, median : float
        The smallest, largest and median quotient of length and size.
    least_scaled, mean_scaled : float
        The scaled Jacobian (`Mesh.quality`), 1 for ideal cells; NaN for meshes of triangles alone.
    kinds : dict of str to int
        How many cells of each kind there are.
    least_metric, mean_metric : float
        The metric quality of triangles, `metric_quality`; NaN if the size is no metric, and for other cells.
    min_dihedral, low_dihedral, max_dihedral : float
        Of tetrahedra, in degrees: the smallest of all angles between faces; the value that the smallest such
        angles of one cell in a hundred do not exceed; the largest. NaN if the mesh has other cells.
    """

    vertices: int
    cells: int
    min_angle: float
    low_angle: float
    max_angle: float
    least_round: float
    mean_round: float
    conforming: float
    short: float
    long: float
    median: float
    least_scaled: float = float("nan")
    mean_scaled: float = float("nan")
    kinds: dict[str, int] = field(default_factory=dict)
    least_metric: float = float("nan")
    mean_metric: float = float("nan")
    min_dihedral: float = float("nan")
    low_dihedral: float = float("nan")
    max_dihedral: float = float("nan")

    @property
    def least_angle(self) -> float:
        """The earlier name of ``min_angle``."""
        return self.min_angle

    @property
    def greatest_angle(self) -> float:
        """The earlier name of ``max_angle``."""
        return self.max_angle

    def rows(self) -> list[tuple[str, str]]:
        """The figures that are known, as pairs (name, value) of text."""
        found = []
        for each in fields(self):
            value = getattr(self, each.name)
            if each.name == "cells" and self.kinds:
                found += [(counted(2, kind)[2:], str(count)) for kind, count in self.kinds.items()]
            elif isinstance(value, dict):
                continue
            elif isinstance(value, int):
                found.append((NAMES[each.name], str(value)))
            elif not np.isnan(value):
                digits = f"{value:.1f}°" if each.name in DEGREES else f"{value:.3f}"
                name = NAMES[each.name]
                if list(self.kinds) == ["tetra"]:
                    name = name.replace("2r/R", "3r/R")
                found.append((name, f"{value:.1%}" if each.name == "conforming" else digits))
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
    """Angles, roundness and size conformity of a mesh.

    Parameters
    ----------
    mesh : Mesh
        Cells of any kinds, of dimension 2 or more: in the plane, on a surface, in space.
    size : float, callable, SizeField or Metric, optional
        The wanted edge length; it is compared with the lengths of the edges at their midpoints. A metric is
        compared in the direction of each edge, which gives the edge's length in the metric.

    Returns
    -------
    Statistics
        Roundness is reported for simplices, the scaled Jacobian for all meshes but those of triangles alone.

    Raises
    ------
    MeshError
        For meshes of segments, and for empty ones.

    Notes
    -----
    O(m). An edge counts once, however many cells it has. Book: 2.6b.
    """
    if not isinstance(mesh, Mesh) or mesh.dimension < 2 or mesh.size == 0:
        raise MeshError(
            f"these statistics are for meshes of triangles or cells with more corners; this is {mesh!r}"
        )
    smallest, largest = _extreme_angles(mesh)
    nothing = np.full(1, np.nan)
    rounds = mesh.quality("2r/R") if mesh.is_simplicial else nothing
    scaled = nothing if list(mesh.cells) == ["triangle"] else mesh.quality("scaled_jacobian")
    quotients = nothing
    fair = nothing
    if isinstance(size, Metric):
        quotients = size.length(*_edges_in_plane(mesh))
        fair = metric_quality(mesh, size) if list(mesh.cells) == ["triangle"] else nothing
    elif size is not None:
        quotients = _quotients(mesh, as_size(size))
    with np.errstate(divide="ignore"):
        close = np.abs(np.log2(quotients)) <= 0.5
    dihedral = np.full((1, 1), np.nan)
    if list(mesh.cells) == ["tetra"]:
        dihedral = np.degrees(dihedral_angles(mesh.corners))
    used = np.zeros(len(mesh.points), dtype=bool)
    used[cell_rows(mesh.cells)[1]] = True
    return Statistics(
        vertices=int(np.count_nonzero(used)),
        cells=mesh.size,
        min_angle=float(smallest.min()),
        low_angle=float(np.quantile(smallest, 0.01)),
        max_angle=float(largest.max()),
        least_round=float(rounds.min()),
        mean_round=float(rounds.mean()),
        conforming=float(close.mean()) if size is not None else float("nan"),
        short=float(quotients.min()),
        long=float(quotients.max()),
        median=float(np.median(quotients)),
        least_scaled=float(scaled.min()),
        mean_scaled=float(scaled.mean()),
        kinds={kind: len(block) for kind, block in mesh.cells.items()},
        least_metric=float(fair.min()),
        mean_metric=float(fair.mean()),
        min_dihedral=float(dihedral.min()),
        low_dihedral=float(np.quantile(dihedral.min(axis=1), 0.01)),
        max_dihedral=float(dihedral.max()),
    )


def metric_quality(mesh: Mesh, metric: Metric) -> np.ndarray:
    """The quality of triangles in a metric: 1 for those that are equilateral in it.

    Parameters
    ----------
    mesh : Mesh
        Triangles in the plane.
    metric : Metric

    Returns
    -------
    ndarray, shape (m,)
        4 sqrt(3) area / (a^2 + b^2 + c^2), with the area and the edges in the metric at the centroid.
    """
    corners = _triangles(mesh)
    edges = np.roll(corners, -1, axis=1) - corners
    if corners.shape[2] != 2:
        raise MeshError(f"a metric is of the plane; this is {mesh!r}")
    m = metric.at(corners.mean(axis=1))
    # the quality depends neither on the unit of the edges nor on that of the metric
    edges, m = (np.ldexp(rows, -exponents(rows)[:, None, None]) for rows in (edges, m))
    squares = np.einsum("tij,tjk,tik->t", edges, m, edges)
    double = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    scale = np.sqrt(np.maximum(m[:, 0, 0] * m[:, 1, 1] - m[:, 0, 1] ** 2, 0.0))
    return 2.0 * np.sqrt(3.0) * np.abs(double) * scale / squares


def _edges_in_plane(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """The midpoints of all edges, and the vectors along them."""
    ends = mesh.points[mesh.edges]
    if ends.shape[2] != 2:
        raise MeshError(f"a metric is of the plane; this is {mesh!r}")
    return ends.mean(axis=1), ends[:, 1] - ends[:, 0]


def _extreme_angles(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """The smallest and the largest angle of each cell; for triangles in the plane in one pass."""
    both = planar_angles(mesh.points, mesh.simplices) if list(mesh.cells) == ["triangle"] else None
    return both or (mesh.quality("min_angle"), mesh.quality("max_angle"))


def _quotients(mesh: Mesh, size: SizeField) -> np.ndarray:
    """The length of each edge over the wanted one at its midpoint.

    The neighbors of triangles, where they are known already, say which sides are the same edge; sorting all
    sides takes as long as all the rest.
    """
    found = None
    if list(mesh.cells) == ["triangle"] and "neighbors" in mesh.__dict__ and "edges" not in mesh.__dict__:
        found = planar_edges(mesh.points, mesh.simplices, mesh.neighbors)
        if found is not None and not (LEAST_LENGTH <= found[0].min() and found[0].max() < np.inf):
            found = None  # squares of such lengths are beyond the doubles
    if found is None:
        half = np.ldexp(mesh.points[mesh.edges], -1)  # because sums of the largest doubles would overflow
        found = 2.0 * lengths(half[:, 0] - half[:, 1]), half[:, 0] + half[:, 1]
    distance, middles = found
    wanted = size(middles) if size.constant is None else size.constant
    with np.errstate(over="ignore", under="ignore"):  # a length over a size may be beyond all doubles
        return distance / wanted


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
        Meshes by the names of their columns.
    size : float, callable, SizeField or Metric, optional
        As for `statistics`.

    Returns
    -------
    str
        One line for each figure that some mesh has, and one column for each mesh.
    """
    if not isinstance(meshes, Mapping):
        raise InputError(f"meshes must be a dict of names to meshes, not {type(meshes).__name__}")
    columns = {name: dict(statistics(mesh, size).rows()) for name, mesh in meshes.items()}
    lines = ["| | " + " | ".join(columns) + " |", "|---" + "|---:" * len(columns) + "|"]
    for row in _merged([list(column) for column in columns.values()]):
        lines.append(f"| {row} | " + " | ".join(column.get(row, "") for column in columns.values()) + " |")
    return "\n".join(lines)


def _merged(lists: list[list[str]]) -> list[str]:
    """All names once, each placed after the name that it follows in the first list that contains it."""
    result: list[str] = []
    for names in lists:
        place = 0
        for name in names:
            if name not in result:
                result.insert(place, name)
            place = result.index(name) + 1
    return result
