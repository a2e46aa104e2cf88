"""One case in a process of its own, on one core: ``python -m benchmarks.worker '{...}'`` prints JSON.

A contestant that crashes or hangs affects only its case.
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

SHORT = 0.1  # a run that takes fewer seconds is repeated several times in a row, and the mean is taken
ONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


def pin() -> None:
    """Stay on one core, if the system allows it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def _rows(case: dict, found: list[tuple[Any, str]], small: Any) -> list[dict[str, Any]]:
    """A row for each contestant, after a small task that loads compiled code and makes lazy imports."""
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
    """Run all contestants in turn, ``repeats`` times; add the seconds to their rows; yield row and result.

    A first run of each, which is not counted, determines how often it fits into a short time. Contestants
    that are so slow that they run only once have no such first run.
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
    """One row for each contestant; all run in turn, ``repeats`` times."""
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
    """Seconds for ``import unstruct`` and for first calls, with the kernels in the cache on disk."""
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
    """One row for each mesher of a work, with the quality of its mesh; all run in turn, ``repeats`` times."""
    from . import front, layers, meshers, planar, prisms, small, space_front, surface, tree, volume
    from .quality import measures

    work, n = case["work"], case["n"]
    suites: dict[str, Any] = {
        "small": small,
        "surface": surface,
        "front": front,
        "layers": layers,
        "prisms": prisms,
        "space_front": space_front,
        "tree": tree,
        "volume": volume,
    }
    suite: Any = suites.get(case.get("suite", ""), planar)
    found = meshers.find(work, getattr(suite, "MESHERS", meshers.MESHERS))
    rows, given = _rows(case, found, suite.warm_up(work)), suite.task(work, case["kind"], n)
    for row, mesh in _in_turn(case, rows, given):
        row["mesh"] = mesh
    for row in rows:
        del row["run"]
        row.update(getattr(suite, "measures", measures)(*row.pop("mesh"), work, given))
    return rows


def threads(case: dict) -> dict[str, Any]:
    """Two meshes one after the other, and at once."""
    from .threads import both_ways

    return both_ways(case)


def parallel(case: dict) -> dict[str, Any]:
    """One region in parts."""
    from .parallel import measured

    return measured(case)


def solid(case: dict) -> list[dict[str, Any]]:
    """What a mesher makes of CAD-like bodies."""
    from .solids import judged

    return judged(case)


JOBS = {
    "timed": timed, "meshed": meshed, "memory": memory, "start": start, "threads": threads, "solid": solid,
    "parallel": parallel,
}  # fmt: skip

if __name__ == "__main__":
    os.environ.update(ONE)
    job = json.loads(sys.argv[1])
    if job["job"] not in ("threads", "parallel"):
        pin()
    print("\n" + json.dumps(JOBS[job["job"]](job)))
