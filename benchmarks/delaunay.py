"""The suite ``delaunay``: from points to arrays of cells, in two, three and more dimensions."""

from __future__ import annotations

from statistics import median
from typing import Any

from .contestants import DELAUNAY, find
from .run import Workers, measured

PLAN = {
    2: (("uniform", "clustered", "lattice", "circle"), (10**4, 10**5, 10**6)),
    3: (("uniform", "clustered", "lattice", "sphere"), (10**4, 10**5, 10**6)),
    4: (("uniform",), (10**2, 10**3)),
}
MEMORY = {2: 10**6, 3: 10**5}  # sizes at which peak memory is measured, on uniform points
CAP = {3: {"clustered": 10**5, "lattice": 10**5, "sphere": 10**5}}  # larger sizes would only take longer


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` points."""
    rows: list[dict[str, Any]] = []
    for dimension, (kinds, sizes) in PLAN.items():
        names = [contestant.name for contestant, _ in find(DELAUNAY, dimension)]
        for kind in kinds:
            expected = dict.fromkeys(names, 0.0)
            for n in sizes:
                if n > min(largest, CAP.get(dimension, {}).get(kind, largest)):
                    continue
                case = {"dimension": dimension, "kind": kind, "n": n}
                rows += measured(workers, "timed", case, expected, repeats)
        n = min(largest, MEMORY.get(dimension, 0))
        for name in names if n else []:
            job = {"dimension": dimension, "kind": "uniform", "n": n, "contestant": name}
            result = workers.ask("memory", job)
            if result is not None:
                rows.append({"measure": "memory", "megabytes": round(result, 1), **job})
    starts = [s for s in (workers.ask("start", {}) for _ in range(max(repeats, 3))) if s is not None]
    for name in starts[0] if starts else []:
        rows.append({"measure": "start", "what": name, "seconds": median(s[name] for s in starts)})
    return rows
