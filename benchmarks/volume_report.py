"""The report of the suite ``volume``: a table for each work, and histograms of dihedral angles."""

from __future__ import annotations

from typing import Any

import numpy as np

from .planar_report import DASHES, ratio, speed, times
from .report import OURS, figures, grid, page, relative
from .scatter import Marks, scatter

Row = dict[str, Any]
TITLES = {
    "good": "Bodies with even surfaces, one size",
    "parts": "Machine parts, one size",
    "graded": "Sizes that vary",
    "bare": "Even surfaces, without a size",
    "CAD": "Booleans of boxes, cylinders and balls, without a size",
}
SIZED = {"good": "even", "parts": "machine parts", "graded": "varying size"}  # and short names


def table(rows: list[Row], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer is faster, by cells per second.

    Without a size the times are compared: then more cells are no gain.
    """
    sized = work in SIZED
    head = ["body", "by", "cells", "seconds", "1000 cells/s", f"{OURS} ÷ it"]
    head += ["least dihedral", "below 20°", "mean 3r/R"] if sized else ["least dihedral"]
    head += ["new on the surface", "given triangles kept"]
    lines = []
    for (name, kind, _), case in times(rows).items():
        if name != work or OURS not in case:
            continue
        for peer, row in case.items():
            other = ratio(case, peer) if sized else row["seconds"] / case[OURS]["seconds"]
            cells = [kind, peer, str(row["cells"]), figures(row["seconds"]), figures(speed(row) / 1e3)]
            cells += ["" if peer.startswith(OURS) else relative(other), f"{row['min_dihedral']:.1f}°"]
            if sized:
                cells += [f"{100 * row['sharp']:.3f} %", f"{row['mean_3r_R']:.3f}"]
            kept = "yes" if row["exact"] else "divided" if row["valid"] else "no"
            lines.append([*cells, str(row["steiner"]), kept])
    return grid(head, 2, lines)


def summary(rows: list[Row]) -> str:
    """A line for each work with a size: medians and worst of ours, and our speed by that of the peers."""
    lines = []
    for work in SIZED:
        cases = [case for (name, _, _), case in times(rows).items() if name == work and OURS in case]
        if not cases:
            continue
        ours = [case[OURS] for case in cases]
        peers = list(dict.fromkeys(name for case in cases for name in case if name != OURS))
        compared = [f"{name} {relative(float(np.median([ratio(c, name) for c in cases if name in c])))}"
                    for name in peers]  # fmt: skip
        least = [row["min_dihedral"] for row in ours]
        lines.append([TITLES[work], str(len(cases)), ", ".join(compared),
                      figures(float(np.median([speed(row) for row in ours])) / 1e3),
                      f"{np.median(least):.1f}°", f"{min(least):.1f}°",
                      f"{min(row['mean_3r_R'] for row in ours):.3f}"])  # fmt: skip
    head = ["work", "bodies", "median speed compared with others", "1000 cells/s", "least dihedral, median",
            "worst", "mean 3r/R, worst"]  # fmt: skip
    return grid(head, 1, lines)


def _others(cases: list[dict[str, Row]]) -> list[str]:
    """All contestants but ours, in the order of the rows."""
    return list(dict.fromkeys(name for case in cases for name in case if name != OURS))


def compared(rows: list[Row]) -> str:
    """A line for each work with a size and each contestant: medians over the bodies, and worst angles."""
    head = ["bodies", "by", "cells ÷ ours", "seconds ÷ ours", "our cells/s ÷ theirs",
            "least dihedral, median", "worst", "cells below 20°"]  # fmt: skip
    lines = []
    for work in SIZED:
        cases = [case for (name, _, _), case in times(rows).items() if name == work and OURS in case]
        for name in [OURS, *_others(cases)] if cases else []:
            both = [case for case in cases if name in case]
            cells, seconds = (
                float(np.median([c[name][key] / c[OURS][key] for c in both])) for key in ("cells", "seconds")
            )
            least = [case[name]["min_dihedral"] for case in both]
            compared_ = ["", "", ""]
            if name != OURS:
                speeds = float(np.median([ratio(case, name) for case in both]))
                compared_ = [f"{cells:.2f}", relative(seconds), relative(speeds)]
            sharp = 100 * float(np.median([case[name]["sharp"] for case in both]))
            lines.append([SIZED[work], name, *compared_, f"{np.median(least):.1f}°", f"{min(least):.1f}°",
                          f"{sharp:.2f} %"])  # fmt: skip
    return grid(head, 2, lines)


def by_body(rows: list[Row], work: str) -> str:
    """A line for each body: our cells, seconds and least angle; of others seconds by ours, and that angle."""
    cases = {kind: case for (name, kind, _), case in times(rows).items() if name == work and OURS in case}
    others = _others(list(cases.values()))
    lines = []
    for kind, case in cases.items():
        ours = case[OURS]
        cells = [kind, str(ours["cells"]), f"{figures(ours['seconds'])} s, {ours['min_dihedral']:.1f}°"]
        for name in others:
            row = case.get(name)
            part = "–" if row is None else relative(row["seconds"] / ours["seconds"])
            cells.append(part if row is None else f"{part}, {row['min_dihedral']:.1f}°")
        lines.append(cells)
    return grid(["body", "our cells", OURS, *others], 1, lines)


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    sections = {"Summary": summary(rows)} if done & set(SIZED) else {}
    return page(
        result, sections | {title: table(rows, work) for work, title in TITLES.items() if work in done}
    )


def marks(rows: list[Row]) -> Any:
    """The seconds and the least dihedral angle of each mesh of the works with a size, as a picture."""
    panels: dict[str, tuple[str, Marks]] = {}
    for (work, _, _), case in times(rows).items():
        if work in SIZED and OURS in case:
            found = panels.setdefault(TITLES[work], ("least dihedral angle in degrees", {}))[1]
            for name, row in case.items():
                found.setdefault(name, []).append((row["seconds"], row["min_dihedral"]))
    return scatter(panels, "seconds")


def plot(rows: list[Row]) -> Any:
    """Histograms of all dihedral angles of the first case of each work with a size; None without one."""
    import matplotlib.pyplot as plt

    from unstruct.view import setup
    from unstruct.view.draw.colors import role

    firsts = {}
    for (work, kind, _), case in times(rows).items():
        if work in SIZED and OURS in case:
            firsts.setdefault(work, (kind, case))
    if not firsts:
        return None
    setup()
    roles = ["circumcircle", "inserted", "voronoi", "front"]
    figure, axes = plt.subplots(1, len(firsts), figsize=(8, 2.9), squeeze=False)
    for ax, (work, (kind, case)) in zip(axes[0], firsts.items()):
        for style, dash, name in zip(map(role, roles), DASHES, case):
            counts = np.array(case[name]["angles"], dtype=float)
            edges = np.linspace(0.0, 180.0, len(counts) + 1)
            ax.stairs(100 * counts / counts.sum(), edges, color=style.color, linestyle=dash, label=name)
        ax.set_ylim(0, 1.4 * ax.get_ylim()[1])
        ax.set_title(f"{work}: {kind}", fontsize=10)
        ax.set_xticks(range(0, 181, 45))
        ax.set_xlabel("dihedral angle in degrees")
        ax.legend(fontsize=6)
    axes[0, 0].set_ylabel("% of all dihedral angles")
    return figure
