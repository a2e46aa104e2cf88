"""The suite ``surface``: triangles on surfaces in space. Each work is described in its own module."""

from __future__ import annotations

from typing import Any

from . import surface_intrinsic, surface_remeshing
from .run import Workers, measured

# Modules of works: each has PLAN (work -> kind -> sizes), MESHERS, task, warm_up and measures.
MODULES: tuple[Any, ...] = (surface_remeshing, surface_intrinsic)
OF_WORK: dict[str, Any] = {work: module for module in MODULES for work in module.PLAN}
MESHERS = [mesher for module in MODULES for mesher in module.MESHERS]
__all__ = ["MESHERS", "MODULES", "OF_WORK", "measures", "run", "task", "warm_up"]


def task(work: str, kind: str, n: int) -> Any:
    """What the contestants of a work are given."""
    return OF_WORK[work].task(work, kind, n)


def warm_up(work: str) -> Any:
    """A small task of the same kind."""
    return OF_WORK[work].warm_up(work)


def measures(*result: Any) -> dict[str, Any]:
    """What a work measures: the result, then the work and what was given."""
    return OF_WORK[result[-2]].measures(*result)


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles."""
    rows: list[dict[str, Any]] = []
    for work, module in OF_WORK.items():
        names = [mesher.name for mesher in module.MESHERS if mesher.work == work]
        for kind, sizes in module.PLAN[work].items():
            expected = dict.fromkeys(names, 0.0)  # who is slow at one size runs only once at the next
            for n in sizes:
                if n <= largest:
                    case = {"suite": "surface", "work": work, "kind": kind, "n": n}
                    found = measured(workers, "meshed", case, expected, repeats)
                    missing = set(names) - {row["contestant"] for row in found}
                    for name in names if not found and len(missing) > 1 else []:  # one of them has failed
                        found += measured(workers, "meshed", case, {name: expected[name]}, repeats)
                    rows += found
    return rows
