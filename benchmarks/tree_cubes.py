"""Hexahedra from octrees of bodies: the work "hexahedra" of the suite ``tree``.

A body has a surface of even triangles, about as long as the leaves of the tree. It is filled with leaves as
hexahedra, and with pyramids and tetrahedra up to the given surface ("hex-dominant"). Beside this are the
inner leaves alone, whose boundary has steps ("inner leaves"). The tree has been made before. Shares are parts
of the volume of the body; the sign of each Jacobian is exact, and holds for the whole cell.
"""

from __future__ import annotations

from math import ceil, log2
from typing import Any

import numpy as np

from . import bodies
from .meshers import Mesher, several
from .tree_meshes import Bounded

# cells of one size in the body, about
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "hexahedra": {
        "ball": (1_000, 10_000, 100_000),
        "torus": (10_000,),
        "bone": (10_000,),
        "noisy 1": (10_000,),
    }
}
INNER = "inner leaves"
__all__ = ["INNER", "MESHERS", "PLAN", "measures", "task", "warm_up"]


def task(work: str, kind: str, n: int) -> Bounded:
    """A body and an octree of leaves of one size, of which about n would fill the body."""
    from unstruct import octree

    make, volume = bodies.GOOD[kind]
    side = (volume / n) ** (1 / 3)
    domain = make(side)
    low, high = domain.bounds
    half = 0.5 * side * 2 ** ceil(log2(float((high - low).max()) / side + 1))
    middle = 0.5 * (low + high)
    return Bounded(domain, octree(domain, 1.01 * side, box=[middle - half, middle + half]))


def warm_up(work: str) -> list[Bounded]:
    """A small task."""
    return [task(work, "ball", 500)]


def _kind(name: str) -> Any:
    return several(lambda given: (given.domain, given.fresh().mesh(name)))


MESHERS = [
    Mesher("unstruct", "unstruct", "hexahedra", _kind("hex-dominant")),
    Mesher(INNER, "unstruct", "hexahedra", _kind("hexahedra")),
]


def measures(domain: Any, mesh: Any, work: str, given: Any) -> dict[str, Any]:
    """Cells by kind, the share of the volume that hexahedra have, and how good the cells are."""
    from unstruct.simplex import dihedral_angles

    counts = {name: len(block) for name, block in mesh.cells.items()}
    first = np.cumsum([0, *counts.values()])
    volumes = dict(zip(counts, np.split(mesh.volumes, first[1:-1])))
    tetrahedra = mesh.cells.get("tetra")
    least = None
    if tetrahedra is not None:
        least = float(np.degrees(dihedral_angles(mesh.points[tetrahedra]).min()))
    return {
        "cells": int(first[-1]),
        "hexahedra": counts["hexahedron"],
        "pyramids": counts.get("pyramid", 0),
        "tetrahedra": counts.get("tetra", 0),
        "share": float(volumes["hexahedron"].sum()) / domain.volume,
        "filled": float(mesh.volumes.sum()) / domain.volume,
        "positive": bool((mesh.jacobian_signs() > 0).all()),
        "worst": float(mesh.quality("scaled_jacobian").min()),
        "least": least,
        "complete": bool(mesh.complete),
    }
