"""The suite ``prisms``: thirty prismatic layers on closed surfaces beside Gmsh's extrudeBoundaryLayer.

*Layers.* Bodies of about a hundred thousand triangles; the last layer is about as high as an edge. Our time
includes limits of heights and the search for collisions; the domain is made before, and one more contestant
makes it, with all of its checks. Gmsh neither checks nor limits. Cells that are not positive everywhere are
counted exactly, for both, by `unstruct.geometry.jacobians.wedge_signs`.

*Growth.* A thousand to a million wedges on a ball.

*Joined.* The wing-body in a box: layers on it and tetrahedra beyond, one valid mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .meshers import find
from .prism_meshers import MESHERS, Given
from .run import Workers, measured
from .volume_quality import dihedral

COUNT, RATIO = 30, 1.15
LAST = 60.0  # the first height is an edge by this number, so that the last is about an edge
LAST_JOINED = 200.0  # ... about a third of it, so that the last wedges are as large as tetrahedra beyond
TRIANGLES = 100_000
FEW_TRIANGLES = 400
BODIES = ("sphere", "torus", "noisy ball", "notch", "wing-body", "merged body")
# work -> kind -> numbers of triangles; for "growth" of wedges
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "layers": dict.fromkeys(BODIES, (TRIANGLES,)),
    "growth": {"sphere": (1_000, 10_000, 100_000, 1_000_000)},
    "joined": {"wing-body": (5_000,)},
}
# n triangles have about the edge length sqrt(this / n)
SPREAD = {
    "sphere": 29.0, "torus": 36.5, "noisy ball": 43.6, "notch": 59.9, "wing-body": 18.3, "merged body": 26.0,
}  # fmt: skip
FAR_BOX = 3.0
BEYOND_GROWTH, BEYOND_FAR = 0.35, 0.6
__all__ = ["MESHERS", "PLAN", "body", "measures", "run", "task", "warm_up"]


def body(kind: str, h: float) -> Any:
    """A body with triangles of about this edge length."""
    from unstruct import Domain, examples

    made: dict[str, Callable[[], Any]] = {
        "sphere": lambda: Domain.ball(size=h),
        "torus": lambda: Domain.torus(size=h),
        "noisy ball": lambda: examples.level_surface(examples.noisy_ball(1), h),
        "notch": lambda: examples.meshed_sides(examples.notched_box(), h),
        "wing-body": lambda: examples.wing_body(h),
        "merged body": lambda: examples.level_surface(examples.merged_body(0), h),
    }
    return made[kind]()


def task(work: str, kind: str, n: int) -> Given:
    """A body of about n triangles (of "growth": n wedges), and its layers."""
    from unstruct import Domain, Layers, sizing

    h = float(np.sqrt(SPREAD[kind] * (COUNT if work == "growth" else 1) / n))
    h = min(h, 0.15) if kind == "wing-body" else h
    domain = body(kind, h)
    layers = Layers(first=h / (LAST_JOINED if work == "joined" else LAST), growth=RATIO, count=COUNT)
    heights = layers.cumulative().ravel()[1:].tolist()
    if work != "joined":
        return Given(domain, layers, heights)
    air = Domain.box((-FAR_BOX,) * 3, (FAR_BOX,) * 3)
    far = _sides(air)
    outside = far.with_holes(domain)
    size = sizing.points(domain.points, spacing(domain), growth=BEYOND_GROWTH, far=1.4 * BEYOND_FAR)
    return Given(outside, layers, heights, list(domain.markers), size)


def spacing(domain: Any) -> NDArray:
    """The mean length of the edges at each point of a surface."""
    rows = np.asarray(domain.facets)
    x = domain.points[rows]
    length = np.sqrt(((x - np.roll(x, -1, axis=1)) ** 2).sum(axis=2))
    total = np.bincount(rows.ravel(), (length + np.roll(length, 1, axis=1)).ravel() / 2)
    return total / np.bincount(rows.ravel())


def _sides(box: Any) -> Any:
    """A box with even triangles."""
    from unstruct import examples

    return examples.meshed_sides(box, BEYOND_FAR)


def warm_up(work: str) -> Given:
    """A small task of the same kind: compiled code is loaded, lazy imports are done."""
    if work == "joined":
        return task(work, "wing-body", FEW_TRIANGLES)
    return task("layers", "merged body", FEW_TRIANGLES)


def measures(
    points: NDArray, cells: dict[str, NDArray], mesh: Any, work: str, given: Given
) -> dict[str, Any]:
    """How many wedges there are, how many of them are not positive everywhere, and what ours reports."""
    from unstruct.geometry.jacobians import wedge_signs

    wedges = cells["wedge"]
    signs = wedge_signs(points[wedges])
    found: dict[str, Any] = {
        "cells": int(sum(map(len, cells.values()))),
        "wedges": len(wedges),
        "triangles": len(given.domain.triangulated.triangles),
        "bad": int((signs != 1).sum()),
    }
    if "tetra" in cells:
        angle = dihedral(points[cells["tetra"]])
        found |= {"min_dihedral": float(angle.min()), "below_12": int((angle.min(axis=1) < 12.0).sum())}
    if mesh is None:
        return found
    found |= {f"figure: {name}": float(value) for name, value in mesh.figures.items()}
    found |= {f"count: {name}": int(value) for name, value in mesh.counts.items()}
    if work == "joined":
        from unstruct import check

        report = check(mesh, domain=given.domain)
        found |= {"valid": bool(report), "problems": [problem.kind for problem in report.problems]}
    return found


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles, or wedges."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, sizes in kinds.items():
            for n in sizes:
                if n <= largest:
                    case = {"suite": "prisms", "work": work, "kind": kind, "n": n}
                    expected = {mesher.name: 0.0 for mesher, _ in find(work, MESHERS)}
                    names = list(expected)
                    found = measured(workers, "meshed", case, expected, repeats)
                    if not found:  # one of them may have crashed: each by itself
                        for name in names:
                            found += measured(workers, "meshed", case, {name: 0.0}, repeats)
                    rows += found
    return rows
