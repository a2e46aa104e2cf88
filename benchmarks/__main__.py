"""``python -m benchmarks SUITE``: run a suite, write its rows, table and plot, and print the table.

With ``--only WORK ...`` only some works are run, and their rows replace the old ones in the results.
"""

from __future__ import annotations

import argparse
import json
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
    merging,
    parallel,
    planar,
    planar_report,
    prisms,
    prisms_report,
    report,
    small,
    small_report,
    space_front,
    surface,
    surface_report,
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
    "parallel": parallel.run,
    "planar": planar.run,
    "prisms": prisms.run,
    "small": small.run,
    "space_front": space_front.run,
    "surface": surface.run,
    "threads": threads.run,
    "tree": tree.run,
    "volume": volume.run,
}
LARGEST = {"tree": 1e7}
# Reports have `markdown` and `plot`.
REPORTS: dict[str, Any] = {
    "delaunay": report,
    "front": planar_report,
    "layers": layers_report,
    "parallel": parallel,
    "planar": planar_report,
    "prisms": prisms_report,
    "small": small_report,
    "space_front": space_front,
    "surface": surface_report,
    "threads": threads,
    "tree": tree_report,
    "volume": volume_report,
}


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line and run the suite; return 1 if unstruct failed in a case."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("suite", choices=sorted(SUITES))
    most = "largest number of points or cells (default 1e6, trees 1e7)"
    parser.add_argument("--max", type=float, help=most)
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="WORK", help="run these works, keep other rows"
    )
    parser.add_argument("--repeats", type=int, default=3, help="runs of each contestant (default 3)")
    limit = "seconds for one case (default 300; 0 means no limit)"
    parser.add_argument("--timeout", type=float, default=300.0, help=limit)
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder for rows, table and plot")
    options = parser.parse_args(arguments)
    largest = int(LARGEST.get(options.suite, 1e6) if options.max is None else options.max)
    known = Workers(only=[""])  # nobody is asked: what would be?
    SUITES[options.suite](known, largest, options.repeats)
    unknown = [work for work in options.only if work not in known.works]
    if unknown:
        parser.error(f"{unknown[0]} is no work of this suite, which has {', '.join(known.works)}")
    workers = Workers(options.timeout or None, options.only)
    before = machine.load()
    rows = SUITES[options.suite](workers, largest, options.repeats)
    versions = {row["contestant"]: row["version"] for row in rows if row["measure"] == "time"}
    result = {
        "suite": options.suite,
        "machine": machine.describe(),
        "load": [before, machine.load()],
        "versions": versions,
        "failures": workers.failures,
        "rows": rows,
    }
    path = options.results / f"{options.suite}.json"
    if options.only and path.exists():
        try:
            result = merging.merged(json.loads(path.read_text(encoding="utf-8")), result, options.only)
        except ValueError as error:
            parser.error(str(error))
    report.write(result, options.results, REPORTS[options.suite])
    print(REPORTS[options.suite].markdown(result))
    return int(any(report.OURS in text for text in workers.failures))


if __name__ == "__main__":
    sys.exit(main())
