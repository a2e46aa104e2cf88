"""Minimum angles and edge lengths beside Gmsh on small hard outlines: ``python -m benchmarks.corners``."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .meshers import Meshed
from .regions import OUTLINES, Outline, in_gap, random_outlines

RANDOM = 25
QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))


def ours(outline: Outline) -> Meshed:
    """The mesh of `voronoi_segment`."""
    from unstruct import Arc, Domain, voronoi_segment

    points: list[Any] = []
    facets: list[tuple[int, int]] = []
    curves: dict[int, Any] = {}
    for ring in outline.polygons:
        facets += [(len(points) + k, len(points) + (k + 1) % len(ring)) for k in range(len(ring))]
        points += ring
    for x, y, r in outline.discs:
        for k in range(4):
            curves[len(facets)] = Arc((x, y), r, k * np.pi / 2, np.pi / 2)
            facets.append((len(points) + k, len(points) + (k + 1) % 4))
        points += [(x + r * u, y + r * v) for u, v in QUARTERS]
    mesh = voronoi_segment(Domain(points, facets, curves=curves), outline.edge)
    return mesh.points, mesh.simplices


def gmsh(outline: Outline, algorithm: int = 6) -> Meshed:
    """The mesh of Gmsh's frontal method."""
    import gmsh as peer

    if not peer.isInitialized():
        peer.initialize(interruptible=False)
        peer.option.setNumber("General.Terminal", 0)
    peer.clear()
    geo, loops = peer.model.geo, []
    for ring in outline.polygons:
        at = [geo.addPoint(x, y, 0) for x, y in ring]
        loops.append(geo.addCurveLoop([geo.addLine(at[k], at[(k + 1) % len(at)]) for k in range(len(at))]))
    for x, y, r in outline.discs:
        center = geo.addPoint(x, y, 0)
        at = [geo.addPoint(x + r * u, y + r * v, 0) for u, v in QUARTERS]
        loops.append(geo.addCurveLoop([geo.addCircleArc(at[k], center, at[(k + 1) % 4]) for k in range(4)]))
    geo.addPlaneSurface(loops)
    geo.synchronize()
    for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        peer.option.setNumber(f"Mesh.MeshSize{name}", 0)
    number = peer.model.mesh.field.add("MathEval")
    peer.model.mesh.field.setString(number, "F", f"{outline.edge:.12f}")
    peer.model.mesh.field.setAsBackgroundMesh(number)
    peer.option.setNumber("Mesh.Algorithm", algorithm)
    peer.model.mesh.generate(2)
    tags, coordinates, _ = peer.model.mesh.getNodes()
    (cells,) = peer.model.mesh.getElements(2)[2]
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags] = np.arange(len(tags))
    return coordinates.reshape(-1, 3)[:, :2].copy(), place[cells].reshape(-1, 3)


def figures(points: NDArray, triangles: NDArray, outline: Outline) -> dict[str, float]:
    """The number of cells, the minimum angle, and the part of the edges within sqrt(2) of the wanted length.

    With two holes "in the gap" is that part among the edges between them.
    """
    corners = points[triangles]
    a, b, c = (np.linalg.norm(corners[:, (k + 1) % 3] - corners[:, (k + 2) % 3], axis=1) for k in range(3))
    cosine = np.stack([(b * b + c * c - a * a) / (2 * b * c), (c * c + a * a - b * b) / (2 * c * a),
                       (a * a + b * b - c * c) / (2 * a * b)])  # fmt: skip
    ends = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    good = np.abs(np.log2(length / outline.edge)) <= 0.5
    found = {
        "cells": float(len(triangles)),
        "minimum angle": float(np.degrees(np.arccos(np.clip(cosine.max(), -1.0, 1.0)))),
        "conforming": float(good.mean()),
    }
    if len(outline.polygons) == 1 and len(outline.discs) == 2:
        found["in the gap"] = float(good[in_gap(points[ends].mean(axis=1))].mean())
    return found


def main() -> None:
    """Print the figures of both, outline by outline, and how they differ on random outlines."""
    for name, outline in OUTLINES.items():
        for who, mesher in (("unstruct", ours), ("Gmsh 6", gmsh)):
            row = figures(*mesher(outline), outline)
            print(f"{name:12} {who:9}", "  ".join(f"{key} {value:.4g}" for key, value in row.items()))
    print(f"\n{RANDOM} random outlines of each kind: ours minus Gmsh 6, least, 10 %, median, 90 %, largest")
    for kind, outlines in random_outlines(RANDOM).items():
        pairs = [(figures(*ours(each), each), figures(*gmsh(each), each)) for each in outlines]
        for key in pairs[0][0]:
            gains = np.array([one[key] - other[key] for one, other in pairs])
            print(f"{kind:12} {key:14}", *(f"{x:9.3f}" for x in np.quantile(gains, [0, 0.1, 0.5, 0.9, 1])))


if __name__ == "__main__":
    main()
