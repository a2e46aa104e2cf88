"""The report of the suite ``tree``: a table for each work."""

from __future__ import annotations

from math import log
from typing import Any

import numpy as np

from . import tree_pictures
from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative, short
from .stuffing import BOUNDS, GRADED
from .tree_cubes import INNER

Row = dict[str, Any]
Cases = dict[tuple[str, int], dict[str, Row]]
PEER = "discretize"
TITLES = {
    "build": "Build and balance: leaves per second",
    "growth": "Growth of the time to build and balance",
    "locate": "Location of a million points",
    "conforming": "Conforming triangles and tetrahedra by templates",
    "boundary": "Meshes of planar regions from quadtrees, and from the sides of their leaves as a size",
    "stuffing": "Isosurface stuffing of smooth bodies",
    "fields": "Isosurface stuffing of random fields of one level, and of rough graded bodies",
    "hexahedra": "Hexahedra from octrees of bodies",
}
__all__ = [
    "PEER", "TITLES", "angles", "exponent", "markdown", "marks", "of_work", "plot", "quality", "same",
    "shares", "summary", "table",
]  # fmt: skip


def of_work(rows: list[Row], work: str) -> Cases:
    """The cases of a work that we did, by kind and number."""
    return {(kind, n): case for (name, kind, n), case in times(rows).items() if name == work and OURS in case}


def same(case: dict[str, Row], peer: str) -> str:
    """Whether the peer found the same leaves as we did."""
    if peer == OURS or "checksum" not in case[peer]:
        return ""
    return "yes" if case[peer]["checksum"] == case[OURS]["checksum"] else "**no**"


def table(rows: list[Row], work: str) -> str:
    """The table of a work."""
    made = {"growth": growth, "boundary": boundary, "stuffing": stuffed, "fields": fields}
    made["hexahedra"] = hexahedra
    return made[work](rows) if work in made else beside(rows, work)


def beside(rows: list[Row], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer is faster than unstruct."""
    head = ["in the", "leaves, about", "by", "made or found", "seconds", "million/s", f"{OURS} ÷ it"]
    head.append("least angle" if work == "conforming" else "same leaves")
    lines = []
    for (kind, n), case in of_work(rows, work).items():
        for peer, row in case.items():
            cells = [kind, short(n), peer, f"{row['cells']:,}", figures(row["seconds"])]
            cells += [figures(speed(row) / 1e6), "" if peer == OURS else relative(ratio(case, peer))]
            cells.append(f"{row['least']:.1f}°" if work == "conforming" else same(case, peer))
            lines.append(cells)
    return grid(head, 3, lines)


def growth(rows: list[Row]) -> str:
    """A line for each decade: nanoseconds a leaf, and the p of seconds ~ n^p since the line above."""
    head = ["in the", "leaves", "seconds", "ns a leaf", "p", f"{PEER}, ns a leaf", "its p", f"{OURS} ÷ it"]
    lines, before = [], {}
    for (kind, _), case in of_work(rows, "growth").items():
        cells = [kind, f"{case[OURS]['cells']:,}", figures(case[OURS]["seconds"])]
        for name in (OURS, PEER):
            row, last = case.get(name), before.get((kind, name))
            cells.append("–" if row is None else figures(1e9 / speed(row)))
            cells.append("–" if row is None or last is None else f"{exponent(last, row):.2f}")
            before[kind, name] = row
        lines.append([*cells, relative(ratio(case, PEER)) if PEER in case else "–"])
    return grid(head, 1, lines)


def exponent(first: Row, last: Row) -> float:
    """The p of seconds ~ n^p between two rows, n being the true number of leaves."""
    return log(last["seconds"] / first["seconds"]) / log(last["cells"] / first["cells"])


def boundary(rows: list[Row]) -> str:
    """A line for each case and kind of mesh: angles, and speed as a number of cells."""
    head = ["region", "cells, about", "mesh", "cells", "seconds", "million/s"]
    head += ["least angle", "away from input angles", "listed"]
    lines = []
    for (kind, n), case in of_work(rows, "boundary").items():
        for method, row in case.items():
            cells = [kind, short(n), "fitted" if method == OURS else method, f"{row['cells']:,}"]
            cells += [figures(row["seconds"]), figures(speed(row) / 1e6)]
            lines.append([*cells, f"{row['least']:.1f}°", f"{row['away']:.1f}°", str(row["listed"])])
    return grid(head, 3, lines)


def angles(rows: list[Row]) -> str:
    """A line for each case: the least angle away from input angles, and that of all, by kind of mesh."""
    cases = of_work(rows, "boundary")
    names = list(dict.fromkeys(name for case in cases.values() for name in case))
    lines = []
    for (kind, n), case in cases.items():
        cells = [kind, short(n)]
        for name in names:
            away, least = (f"{case[name][key]:.1f}°" for key in ("away", "least"))
            cells.append(away if away == least else f"{away} ({least})")
        lines.append(cells)
    return grid(["region", "cells, about", *("fitted" if name == OURS else name for name in names)], 1, lines)


def stuffed(rows: list[Row]) -> str:
    """A line for each body: dihedral angles, what must be 0, and the speed without the function."""
    head = [
        "body",
        "tetrahedra",
        "from",
        "to",
        "inverted",
        "surface",
        "seconds",
        "million/s without the function",
    ]
    lines = []
    for (kind, _), case in of_work(rows, "stuffing").items():
        row = case[OURS]
        cells = [kind, f"{row['cells']:,}", f"{row['least']:.1f}°", f"{row['most']:.1f}°"]
        cells += [str(row["inverted"]), "**open**" if row["open"] else "closed", figures(row["seconds"])]
        lines.append([*cells, f"{row['cells'] / row['bare'] / 1e6:.2f}"])
    return grid(head, 1, lines)


def fields(rows: list[Row]) -> str:
    """A line for each kind of fields: the worst of all their angles, and what must be 0."""
    head = ["fields", "number", "tetrahedra", "from", "to", "inverted", "not closed", "touch themselves"]
    lines = []
    for (kind, n), case in of_work(rows, "fields").items():
        row = case[OURS]
        cells = [kind, str(n), f"{row['cells']:,}", f"{row['least']:.2f}°", f"{row['most']:.2f}°"]
        lines.append([*cells, *(str(row[key]) for key in ("inverted", "open", "pinched"))])
    return grid(head, 1, lines)


def hexahedra(rows: list[Row]) -> str:
    """A line for each body and kind of mesh: cells, shares of the volume, and the worst of the cells."""
    head = ["body", "leaves inside, about", "mesh", "hexahedra", "pyramids", "tetrahedra"]
    head += ["volume in hexahedra", "all Jacobians positive", "worst scaled Jacobian", "least dihedral"]
    head += ["seconds", "million cells/s"]
    lines = []
    for (kind, n), case in of_work(rows, "hexahedra").items():
        for name, row in case.items():
            cells = [kind, short(n), name if name == INNER else "whole body"]
            cells += [f"{row[key]:,}" if row[key] else "" for key in ("hexahedra", "pyramids", "tetrahedra")]
            cells += [f"{100 * row['share']:.0f} %", "yes" if row["positive"] else "**no**"]
            cells += [f"{row['worst']:.2f}", "" if row["least"] is None else f"{row['least']:.1f}°"]
            lines.append([*cells, figures(row["seconds"]), figures(speed(row) / 1e6)])
    return grid(head, 3, lines)


def shares(rows: list[Row]) -> str:
    """A line for each body: cells, the share of the volume that hexahedra and inner leaves have, seconds."""
    head = ["body", "leaves", "hexahedra", "pyramids", "tetrahedra", "share", "inner", "dihedral", "seconds"]
    lines = []
    for (kind, n), case in of_work(rows, "hexahedra").items():
        row = case[OURS]
        cells = [kind, short(n), *(f"{row[key]:,}" for key in ("hexahedra", "pyramids", "tetrahedra"))]
        cells += [f"{100 * one['share']:.0f} %" for one in (row, case[INNER])]
        lines.append([*cells, f"{row['least']:.1f}°", figures(row["seconds"])])
    return grid(head, 2, lines)


def summary(rows: list[Row]) -> str:
    """A line for each case with a peer: our speed, and this by that of the peer, **bold** if it is faster."""
    lines = []
    for work in ("growth", "locate", "conforming"):
        for (kind, n), case in of_work(rows, work).items():
            cells = [f"{'build' if work == 'growth' else work}, {kind}", short(n)]
            cells.append(figures(speed(case[OURS]) / 1e6))
            lines.append([*cells, relative(ratio(case, PEER)) if PEER in case else "–"])
    return grid(["work", "leaves", f"{OURS}, million/s", f"{OURS} ÷ {PEER}"], 1, lines)


def quality(rows: list[Row]) -> str:
    """A line for each kind of meshes: how many, and the worst of all."""
    lines = []
    planar = of_work(rows, "boundary")
    titles = {"disc": "triangles fitted to a disc", "coast": "to fractal coasts, away from input angles"}
    for name, title in titles.items():
        some = [case[OURS] for (kind, _), case in planar.items() if kind.startswith(name)]
        if some:
            worst = f"angles of at least {min(row['away'] for row in some):.1f}°"
            lines.append([title, str(len(some)), f"{sum(row['cells'] for row in some):,}", worst])
    for title, some in _stuffed(rows).items():
        if some:
            count = sum(row["n"] if row["work"] == "fields" else 1 for row in some)
            low, high = min(row["least"] for row in some), max(row["most"] for row in some)
            worst = f"dihedral angles from {low:.1f}° to {high:.1f}°"
            lines.append([f"{title}, stuffed", str(count), f"{sum(row['cells'] for row in some):,}", worst])
    for (kind, n), case in of_work(rows, "hexahedra").items():
        if kind == "ball":
            worst = f"{100 * case[OURS]['share']:.0f} % of the volume in hexahedra"
            title = f"a ball of {short(n)} leaves by hexahedra and others"
            lines.append([title, "1", f"{case[OURS]['cells']:,}", worst])
    return grid(["meshes", "number", "cells", "worst"], 1, lines)


def _stuffed(rows: list[Row]) -> dict[str, list[Row]]:
    """Rows of stuffing by what theorems say of them: bodies and fields of one size, and graded ones."""
    bodies = {kind: case[OURS] for (kind, _), case in of_work(rows, "stuffing").items()}
    random = of_work(rows, "fields").items()
    return {
        "smooth bodies": [row for kind, row in bodies.items() if kind not in GRADED],
        "graded bodies": [row for kind, row in bodies.items() if kind in GRADED],
        "random fields": [case[OURS] for (kind, _), case in random if kind != "graded"],
        "rough graded bodies": [case[OURS] for (kind, _), case in random if kind == "graded"],
    }


def marks(rows: list[Row]) -> Any:
    """The least angle of meshes of planar regions against their cells per second, as a picture."""
    panels: dict[str, tuple[str, dict[str, list[tuple[float, float]]]]] = {}
    for (kind, _), case in of_work(rows, "boundary").items():
        title = "the disc" if kind == "disc" else "fractal coasts"
        found = panels.setdefault(title, ("degrees", {}))[1]
        for name, row in case.items():
            found.setdefault("fitted" if name == OURS else name, []).append((speed(row) / 1e6, row["away"]))
    return tree_pictures.marks(panels)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    sections = {title: table(rows, work) for work, title in TITLES.items() if work in done}
    if "fields" in done:
        low, high = BOUNDS
        sections[TITLES["fields"]] += f"\n\nThe theorem promises {low}° to {high}° for fields of one level."
    return page(result, sections)


def plot(rows: list[Row]) -> Any:
    """Nanoseconds a leaf by the number of leaves, and all dihedral angles of stuffed bodies and fields."""
    series: dict[str, list[tuple[float, float]]] = {}
    for (kind, _), case in of_work(rows, "growth").items():
        for name, row in case.items():
            series.setdefault(f"{name}, {kind}", []).append((row["cells"], 1e9 / speed(row)))
    counts = {}
    for title, some in _stuffed(rows).items():
        if some:
            counts[title] = np.sum([row["angles"] for row in some], axis=0)
    return tree_pictures.growth_and_angles(series, counts, BOUNDS) if series or counts else None
