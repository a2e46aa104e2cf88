"""The suite ``parallel``: one region in parts, by one and two workers; ten million triangles on a cluster.

Wall time counts here, and no core is fixed: run it on an idle machine. "strong" is one mesh in eight parts,
"weak" has as many triangles for each worker, "overhead" what an engine takes for a part without work. "far"
is run with ``--max 1e7`` only: two Dask workers with a limit of 2 GB, one of which is killed on the way.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from statistics import median
from typing import Any

from .report import figures, grid, page, short
from .run import Workers

SIZES = {"strong": (10**5, 10**6), "weak": (10**5, 5 * 10**5), "overhead": (10**3,), "far": (10**7,)}
EXECUTORS = (("map", 1), ("threads", 1), ("threads", 2), ("processes", 1), ("processes", 2), ("dask", 1),
             ("dask", 2))  # fmt: skip
PARTS = {"strong": 8, "overhead": 40, "far": 64}
PARTS_OF_ONE = 4  # "weak": parts for each worker
LIMIT = "2GB"  # of memory, for each worker of "far"
KILLED_AFTER = 16  # parts that are done when a worker dies


@contextmanager
def _cluster(many: int, **options: Any) -> Iterator[Any]:
    from distributed import Client, LocalCluster

    settings = {"threads_per_worker": 1, "processes": True, "dashboard_address": None, **options}
    with LocalCluster(n_workers=many, **settings) as cluster, Client(cluster) as client:
        yield client


@contextmanager
def _mapping(executor: str, many: int) -> Iterator[Callable[..., Any]]:
    """The map of an executor with some workers."""
    if executor == "map":
        yield map
    elif executor == "threads":
        with ThreadPoolExecutor(many) as threads:
            yield threads.map
    elif executor == "processes":
        with ProcessPoolExecutor(many, mp_context=get_context("spawn")) as processes:
            yield processes.map
    else:
        with _cluster(many) as client:
            yield lambda work, parts: client.gather(client.map(work, parts, pure=False))


def _edge(n: int) -> float:
    """The edges of n equilateral triangles with the area of the unit square."""
    return math.sqrt(4.0 / math.sqrt(3.0) / n)


def _nothing(domain: Any, size: Any) -> None:
    """A method that does no work."""


def in_parts(case: dict[str, Any]) -> dict[str, Any]:
    """Wall seconds of the same mesh by one executor, as often as asked."""
    from unstruct import Domain, mesh_parts

    square, work, many = Domain.rectangle(), case["work"], case["workers"]
    n = case["n"] * (many if work == "weak" else 1)
    parts = PARTS_OF_ONE * many if work == "weak" else PARTS[work]
    options: dict[str, Any] = {"method": _nothing, "join": False} if work == "overhead" else {}
    seconds, size = [], _edge(n)
    with _mapping(case["executor"], many) as mapping:
        mesh_parts(square, size, parts, map=mapping, **options)  # compiled code is loaded everywhere
        for _ in range(case["repeats"]):
            begin = time.perf_counter()
            made = mesh_parts(square, size, parts, map=mapping, **options)
            seconds.append(time.perf_counter() - begin)
    cells = 0 if work == "overhead" else made.size
    return {"seconds": seconds, "parts": parts, "cells": cells, "cores": os.cpu_count()}


def _figures(mesh: Any) -> tuple[int, float]:
    return mesh.size, float(mesh.quality("min_angle").min())


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def far(case: dict[str, Any]) -> dict[str, Any]:
    """Many triangles that stay on two workers of a cluster, of which one is killed on the way."""
    from distributed import wait

    from unstruct import Domain, mesh_parts

    begin = time.perf_counter()
    with _cluster(2, memory_limit=LIMIT) as client:
        found = mesh_parts(Domain.rectangle(), _edge(case["n"]), PARTS["far"], join=False, map=client.map)
        divided, peaks = time.perf_counter() - begin, {}
        stop = threading.Event()

        def watch() -> None:
            while not stop.wait(0.5):
                for pid, megabytes in client.run(_own_peak, on_error="ignore").values():
                    peaks[pid] = max(peaks.get(pid, 0.0), megabytes)

        watcher = threading.Thread(target=watch)
        watcher.start()
        while sum(mesh.done() for mesh in found.meshes) < KILLED_AFTER:
            time.sleep(0.05)
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
        wait(client.map(_figures, found.meshes))
        rows = client.gather(client.map(_figures, found.meshes))
        stop.set()
        watcher.join()
    return {
        "seconds": [time.perf_counter() - begin], "divided": divided, "parts": len(rows),
        "cells": sum(size for size, _ in rows), "least angle": min(angle for _, angle in rows),
        "peaks": sorted(peaks.values()), "own peak": _peak(), "cores": os.cpu_count(),
    }  # fmt: skip


def _own_peak() -> tuple[int, float]:
    return os.getpid(), _peak()


def measured(case: dict[str, Any]) -> dict[str, Any]:
    """What the worker of this suite does."""
    return far(case) if case["work"] == "far" else in_parts(case)


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles."""
    rows = []
    for work, sizes in SIZES.items():
        chosen = (("dask", 2),) if work == "far" else EXECUTORS
        for n in (n for n in sizes if n <= largest):
            for executor, many in chosen:
                case = {"work": work, "n": n, "executor": executor, "workers": many, "repeats": repeats}
                row = workers.ask("parallel", case)
                if row is not None:
                    rows.append({"measure": "parallel", **case, **row})
    return rows


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    titles = {
        "strong": "One mesh in eight parts, joined",
        "weak": "As many triangles for each worker, joined",
        "overhead": "Forty parts without work",
        "far": "On a cluster of two, one killed on the way; results stay there",
    }
    tables = {}
    for work, title in titles.items():
        rows = [row for row in result["rows"] if row["work"] == work]
        lines = []
        for row in rows:
            seconds = median(row["seconds"])
            line = [
                row["executor"],
                str(row["workers"]),
                short(row["n"]),
                str(row["parts"]),
                figures(seconds),
            ]
            line.append(figures(1e3 * seconds / row["parts"]))
            line.append(" ".join(f"{peak:.0f}" for peak in row.get("peaks", [])))
            lines.append(line)
        head = ["by", "workers", "n", "parts", "s", "ms a part", "peak of each worker, MB"]
        if lines:
            tables[title] = grid(head, 1, lines)
    return page(result, tables)


def plot(rows: list[dict[str, Any]]) -> None:
    """A table says it all."""
