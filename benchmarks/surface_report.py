"""The report of the suite ``surface``: a table for each work."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative, short

Row = dict[str, Any]
PEERS = ("pymeshlab", "libigl")
__all__ = ["TABLES", "intrinsic", "markdown", "plot", "remeshing", "summary"]


def remeshing(rows: list[Row]) -> str:
    """A line for each surface and contestant, in two tables; **bold** if a peer is faster."""
    head = ["surface", "given triangles", "by", "triangles", "seconds", "1000 triangles/s", f"{OURS} ÷ it"]
    other = ["surface", "by", "least angle", "0.1 % below", "below 30°", "deviation ÷ size"]
    other += ["corner off ÷ size", "crease off ÷ size", "topology kept", "crossings"]
    speeds, shapes = [], []
    for (name, kind, n), case in times(rows).items():
        if name != "remeshing" or OURS not in case:
            continue
        for peer, row in case.items():
            speeds.append([
                kind, str(row["given"]), peer, str(row["cells"]), figures(row["seconds"]),
                figures(speed(row) / 1e3), "" if peer == OURS else relative(ratio(case, peer)),
            ])  # fmt: skip
            shapes.append([
                f"{kind}, {short(n)}", peer, f"{row['min_angle']:.1f}°", f"{row['percentile']:.1f}°",
                f"{100 * row['below_30']:.2g} %", f"{row['deviation']:.4f}", f"{row['corners']:.2g}",
                f"{row['creases']:.2g}", "yes" if row["topology"] else "no", str(row["crossings"]),
            ])  # fmt: skip
    return grid(head, 1, speeds) + "\n\n" + grid(other, 2, shapes)


def intrinsic(rows: list[Row]) -> str:
    """A line for each mesh and size; **bold** if libigl is faster."""
    head = ["surface", "triangles", "flips", "seconds", "of them flips", "million flips/s"]
    head += ["libigl, seconds", f"{OURS} ÷ it"]
    lines = []
    for (name, kind, _), case in times(rows).items():
        if name != "intrinsic" or OURS not in case:
            continue
        row, peer = case[OURS], case.get("libigl")
        lines.append([
            kind, str(row["cells"]), str(row["flips"]), figures(row["seconds"]),
            figures(row["flip_seconds"]), figures(row["flips"] / max(row["flip_seconds"], 1e-9) / 1e6),
            "–" if peer is None else figures(peer["seconds"]),
            "–" if peer is None else relative(ratio(case, "libigl")),
        ])  # fmt: skip
    return grid(head, 1, lines)


def summary(rows: list[Row]) -> str:
    """A line for each case: our triangles per second by those of the peers, and the least angle."""
    lines = []
    for (name, kind, n), case in times(rows).items():
        if OURS not in case:
            continue
        peers = [f"{peer} {relative(ratio(case, peer))}" for peer in PEERS if peer in case]
        ours = case[OURS]
        angle = f"{ours['min_angle']:.1f}°" if "min_angle" in ours else "–"
        lines.append([name, kind, short(n), ", ".join(peers) or "–", figures(speed(ours) / 1e3), angle])
    head = ["work", "surface", "n", "compared with others", "1000 triangles/s", "least angle"]
    return grid(head, 3, lines)


# work -> its title and its table
TABLES: dict[str, tuple[str, Callable[[list[Row]], str]]] = {
    "remeshing": ("Surfaces remeshed to a size", remeshing),
    "intrinsic": ("Intrinsic Delaunay flips", intrinsic),
}


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    return page(result, {title: table(rows) for work, (title, table) in TABLES.items() if work in done})


def plot(rows: list[Row]) -> None:
    """There is no picture: the tables have it all."""
