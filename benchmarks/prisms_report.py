"""The report of the suite ``prisms``: tables of layers, of growth, and of the joined mesh."""

from __future__ import annotations

from math import log
from typing import Any

from .planar_report import ratio, times
from .report import OURS, figures, grid, page, relative

Row = dict[str, Any]
TITLES = {
    "layers": "Thirty layers on closed surfaces",
    "growth": "Growth: exponents p of seconds ~ n^p",
    "joined": "Layers and tetrahedra beyond them as one mesh",
}
SHORT_NAMES = {"Gmsh extrudeBoundaryLayer": "Gmsh", f"{OURS}, checks of the surface": "… with checks"}
__all__ = ["TITLES", "growth", "joined", "layers", "markdown", "plot", "summary"]


def _cases(rows: list[Row], work: str) -> dict[tuple[Any, str, int], dict[str, Row]]:
    return {key: case for key, case in times(rows).items() if key[0] == work and OURS in case}


def layers(rows: list[Row]) -> str:
    """A line for each body and contestant; **bold**: a peer is faster, wedges are not positive."""
    head = ["body", "by", "seconds", f"÷ {OURS}", "not positive", "full height", "least Jacobian"]
    lines = []
    for (_, kind, _), case in _cases(rows, "layers").items():
        for name, row in case.items():
            cells = [kind, SHORT_NAMES.get(name, name), figures(row["seconds"])]
            cells += ["" if name.startswith(OURS) else relative(ratio(case, name))]
            cells += [f"**{row['bad']:,}**" if row["bad"] else "0"]
            full, least = (
                row.get(f"figure: {key}") for key in ("share of full heights", "least scaled Jacobian")
            )
            cells += ["" if full is None else f"{100 * full:.1f} %", "" if least is None else f"{least:.2g}"]
            lines.append(cells)
    return grid(head, 2, lines)


def summary(rows: list[Row]) -> str:
    """A line for each body: our wedges and speed, the time of the peer by ours, and its wrong wedges."""
    lines = []
    for (_, kind, _), case in _cases(rows, "layers").items():
        ours = case[OURS]
        peers = [name for name in case if not name.startswith(OURS)]
        cells = [kind, f"{ours['wedges'] / 1e6:.1f}", figures(ours["wedges"] / ours["seconds"] / 1e6)]
        cells += [str(ours["bad"])]
        cells += [relative(ratio(case, peers[0])), f"{case[peers[0]]['bad']:,}"] if peers else ["–", "–"]
        lines.append(cells)
    head = ["body", "million wedges", f"{OURS}, million/s", "not positive", f"seconds of Gmsh ÷ {OURS}"]
    return grid([*head, "not positive of Gmsh"], 1, lines)


def growth(rows: list[Row]) -> str:
    """A line for each contestant and number of wedges, with the exponent from one to the next."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        if row["work"] == "growth" and row["measure"] == "time":
            found.setdefault(row["contestant"], []).append(row)
    lines = []
    for name, some in found.items():
        some.sort(key=lambda row: row["wedges"])
        for before, row in zip([None, *some], some):
            cells = [SHORT_NAMES.get(name, name), f"{row['wedges']:,}", figures(row["seconds"])]
            cells += [f"{1e9 * row['seconds'] / row['wedges']:.0f}"]
            if before is None:
                cells += ["–"]
            else:
                more = log(row["seconds"] / before["seconds"]) / log(row["wedges"] / before["wedges"])
                cells += [f"{more:.2f}"]
            lines.append(cells)
    return grid(["by", "wedges", "seconds", "ns a wedge", "p"], 1, lines)


def joined(rows: list[Row]) -> str:
    """A line for each contestant: what the mesh has, whether it is valid, and how good it is."""
    head = ["by", "wedges", "tetrahedra", "seconds", "valid", "not positive"]
    head += ["least angle", "< 12°", "jump, median", "largest"]
    lines = []
    for case in _cases(rows, "joined").values():
        for name, row in case.items():
            cells = [SHORT_NAMES.get(name, name)]
            cells += [f"{row['wedges']:,}", f"{row['cells'] - row['wedges']:,}"]
            valid = row.get("valid")
            cells += [figures(row["seconds"]), "" if valid is None else "yes" if valid else "**no**"]
            cells += [f"{row['bad']:,}" if not row["bad"] else f"**{row['bad']:,}**"]
            cells += (
                [f"{row['min_dihedral']:.1f}°", f"{row['below_12']:,}"]
                if "min_dihedral" in row
                else ["–"] * 2
            )
            jumps = [
                value for key, value in row.items() if key.startswith("figure: ") and "jump" in key and value
            ]
            cells += [f"{value:.2f}" for value in sorted(jumps)[:2]] or ["", ""]
            lines.append(cells)
    return grid(head, 1, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    tables = {"layers": layers, "growth": growth, "joined": joined}
    return page(result, {title: tables[work](rows) for work, title in TITLES.items() if work in done})


def plot(rows: list[Row]) -> None:
    """There is no picture: the tables have it all."""
