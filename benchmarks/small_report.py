"""The small suite, told: one table a work, the fewest triangles first."""

from __future__ import annotations

from typing import Any

from .planar_report import times
from .report import OURS, figures, grid, page, ratio, relative

Row = dict[str, Any]
TITLES = {
    "constrained": "Constrained Delaunay triangulation of the example files",
    "refined": "Refinement of the example files: angles of at least 30°",
    "sized": "The same with a greatest area",
    "round holes": "A square with 64 round holes: true arcs",
}


def table(rows: list[Row], work: str) -> str:
    """A line a case: our microseconds, those of peers, and these divided by ours (**bold** below 1)."""
    cases = [(key[1], case) for key, case in times(rows).items() if key[0] == work and OURS in case]
    cases.sort(key=lambda pair: pair[1][OURS]["cells"])
    peers = sorted({name for _, case in cases for name in case} - {OURS})
    head = ["input", "triangles", f"{OURS} µs", "µs a triangle"]
    for peer in peers:
        head += ["its triangles", f"{peer} µs", f"{peer} ÷ {OURS}"]
    lines = []
    for kind, case in cases:
        ours = case[OURS]
        cells = [kind, str(ours["cells"]), f"{ours['seconds'] * 1e6:.0f}"]
        cells.append(figures(ours["seconds"] / ours["cells"] * 1e6))
        for peer in peers:
            if peer not in case:
                cells += ["–"] * 3
                continue
            row = case[peer]
            cells += [str(row["cells"]), f"{row['seconds'] * 1e6:.0f}", relative(ratio(case, peer))]
        lines.append(cells)
    return grid(head, 1, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite ``small``."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    return page(result, {title: table(rows, work) for work, title in TITLES.items() if work in done})


def plot(rows: list[Row]) -> None:
    """There is no picture: the table has it all."""
