"""The report of the suite ``tree``: a table for each work, and the exponents of growth."""

from __future__ import annotations

from typing import Any

from . import report
from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative, short

Row = dict[str, Any]
TITLES = {
    "build": "Build and balance: leaves per second",
    "locate": "Location of a million points",
    "conforming": "Conforming triangles and tetrahedra by templates",
}
BOUNDARY = "Meshes of planar regions from quadtrees, and from the sides of their leaves as a size"
__all__ = ["BOUNDARY", "TITLES", "boundary", "markdown", "plot", "same", "summary", "table"]


def same(case: dict[str, Row], peer: str) -> str:
    """Whether the peer found the same leaves as we did."""
    if peer == OURS or "checksum" not in case[peer]:
        return ""
    return "yes" if case[peer]["checksum"] == case[OURS]["checksum"] else "**no**"


def table(rows: list[Row], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer is faster than unstruct."""
    head = [
        "in the",
        "leaves, about",
        "by",
        "made or found",
        "seconds",
        "million/s",
        f"{OURS} ÷ it",
        "same leaves",
    ]
    head += ["least angle"] if work == "conforming" else []
    lines = []
    for (name, kind, n), case in times(rows).items():
        if name != work or OURS not in case:
            continue
        for peer, row in case.items():
            cells = [kind, short(n), peer, f"{row['cells']:,}", figures(row["seconds"])]
            cells += [figures(speed(row) / 1e6), "" if peer == OURS else relative(ratio(case, peer))]
            cells.append(same(case, peer))
            lines.append(cells + ([f"{row['least']:.1f}°"] if work == "conforming" else []))
    return grid(head, 3, lines)


def summary(rows: list[Row]) -> str:
    """A line for each case: our speed, and this by that of each peer, **bold** if a peer is faster."""
    cases = {key: case for key, case in times(rows).items() if OURS in case and key[0] in TITLES}
    peers = list(dict.fromkeys(name for case in cases.values() for name in case if not name.startswith(OURS)))
    lines = []
    for (work, kind, n), case in cases.items():
        cells = [f"{work}, {kind}", short(n), figures(speed(case[OURS]) / 1e6)]
        lines.append([*cells, *(relative(ratio(case, peer)) if peer in case else "–" for peer in peers)])
    return grid(["work", "leaves", f"{OURS}, million/s", *(f"{OURS} ÷ {peer}" for peer in peers)], 1, lines)


def growth(rows: list[Row]) -> str:
    """The exponents p of seconds ~ n^p for building, n being the true number of leaves."""
    counted = [{**row, "n": row["cells"]} for row in rows if row["work"] == "build"]
    found: dict[tuple[str, str], list[Row]] = {}
    for row in counted:
        found.setdefault((row["kind"], row["contestant"]), []).append(row)
    lines = []
    for (kind, name), some in found.items():
        fitted = report.growth([{**row, "dimension": kind} for row in some])
        for exponent in fitted.values():
            span = f"{min(row['n'] for row in some):,} to {max(row['n'] for row in some):,}"
            lines.append([kind, name, span, f"{exponent:.2f}"])
    return grid(["in the", "by", "leaves", "p"], 2, lines)


def boundary(rows: list[Row]) -> str:
    """A line for each case and kind of mesh: angles, and speed as a number of cells."""
    head = ["region", "cells, about", "mesh", "cells", "seconds", "million/s"]
    head += ["least angle", "away from input angles", "listed"]
    lines = []
    for (name, kind, n), case in times(rows).items():
        if name != "boundary":
            continue
        for method, row in case.items():
            cells = [kind, short(n), "fitted" if method == OURS else method, f"{row['cells']:,}"]
            cells += [figures(row["seconds"]), figures(speed(row) / 1e6)]
            lines.append([*cells, f"{row['least']:.1f}°", f"{row['away']:.1f}°", str(row["listed"])])
    return grid(head, 3, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    sections = {title: table(rows, work) for work, title in TITLES.items() if work in done}
    if "boundary" in done:
        sections[BOUNDARY] = boundary(rows)
    if "build" in done:
        sections["Growth of the time to build: exponents p of seconds ~ n^p"] = growth(rows)
    return page(result, sections)


def plot(rows: list[Row]) -> None:
    """There is no picture: the tables have it all."""
