"""The suite ``volume``: tetrahedra in bodies beside TetGen, Gmsh and Netgen, all with the same surface.

Each mesher is given points and triangles as arrays and gives points and cells as arrays; our time includes the
checks of the `Domain`. Work: "good" (ten bodies with even triangles), "parts" (machine parts), "graded" (sizes
that vary), all with a size; "bare" and "CAD" without a size, beside TetGen ``pY``. If the peers in one process
crash, each is run by itself. `booleans` judges many CAD-like bodies by seed, see there.
"""

from __future__ import annotations

from typing import Any

from . import bodies, parts, solids
from .meshers import find
from .run import Workers, measured
from .volume_meshers import MESHERS, Given
from .volume_quality import measures

CELLS = 100_000
# work -> kind -> the rough number of cells, or of triangles where there is no size
PLAN: dict[str, dict[str, int]] = {
    "good": dict.fromkeys(bodies.GOOD, CELLS),
    "parts": dict.fromkeys(parts.PARTS, CELLS),
    "graded": dict.fromkeys(bodies.GRADED, CELLS),
    "bare": dict.fromkeys(("ball", "torus", "gridded cube", "bone", "noisy 1"), 6_000),
    "CAD": dict.fromkeys((str(seed) for seed in range(6)), 1_000),
}
PACE = {"Gmsh + Netgen": 2e-4, "Netgen": 2.5e-4}  # roughly the seconds per cell of slow meshers
WARM_CELLS = 2_000

__all__ = ["MESHERS", "PLAN", "measures", "run", "task", "warm_up"]


def task(work: str, kind: str, n: int) -> Given | None:
    """A surface and a size; None for a boolean if ``manifold3d`` is not installed."""
    if work == "CAD":
        return Given(*solids.boolean(int(kind)), None, "")
    if work == "graded":
        domain, size, text = bodies.GRADED[kind](n)
        return Given(domain.points, domain.triangulated.triangles, size, text)
    if work == "bare":  # n triangles of area h^2 sqrt(3) / 4
        make, _ = bodies.GOOD[kind]
        domain = make(0.06 * (6_000 / n) ** 0.5)
        return Given(domain.points, domain.triangulated.triangles, None, "")
    make, volume = (bodies.GOOD | parts.PARTS)[kind]
    h = bodies.edge_length(volume, n)
    domain = make(h)
    return Given(domain.points, domain.triangulated.triangles, h, f"{h:.9g}")


def warm_up(work: str) -> Given:
    """A small task of the same kind: compiled code is loaded, lazy imports are done."""
    h = bodies.edge_length(4.19, WARM_CELLS)
    domain = bodies.spiral(h)
    sized = work in ("good", "parts", "graded")
    text = f"{h:.9g}" if sized else ""
    return Given(domain.points, domain.triangulated.triangles, h if sized else None, text)


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` cells."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        if work == "CAD" and not solids.can():
            continue
        for kind, n in kinds.items():
            if n > largest:
                continue
            case = {"suite": "volume", "work": work, "kind": kind, "n": n}
            expected = {mesher.name: n * PACE.get(mesher.name, 0.0) for mesher, _ in find(work, MESHERS)}
            names = dict(expected)
            found = measured(workers, "meshed", case, expected, repeats)
            missing = [name for name in names if name not in {row["contestant"] for row in found}]
            for name in missing if len(missing) > 1 else []:  # one of them may have crashed: each by itself
                found += measured(workers, "meshed", case, {name: names[name]}, repeats)
            rows += found
    return rows
