"""The suite ``threads``: two domains meshed by two threads at once, beside one after the other.

Kernels let go of Python's lock, so that the second core is of use to whoever has several meshes to make. Wall
time counts here, and no core is fixed: where there is one core, or other work, the ratio is nearer to 1.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from statistics import median
from typing import Any

from .inputs import uniform
from .meshers import MESHERS
from .planar import task
from .report import figures, grid, page, relative, short
from .run import Workers

SIZES = (10**4, 10**5, 10**6)
WORKS = ("points", "refined", "uniform")
TWO = 2  # threads


def _mesher(work: str, n: int) -> Callable[[], Any]:
    """A function that makes one mesh of about n triangles, or of n points."""
    if work == "points":
        from unstruct import delaunay

        points = uniform(n, 2)
        return lambda: delaunay(points)
    (ours,) = [m for m in MESHERS if m.name == "unstruct" and m.work == work]
    make, given = ours.prepare(), task(work, "plate", n)
    return lambda: make(given)


def both_ways(case: dict[str, Any]) -> dict[str, Any]:
    """Wall seconds of two meshes one after the other and at once, in turn, as often as asked."""
    make = _mesher(case["work"], case["n"])
    make()  # compiled code is loaded
    seconds: dict[str, list[float]] = {"one by one": [], "at once": []}
    with ThreadPoolExecutor(TWO) as pool:
        for _ in range(case["repeats"]):
            begin = time.perf_counter()
            for _ in range(TWO):
                make()
            seconds["one by one"].append(time.perf_counter() - begin)
            begin = time.perf_counter()
            for done in [pool.submit(make) for _ in range(TWO)]:
                done.result()
            seconds["at once"].append(time.perf_counter() - begin)
    return {**seconds, "cores": os.cpu_count()}


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles."""
    rows = []
    for work in WORKS:
        for n in SIZES:
            if n <= largest:
                case = {"work": work, "n": n, "repeats": repeats}
                row = workers.ask("threads", case)
                if row is not None:
                    ratio = median(a / b for a, b in zip(row["one by one"], row["at once"]))
                    rows.append({"measure": "threads", **case, **row, "ratio": ratio})
    return rows


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite: how many times as fast two threads are."""
    lines = [
        [row["work"], short(row["n"]), figures(1e3 * median(row["one by one"])),
         figures(1e3 * median(row["at once"])), relative(row["ratio"])]
        for row in result["rows"]
    ]  # fmt: skip
    head = ["two meshes of", "n", "one by one, ms", "at once, ms", "one by one ÷ at once"]
    return page(result, {"Two threads, two domains: wall time, no core fixed": grid(head, 1, lines)})


def plot(rows: list[dict[str, Any]]) -> None:
    """A table says it all."""
