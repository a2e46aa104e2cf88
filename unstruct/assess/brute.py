"""`unstruct.check` by brute force: all points against all cells, which relies on no theorem."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ..base.report import Problem, Report, problem
from ..mesh.mesh import Mesh
from ..predicates.batch import in_sphere, orient
from ..predicates.power import power_signs

__all__ = ["check_brute"]


def check_brute(mesh: Mesh, report: Report) -> None:
    """All points against all spheres and all hull facets, and the volume in rational numbers."""
    points, corners = mesh.points, mesh.corners
    if mesh.weights is None:
        inside = np.asarray(in_sphere(corners[:, None], points)) > 0
    else:
        m, n = mesh.size, len(points)
        every = np.repeat(mesh.simplices, n, axis=0), np.tile(np.arange(n), m)
        inside = power_signs(points, mesh.weights, *every).reshape(m, n) > 0
    cells, vertices = np.nonzero(inside)
    report.note(
        "brute force: no vertex in any sphere",
        problem("not Delaunay", "spheres that contain vertices (all pairs)", cells, vertices),
    )
    beyond = _beyond(points, mesh.boundary)
    report.note(
        "brute force: no vertex beyond a boundary facet",
        problem("concave boundary", "vertices beyond boundary facets", vertices=np.nonzero(beyond)[0]),
    )
    if points.shape[1] > 1:  # in one dimension facets are points, without orientation
        total, hull = _exact_volume(points, mesh.simplices), _exact_volume(points, mesh.boundary)
        wrong = None if total == hull else Problem("volume", f"cells {float(total)}, hull {float(hull)}")
        report.note("brute force: the cells and the hull have equal volumes (rational numbers)", wrong)


def _beyond(points: np.ndarray, boundary: np.ndarray) -> np.ndarray:
    """Which points lie strictly outside some boundary facet; orient(q, facet) is positive for q inside."""
    n, d = points.shape
    if d == 1:
        ends = points[boundary[:, 0], 0]
        return (points[:, 0] < ends.min()) | (points[:, 0] > ends.max())
    facets = np.broadcast_to(points[boundary][:, None], (len(boundary), n, d, d))
    everyone = np.broadcast_to(points[None, :, None], (len(boundary), n, 1, d))
    signs = np.asarray(orient(np.concatenate([everyone, facets], axis=2)))
    return np.any(signs < 0, axis=0)


def _exact_volume(points: np.ndarray, rows: np.ndarray) -> Fraction:
    """d! times the sum of the volumes of simplices, or of cones from the origin over facets."""
    d = points.shape[1]
    total = Fraction(0)
    for row in rows.tolist():
        corners = [[Fraction(x) for x in points[v].tolist()] for v in row]
        base = [Fraction(0)] * d if len(row) == d else corners.pop(0)
        total += _determinant([[x - y for x, y in zip(corner, base)] for corner in corners])
    return total


def _determinant(rows: list[list[Fraction]]) -> Fraction:
    """The determinant, by elimination."""
    rows, result = [row[:] for row in rows], Fraction(1)
    for i in range(len(rows)):
        pivot = next((r for r in range(i, len(rows)) if rows[r][i] != 0), None)
        if pivot is None:
            return Fraction(0)
        if pivot != i:
            rows[i], rows[pivot], result = rows[pivot], rows[i], -result
        result *= rows[i][i]
        for r in range(i + 1, len(rows)):
            factor = rows[r][i] / rows[i][i]
            rows[r] = [x - factor * y for x, y in zip(rows[r], rows[i])]
    return result
