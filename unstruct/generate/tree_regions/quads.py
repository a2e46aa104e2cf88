"""Meshes mostly of quadrilaterals: squares inside, convex quadrilaterals along the pieces of a domain.

See the book, chapter 4b.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...geometry.scaled_jacobian import ring_angles, unit_scaled
from ...mesh.domain_mesh import DomainMesh
from ..boundary.pairs import paired
from ..quads.pairing import pairs_of_triangles
from ..quads.recombine import on_pieces
from ..tree.cells import TreeCells
from .fitted import fitted
from .mixed_stars import smoothed

__all__ = ["quads"]

LISTED = 25.0  # degrees: cells with a smaller angle are listed, if they have a triangle that is


def quads(cells: TreeCells, domain: Domain) -> DomainMesh:
    """Mostly quadrilaterals, whose size is that of the leaves of a quadtree.

    Parameters
    ----------
    cells : TreeCells
        A quadtree over the domain; if it is not balanced across corners, it is balanced first.
    domain : Domain

    Returns
    -------
    DomainMesh
        ``mesh.cells`` has "triangle" and "quad". ``counts``: "quadrilaterals", "triangles" and "quad moves"
        beside those of `fitted`. ``figures``: "share of quadrilaterals", of the area; "minimum angle" and
        "maximum angle" of all cells, and those of `fitted`.

    Raises
    ------
    InputError
        As `fitted` does.

    Notes
    -----
    The triangles of `fitted` are paired across sides that are on no piece: squares of leaves first, then what
    is nearest to right angles, none with an angle beyond 39.6 and 140.4 degrees; exchanges along alternating
    paths make more pairs. Then vertices on no piece are moved to where the worst corner around them is
    better; also after that no angle of a quadrilateral is outside of 39 to 141 degrees. All quadrilaterals
    are convex, by exact signs: their Jacobians are positive everywhere.
    O(n log n).
    """
    mesh = fitted(cells, domain)
    triangles = np.asarray(mesh.simplices)
    single, quad, both = pairs_of_triangles(mesh.points, triangles, mesh.neighbors, on_pieces(mesh))
    padded = np.column_stack([triangles[single], np.full(len(single), -1, dtype=np.int32)])
    free = np.asarray(mesh.origin) < 0
    free[mesh.segments.ravel()] = False
    free[triangles[mesh.unrefined]] = False  # around these, others would become as poor
    points, moves = smoothed(mesh.points, np.concatenate([padded, quad]), free)
    blocks = {"triangle": triangles[single], "quad": quad}
    blocks = {name: rows for name, rows in blocks.items() if len(rows)}
    markers = dict(mesh.markers)
    markers["region"] = mesh.markers["region"][np.concatenate([single, both[:, 0]])]
    angles = _angles(points, blocks)
    unrefined, reasons = _listed(mesh, single, both, angles[:, 0])
    result = DomainMesh(
        points, None, cells=blocks, origin=mesh.origin, markers=markers, segments=mesh.segments,
        piece=mesh.piece, span=mesh.span, regions=mesh.regions, unrefined=unrefined, reasons=reasons,
        counts=mesh.counts | {"triangles": len(single), "quadrilaterals": len(quad), "quad moves": moves},
        figures=mesh.figures | {
            "share of quadrilaterals": _share(points, blocks),
            "minimum angle": float(angles[:, 0].min()),
            "maximum angle": float(angles[:, 1].max()),
        },
    )  # fmt: skip
    return paired(domain, result)


def _angles(points: NDArray[np.float64], blocks: dict[str, NDArray[np.int32]]) -> NDArray[np.float64]:
    """The least and the largest angle of each cell, in degrees: (m, 2); 0 and 180 if lost to rounding."""
    found = [np.degrees(ring_angles(unit_scaled(points[rows]))) for rows in blocks.values()]
    both = np.concatenate([np.column_stack([a.min(axis=1), a.max(axis=1)]) for a in found])
    return np.where(np.isnan(both), [0.0, 180.0], both)


def _share(points: NDArray[np.float64], blocks: dict[str, NDArray[np.int32]]) -> float:
    """The part of the area that quadrilaterals cover."""
    area = {}
    for name, rows in blocks.items():
        x = points[rows] - points[rows[:, :1]]
        following = np.roll(x, -1, axis=1)
        area[name] = float((x[..., 0] * following[..., 1] - x[..., 1] * following[..., 0]).sum())
    return area.get("quad", 0.0) / sum(area.values())


def _listed(
    mesh: DomainMesh, single: NDArray[np.int64], both: NDArray[np.int64], least: NDArray[np.float64]
) -> tuple[NDArray[np.int64], list[str]]:
    """The cells with a small angle that have a triangle of `fitted` with one, and the reasons."""
    owner = np.empty(mesh.size, dtype=np.int64)
    owner[single] = np.arange(len(single))
    owner[both] = len(single) + np.arange(len(both))[:, None]
    reason: dict[int, str] = {}
    for cell, why in zip(owner[mesh.unrefined].tolist(), mesh.reasons.tolist(), strict=True):
        if least[cell] < LISTED:
            reason.setdefault(cell, why)
    rows = sorted(reason)
    return np.array(rows, dtype=np.int64), [reason[cell] for cell in rows]
