"""``python -m benchmarks.cold [CALL ...]``: CPU seconds of first calls from an empty cache of kernels.

Each call runs in a process of its own, which then reports the import, the first call, the second one, and the
kernels that took longest to compile (by themselves, without those that they call). A second process measures
the first call from the cache that the first has left.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

from .run import ROOT

CALLS: dict[str, Callable[[Any, Any], Any]] = {
    "delaunay, plane": lambda u, p: u.delaunay(p[:, :2]),
    "delaunay, space": lambda u, p: u.delaunay(p),
    "constrained_delaunay": lambda u, p: u.constrained_delaunay(_square(u)),
    "voronoi": lambda u, p: u.voronoi(p[:, :2]),
    "insert": lambda u, p: u.insert(u.delaunay(p[:, :2]), [0.5, 0.5]),
    "gift_wrap": lambda u, p: u.gift_wrap(p[:, :2]),
    "voronoi_segment": lambda u, p: u.voronoi_segment(_square(u), 0.2),
    "refine": lambda u, p: u.refine(_square(u), 0.2),
    "check": lambda u, p: u.check(u.constrained_delaunay(_square(u)), domain=_square(u)),
}


def _square(u: Any) -> Any:
    return u.Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])


def measured(name: str) -> dict[str, Any]:
    """Seconds of the import, of the first call, of the second, and of each kernel by itself."""
    begin = time.process_time()
    import unstruct

    imported = time.process_time() - begin
    import numpy as np
    from numba.core import event

    class Kernels(event.Listener):
        """Keep the time of each compilation without those within it."""

        def __init__(self) -> None:
            self.open: list[list[float]] = []
            self.found: list[tuple[float, str]] = []

        def on_start(self, event: Any) -> None:
            self.open.append([time.process_time(), 0.0])

        def on_end(self, event: Any) -> None:
            start, within = self.open.pop()
            whole = time.process_time() - start
            function = event.data["dispatcher"].py_func
            self.found.append((whole - within, f"{function.__module__}.{function.__name__}"))
            if self.open:
                self.open[-1][1] += whole

    kernels = Kernels()
    event.register("numba:compile", kernels)
    points, seconds = np.random.default_rng(0).random((50, 3)), []
    for _ in range(2):
        begin = time.process_time()
        CALLS[name](unstruct, points)
        seconds.append(time.process_time() - begin)
    return {
        "import": imported,
        "first": seconds[0],
        "second": seconds[1],
        "kernels": sorted(kernels.found)[::-1],
    }


def _in_a_process(name: str, folder: str) -> dict[str, Any]:
    """`measured` in a fresh process, with this folder as the cache."""
    command = [
        sys.executable,
        "-c",
        f"import json, benchmarks.cold as c; print(json.dumps(c.measured({name!r})))",
    ]
    environment = os.environ | {"NUMBA_CACHE_DIR": folder}
    done = subprocess.run(command, cwd=ROOT, env=environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def main(arguments: list[str] | None = None) -> None:
    """Print a line for each call, and with ``--kernels N`` the N dearest kernels of each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cold", description=__doc__)
    parser.add_argument("calls", nargs="*", metavar="CALL", help=f"of {', '.join(CALLS)}; default: all")
    parser.add_argument("--kernels", type=int, default=0, help="list so many kernels of each call")
    options = parser.parse_args(arguments)
    print("| first call | kernels | cold, CPU s | from the cache, CPU ms | import, CPU ms |")
    print("|---|---:|---:|---:|---:|")
    for name in options.calls or CALLS:
        with tempfile.TemporaryDirectory() as folder:
            cold, warm = _in_a_process(name, folder), _in_a_process(name, folder)
        shown = f"{cold['first']:.1f} | {1000 * warm['first']:.0f} | {1000 * warm['import']:.0f}"
        print(f"| {name} | {len(cold['kernels'])} | {shown} |", flush=True)
        for seconds, kernel in cold["kernels"][: options.kernels]:
            print(f"|   {kernel} | | {seconds:.2f} | | |")


if __name__ == "__main__":
    main()
