"""``python -m benchmarks SUITE``: run a suite, write its rows, table and plot, and print the table."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import (
    delaunay,
    front,
    layers,
    layers_report,
    machine,
    planar,
    planar_report,
    prisms,
    prisms_report,
    report,
    small,
    small_report,
    threads,
    tree,
    tree_report,
    volume,
    volume_report,
)
from .run import RESULTS, Workers

# A suite is a function of workers, the largest size and the number of repeats; it returns rows.
SUITES: dict[str, Callable[[Workers, int, int], list[dict[str, Any]]]] = {
    "delaunay": delaunay.run,
    "front": front.run,
    "layers": layers.run,
    "planar": planar.run,
    "prisms": prisms.run,
    "small": small.run,
    "threads": threads.run,
    "tree": tree.run,
    "volume": volume.run,
}
# Reports have `markdown` and `plot`.
REPORTS: dict[str, Any] = {
    "delaunay": report,
    "front": planar_report,
    "layers": layers_report,
    "planar": planar_report,
    "prisms": prisms_report,
    "small": small_report,
    "threads": threads,
    "tree": tree_report,
    "volume": volume_report,
}


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line and run the suite; return 1 if unstruct failed in a case."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("suite", choices=sorted(SUITES))
    parser.add_argument("--max", type=float, default=1e6, help="largest number of points (default 1e6)")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each contestant (default 3)")
    limit = "seconds for one case (default 300; 0 means no limit)"
    parser.add_argument("--timeout", type=float, default=300.0, help=limit)
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder for rows, table and plot")
    options = parser.parse_args(arguments)
    workers = Workers(options.timeout or None)
    before = machine.load()
    rows = SUITES[options.suite](workers, int(options.max), options.repeats)
    versions = {row["contestant"]: row["version"] for row in rows if row["measure"] == "time"}
    result = {
        "suite": options.suite,
        "machine": machine.describe(),
        "load": [before, machine.load()],
        "versions": versions,
        "failures": workers.failures,
        "rows": rows,
    }
    report.write(result, options.results, REPORTS[options.suite])
    print(REPORTS[options.suite].markdown(result))
    return int(any(report.OURS in text for text in workers.failures))


if __name__ == "__main__":
    sys.exit(main())
