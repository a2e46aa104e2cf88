"""The report of the planar suite: one table for each work, and histograms of angles side by side."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import report
from .report import OURS, figures, grid, page, relative, short

Row = dict[str, Any]
Case = tuple[str, str, int]
TITLES = {
    "constrained": "Constrained Delaunay triangulation",
    "refined": "Refinement: angles of at least 30°, and a maximum area",
    "uniform": "A wanted edge length, the same everywhere",
    "graded": "A wanted edge length that grows from the hole",
}
RAW = f"{OURS}, unfinished"
DASHES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))


def times(rows: list[Row]) -> dict[Case, dict[str, Row]]:
    """Rows by (work, kind, n), then by contestant."""
    return report.times(rows, "work")


def speed(row: Row) -> float:
    """Triangles per second."""
    return row["cells"] / row["seconds"]


def ratio(case: dict[str, Row], peer: str) -> float:
    """Our triangles per second divided by those of the peer; below 1 the peer is faster."""
    return speed(case[OURS]) / speed(case[peer])


def table(rows: list[Row], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer is faster than unstruct."""
    quality = work != "constrained"
    sized = work in ("uniform", "graded")
    head = ["input", "n", "by", "triangles", "1000 triangles/s", f"{OURS} ÷ it"]
    head += ["minimum angle", "mean 2r/R", "minimum 2r/R"] if quality else []
    head += ["edges within √2"] if sized else []
    lines = []
    for (name, kind, n), case in times(rows).items():
        if name != work or OURS not in case:
            continue
        for peer, row in case.items():
            cells = [kind, short(n), peer, str(row["cells"]), figures(speed(row) / 1e3)]
            cells.append("" if peer in (OURS, RAW) else relative(ratio(case, peer)))
            if quality:
                cells += [f"{row['min_angle']:.1f}°", f"{row['mean_2r_R']:.4f}", f"{row['min_2r_R']:.2f}"]
            if sized:
                cells.append(f"{100 * row['conforming']:.1f} %")
            lines.append(cells)
    return grid(head, 3, lines)


def summary(rows: list[Row]) -> str:
    """A line for each case: our speed, its ratio to that of each peer, and the quality of our mesh."""
    cases = {key: case for key, case in times(rows).items() if OURS in case}
    head = ["work", "input", "n", "compared with others", "1000 triangles/s", "minimum angle", "mean 2r/R"]
    lines = []
    for (work, kind, n), case in cases.items():
        peers = [f"{name} {relative(ratio(case, name))}" for name in case if name not in (OURS, RAW)]
        ours = case[OURS]
        cells = [work, kind, short(n), ", ".join(peers), figures(speed(ours) / 1e3)]
        sized = work != "constrained"
        cells += [f"{ours['min_angle']:.1f}°", f"{ours['mean_2r_R']:.4f}"] if sized else ["", ""]
        lines.append(cells)
    return grid(head, 4, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite ``planar``."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    return page(result, {title: table(rows, work) for work, title in TITLES.items() if work in done})


def histograms(cases: dict[Case, dict[str, Row]], shown: list[tuple[Case, list[str]]]) -> Any:
    """Histograms of all angles of the meshes of some contestants, one panel for each case."""
    import matplotlib.pyplot as plt

    from unstruct.view import setup
    from unstruct.view.draw.colors import role

    setup()
    roles = ["circumcircle", "inserted", "voronoi", "front"]
    figure, axes = plt.subplots(1, len(shown), figsize=(8, 2.9), squeeze=False)
    for ax, (key, names) in zip(axes[0], shown):
        for style, dash, width, name in zip(map(role, roles), DASHES, (2.4, 1.6, 1.6, 1.2), names):
            counts = np.array(cases[key][name]["angles"], dtype=float)
            edges = np.linspace(0.0, 180.0, len(counts) + 1)
            ax.stairs(
                100 * counts / counts.sum(),
                edges,
                color=style.color,
                linestyle=dash,
                linewidth=width,
                label=name,
            )
        ax.set_ylim(0, 1.3 * ax.get_ylim()[1])
        ax.set_title(f"{key[0]}, {short(key[2])} triangles", fontsize=10)
        ax.set_xlim(0, 130)
        ax.set_xticks(range(0, 121, 30))
        ax.set_xlabel("angle in degrees")
        ax.legend(fontsize=7)
    axes[0, 0].set_ylabel("% of all angles")
    return figure


def plot(rows: list[Row]) -> Any:
    """Histograms for the largest case of each work that has them; None if no such case was run."""
    cases = times(rows)
    shown = []
    for work in ("refined", "uniform", "graded"):
        keys = [key for key in cases if key[0] == work]
        if keys:
            shown.append((keys[-1], list(cases[keys[-1]])[:4]))
    return histograms(cases, shown) if shown else None
