"""The report of the suite ``surface``: a table for each work."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative

Row = dict[str, Any]
__all__ = ["TABLES", "markdown", "plot", "remeshing"]


def remeshing(rows: list[Row]) -> str:
    """A line for each surface and contestant; **bold** if a peer makes more triangles per second."""
    head = ["surface", "given triangles", "by", "triangles", "seconds", "1000 triangles/s", f"{OURS} ÷ it"]
    head += ["least angle", "0.1 % below", "below 30°", "deviation ÷ size", "corner off ÷ size"]
    head += ["crease off ÷ size", "topology kept", "crossings"]
    lines = []
    for (name, kind, _), case in times(rows).items():
        if name != "remeshing" or OURS not in case:
            continue
        for peer, row in case.items():
            lines.append([
                kind, str(row["given"]), peer, str(row["cells"]), figures(row["seconds"]),
                figures(speed(row) / 1e3), "" if peer == OURS else relative(ratio(case, peer)),
                f"{row['min_angle']:.1f}°", f"{row['percentile']:.1f}°", f"{100 * row['below_30']:.2g} %",
                f"{row['deviation']:.4f}", f"{row['corners']:.2g}", f"{row['creases']:.2g}",
                "yes" if row["topology"] else "no", str(row["crossings"]),
            ])  # fmt: skip
    return grid(head, 1, lines)


# work -> its title and its table
TABLES: dict[str, tuple[str, Callable[[list[Row]], str]]] = {
    "remeshing": ("Surfaces remeshed to a size", remeshing),
}


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    return page(result, {title: table(rows) for work, (title, table) in TABLES.items() if work in done})


def plot(rows: list[Row]) -> None:
    """There is no picture: the tables have it all."""
