"""One case in a process of its own, on one core: ``python -m benchmarks.worker '{...}'`` prints JSON.

A contestant that crashes or hangs takes only its case along.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import sys
import time
from collections.abc import Iterator
from typing import Any

SHORT = 0.1  # seconds: what is done sooner is done several times in a row, and the mean counts
ONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


def pin() -> None:
    """Stay on one core, where the system lets us choose."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def _rows(case: dict, found: list[tuple[Any, str]], small: Any) -> list[dict[str, Any]]:
    """A row for each contestant of the case; a small task has loaded compiled code and done lazy imports."""
    rows: list[dict[str, Any]] = []
    for contestant, version in found:
        if contestant.name in case["contestants"]:
            run = contestant.prepare()
            run(small)
            rows.append(
                {"contestant": contestant.name, "version": version, "run": run, "cpu": [], "wall": []}
            )
    return rows


def _in_turn(case: dict, rows: list[dict[str, Any]], given: Any) -> Iterator[tuple[dict[str, Any], Any]]:
    """Run all contestants in turn, as often as asked; their rows take the seconds. Gives row and result.

    A first run of each, which is not counted, tells how often it fits into a short time (but for those that
    are so slow that they are run once).
    """
    times = dict.fromkeys([row["contestant"] for row in rows], 1)
    for row in rows if case["repeats"] > 1 else []:
        begin = time.process_time()
        row["run"](given)
        times[row["contestant"]] = int(SHORT / max(time.process_time() - begin, 1e-4)) + 1
    for _ in range(case["repeats"]):
        for row in rows:
            gc.collect()
            many = times[row["contestant"]]
            wall, cpu = time.perf_counter(), time.process_time()
            for _ in range(many):
                result = row["run"](given)
            row["cpu"].append((time.process_time() - cpu) / many)
            row["wall"].append((time.perf_counter() - wall) / many)
            yield row, result


def timed(case: dict) -> list[dict]:
    """All contestants in turn, as often as asked: one row each."""
    from .contestants import DELAUNAY, find
    from .inputs import KINDS

    points = KINDS[case["kind"]](case["n"], case["dimension"])
    rows = _rows(case, find(DELAUNAY, case["dimension"]), points[: case["dimension"] + 50])
    for row, (cells, inner) in _in_turn(case, rows, points):
        row["cells"] = cells
        row["inner"] = row.get("inner", []) + ([] if inner is None else [inner])
    for row in rows:
        del row["run"]
        row["n"] = len(points)
    return rows


def memory(case: dict) -> float:
    """Megabytes that one contestant needs beyond its imports and its input."""
    from .contestants import DELAUNAY, find
    from .inputs import KINDS

    (contestant,) = [c for c, _ in find(DELAUNAY, case["dimension"]) if c.name == case["contestant"]]
    points = KINDS[case["kind"]](case["n"], case["dimension"])
    run = contestant.prepare()
    run(points[:100])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run(points)
    return (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024


def start(case: dict) -> dict[str, float]:
    """Seconds for ``import unstruct`` and for first calls, the kernels being in the cache on disk."""
    t = [time.process_time()]
    import numba  # noqa: F401

    t.append(time.process_time())
    import unstruct

    t.append(time.process_time())
    from .inputs import uniform

    planar, spatial = uniform(100, 2), uniform(100, 3)
    t.append(time.process_time())
    unstruct.delaunay(planar)
    t.append(time.process_time())
    unstruct.delaunay(spatial)
    t.append(time.process_time())
    return {"numba": t[1] - t[0], "import": t[2] - t[0], "first 2D": t[4] - t[3], "then 3D": t[5] - t[4]}


def meshed(case: dict) -> list[dict]:
    """All meshers of one work in turn, as often as asked: one row each, with the quality of its mesh."""
    from . import meshers, planar, small
    from .quality import measures

    work, n = case["work"], case["n"]
    suite: Any = small if case.get("suite") == "small" else planar
    found = meshers.find(work, getattr(suite, "MESHERS", meshers.MESHERS))
    rows, given = _rows(case, found, suite.warm_up(work)), suite.task(work, case["kind"], n)
    for row, mesh in _in_turn(case, rows, given):
        row["mesh"] = mesh
    for row in rows:
        del row["run"]
        row.update(measures(*row.pop("mesh"), work, given))
    return rows


JOBS = {"timed": timed, "meshed": meshed, "memory": memory, "start": start}

if __name__ == "__main__":
    os.environ.update(ONE)
    pin()
    job = json.loads(sys.argv[1])
    print("\n" + json.dumps(JOBS[job["job"]](job)))
