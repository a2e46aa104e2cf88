"""The suite ``planar``: constrained triangulation, refinement, and meshes of a wanted size."""

from __future__ import annotations

from typing import Any

from .meshers import find
from .regions import AREA, GRAPHS, edge_for, plate
from .run import Workers, measured

# work -> kinds and sizes: numbers of points for "constrained", rough numbers of triangles for the others
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "constrained": {
        "matches": (10**4, 10**5, 10**6),
        "coast": (10**4, 10**5, 10**6),
        "hedgehog": (10**3, 10**4),
    },
    "refined": {"plate": (10**4, 10**5, 10**6)},
    "uniform": {"holed square": (10**4, 10**5, 10**6)},
    "graded": {"holed square": (10**5,)},
}
FILL = 1.6  # with a bound on the area, the mean triangle has about 1/FILL of it


def task(work: str, kind: str, n: int) -> Any:
    """The input of the meshers: a graph; a graph and an area; or an edge length (None for "graded")."""
    if work == "constrained":
        return GRAPHS[kind](n)
    if work == "refined":
        return plate(), FILL * AREA / n
    return edge_for(n) if work == "uniform" else None


def warm_up(work: str) -> Any:
    """A small task of the same kind, which loads compiled code and makes lazy imports."""
    return None if work == "graded" else task(work, "matches", 200)


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` points or triangles."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, sizes in kinds.items():
            expected = {mesher.name: 0.0 for mesher, _ in find(work)}
            for n in sizes:
                if n <= largest:
                    case = {"work": work, "kind": kind, "n": n}
                    rows += measured(workers, "meshed", case, expected, repeats)
    return rows
