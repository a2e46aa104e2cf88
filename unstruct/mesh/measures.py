"""Measures of whole meshes: volumes of cells of any kind, and the statistics of `Mesh.summary`."""

from __future__ import annotations

from math import fsum

import numpy as np

from ..base.errors import MeshError
from ..geometry import simplex
from ..geometry.edge_vectors import exponents, quiet
from .cells import CELL_TYPES, equal_rows, simplex_dimension
from .complex import CellComplex
from .shapes import COMMON, cell_quality

__all__ = ["Summary", "cell_volumes", "summarize", "total"]


@quiet
def cell_volumes(mesh: CellComplex) -> np.ndarray:
    """Length, area or volume of each cell, in the order of ``mesh.cells``; signed where k = d.

    Cells of all kinds are scaled by powers of two, so that nothing overflows or underflows but results.
    """
    parts = []
    for name, block in mesh.cells.items():
        if simplex_dimension(name) is not None:
            parts.append(simplex.volume(mesh.points[block]) if len(block) else np.empty(0))
        elif name in ("quad", "polygon"):
            parts.append(_ring_areas(mesh, name))
        else:
            parts.append(_polyhedron_volumes(mesh.points[block], CELL_TYPES[name][3]))
    return np.concatenate(parts)


def total(volumes: np.ndarray) -> float:
    """The correctly rounded sum of lengths, areas or volumes; inf where it is too large."""
    try:
        return fsum(volumes)
    except (OverflowError, ValueError):  # of finite terms, of inf - inf
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.sum(volumes))


def _local(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (m, c, d) about the first one of each cell, scaled to at most 1, and the exponents of that."""
    half = np.ldexp(corners, -1)  # because differences of the largest doubles would overflow
    rows = half - half[:, :1]
    exponent = exponents(rows)
    return np.ldexp(rows, -exponent[:, None, None]), exponent + 1


def _ring_areas(mesh: CellComplex, kind: str) -> np.ndarray:
    """Signed areas in the plane (shoelace formula about the first corner), unsigned ones in space."""
    d = mesh.points.shape[1]
    areas = np.empty(len(mesh.cells[kind]))
    if d > 3 and len(areas):
        raise MeshError(f"polygons have areas in the plane and in space, not in {d} dimensions")
    for which, block in equal_rows(mesh.cells[kind]):
        rows, exponent = _local(mesh.points[block])
        a, b = rows[:, 1:-1], rows[:, 2:]
        if d == 2:
            found = (a[..., 0] * b[..., 1] - b[..., 0] * a[..., 1]).sum(axis=1)
        else:
            found = np.linalg.norm(np.cross(a, b).sum(axis=1), axis=1)
        areas[which] = np.ldexp(found / 2, 2 * exponent)
    return areas


def _polyhedron_volumes(corners: np.ndarray, facets: list[list[int]]) -> np.ndarray:
    """Signed volumes by the divergence theorem; a facet that is not plane is a fan around its mean corner."""
    if not len(corners):
        return np.empty(0)
    corners, exponent = _local(corners)
    result = np.zeros(len(corners))
    for facet in facets:
        ring = corners[:, facet]
        middle = ring.mean(axis=1)
        following = np.roll(ring, -1, axis=1)
        result += np.einsum("mi,mji->m", middle, np.cross(ring, following)) / 6
    return np.ldexp(result, 3 * exponent)


class Summary(dict):
    """A dictionary of statistics that prints as a short text."""

    def __str__(self) -> str:
        lines = [self["title"]]
        for name, value in self.items():
            if isinstance(value, dict):
                low, mean, high = (f"{value[key]:.4g}" for key in ("min", "mean", "max"))
                lines.append(f"  {name:<14} {low:>10} {mean:>10} {high:>10}   (min, mean, max)")
            elif name != "title":
                lines.append(f"  {name:<14} {f'{value:.6g}' if isinstance(value, float) else value!s:>10}")
        return "\n".join(lines)


def _statistics(values: np.ndarray) -> dict[str, float]:
    return {"min": float(values.min()), "mean": float(values.mean()), "max": float(values.max())}


def summarize(mesh: CellComplex) -> Summary:
    """Counts, Euler characteristic, volume, and statistics of edges and shapes.

    Returns
    -------
    Summary
        Keys ``title``, ``points``, ``used``, ``cells``, ``edges``, ``boundary``, ``euler``, ``volume``,
        ``degree``, ``edge_length`` and, for cells of dimension 2 and 3, names of qualities: for simplices
        some of `unstruct.simplex.QUALITIES`, for other kinds those that all kinds have. If there are several
        kinds, also the number of cells of each kind, by its name.
    """
    counts = mesh.face_counts()
    result = Summary(
        title=repr(mesh),
        points=len(mesh.points),
        used=counts[0],
        cells=mesh.size,
        **({kind: len(block) for kind, block in mesh.cells.items()} if len(mesh.cells) > 1 else {}),
        edges=len(mesh.edges),
        boundary=len(mesh.boundary),
        euler=mesh.euler_characteristic,
        volume=total(cell_volumes(mesh)),
    )
    if not mesh.size:
        return result
    result["degree"] = _statistics(np.bincount(mesh.edges.ravel())[np.unique(mesh.edges)])
    ends = mesh.points[mesh.edges]
    result["edge_length"] = _statistics(simplex.measure(ends))
    if mesh.is_simplicial and mesh.dimension >= 2:
        names = ["min_angle", "max_angle", "2r/R"]
        if mesh.dimension == 3:
            names += ["min_dihedral", "max_dihedral"]
        for name in names:
            result[name] = _statistics(simplex.quality(name, mesh.corners))
    elif mesh.dimension >= 2:
        for name in COMMON:
            result[name] = _statistics(cell_quality(mesh, name))
    return result
