"""Reports made from rows: ratios, exponents of growth, Markdown tables, a plot."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

OURS = "unstruct"
Row = dict[str, Any]
RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def times(rows: list[Row], first: str = "dimension") -> dict[tuple[Any, str, int], dict[str, Row]]:
    """Rows of times by case (the value of ``first``, kind, n), then by contestant."""
    cases: dict[tuple[Any, str, int], dict[str, Row]] = {}
    for row in rows:
        if row["measure"] == "time":
            cases.setdefault((row[first], row["kind"], row["n"]), {})[row["contestant"]] = row
    return cases


def ratio(case: dict[str, Row], peer: str) -> float:
    """The time of the peer divided by ours; below 1 the peer is faster."""
    return case[peer]["seconds"] / case[OURS]["seconds"]


def growth(rows: list[Row]) -> dict[tuple[int, str, str], float]:
    """Exponents p of seconds ~ n^p by dimension, kind and contestant, if there are at least two sizes."""
    series: dict[tuple[int, str, str], list[tuple[int, float]]] = {}
    for (d, kind, n), case in times(rows).items():
        for name, row in case.items():
            series.setdefault((d, kind, name), []).append((n, row["seconds"]))
    return {
        key: float(np.polyfit(np.log([n for n, _ in s]), np.log([t for _, t in s]), 1)[0])
        for key, s in series.items()
        if len({n for n, _ in s}) > 1
    }


def short(n: int) -> str:
    """A count with two digits: 10⁴, 9.7·10⁴."""
    rounded = float(f"{n:.2g}")
    power = math.floor(math.log10(rounded) + 1e-9)
    lead = f"{rounded / 10**power:.2g}"
    text = "10" + str(power).translate(RAISED)
    return text if lead == "1" else f"{lead}·{text}"


def figures(value: float) -> str:
    """A number with three digits and without an exponent."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def relative(value: float) -> str:
    """A ratio in a table, with two decimals below 10, and **bold** below 1, where a peer is faster."""
    text = f"{value:.2f}" if value < 10 else f"{value:.0f}"
    return f"**{text}**" if value < 1 else text


def grid(head: list[str], left: int, lines: list[list[str]]) -> str:
    """A Markdown table; the first ``left`` columns are aligned to the left, the others to the right."""
    rule = "|---" * left + "|---:" * (len(head) - left) + "|"
    first, *rest = ("| " + " | ".join(cells) + " |" for cells in [head, *lines])
    return "\n".join([first, rule, *rest])


def table(rows: list[Row], dimension: int) -> str:
    """Microseconds per point, and the ratio of each peer's time to ours, **bold** if the peer is faster."""
    cases = {key: case for key, case in times(rows).items() if key[0] == dimension and OURS in case}
    peers = sorted({name for case in cases.values() for name in case} - {OURS}, key=str.lower)
    head = ["points", "n", f"{OURS} µs/point", *(f"{peer} ÷ {OURS}" for peer in peers)]
    lines = []
    for (_, kind, n), case in cases.items():
        cells = [kind, short(n), figures(case[OURS]["seconds"] / n * 1e6)]
        for peer in peers:
            if peer not in case:
                cells.append("–")
                continue
            text = relative(ratio(case, peer))
            inner = case[peer].get("inner") or []
            if inner:
                bare = float(np.median(inner)) / case[OURS]["seconds"]
                text += f" (itself **{bare:.2f}**)" if bare < 1 else f" (itself {bare:.2f})"
            cells.append(text)
        lines.append(cells)
    return grid(head, 2, lines)


def growth_table(rows: list[Row]) -> str:
    """The fitted exponents, one line for each dimension and kind."""
    found = growth(rows)
    names = sorted({name for _, _, name in found}, key=lambda name: (name != OURS, name.lower()))
    lines = []
    for d, kind in dict.fromkeys((d, kind) for d, kind, _ in found):
        cells = [f"{found[d, kind, name]:.2f}" if (d, kind, name) in found else "–" for name in names]
        lines.append([str(d), kind, *cells])
    return grid(["dimension", "points", *names], 2, lines)


def other_table(rows: list[Row]) -> str:
    """Peak memory and the time to start."""
    lines = ["| what | |", "|---|---:|"]
    for row in rows:
        if row["measure"] == "memory":
            what = f"peak memory, {row['dimension']}D, {short(row['n'])} uniform points, {row['contestant']}"
            lines.append(f"| {what} | {row['megabytes']:.0f} MB |")
        if row["measure"] == "start":
            lines.append(f"| {START[row['what']]} | {row['seconds'] * 1e3:.0f} ms |")
    return "\n".join(lines)


START = {
    "numba": "`import numba` by itself",
    "import": "`import unstruct`, numba included",
    "first 2D": "first call in 2D, 100 points, kernels cached on disk",
    "then 3D": "then the first call in 3D",
}


def page(result: dict[str, Any], sections: dict[str, str]) -> str:
    """The whole report of a run: the machine and the versions, the sections, and the failed cases."""
    again = "".join(
        f"; measured again, {work}, with {before} and {after}"
        for work, (before, after) in result.get("again", {}).items()
    )
    parts = [
        f"# Benchmarks: {result['suite']}",
        f"{result['machine']}. One core; medians of CPU seconds, contestants interleaved; load average "
        f"{result['load'][0]} before and {result['load'][1]} after{again}. Versions: "
        + ", ".join(f"{name} {number}" for name, number in result["versions"].items())
        + ".",
    ]
    for title, text in sections.items():
        parts += [f"## {title}", text]
    if result["failures"]:
        parts += ["## Failures", "\n".join(f"- {text}" for text in result["failures"])]
    return "\n\n".join(parts) + "\n"


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite ``delaunay``."""
    rows = result["rows"]
    dimensions = sorted({row["dimension"] for row in rows if row["measure"] == "time"})
    sections = {f"{d} dimensions": table(rows, d) for d in dimensions}
    sections["Growth: exponents p of seconds ~ n^p"] = growth_table(rows)
    sections["Memory and start"] = other_table(rows)
    return page(result, sections)


def plot(rows: list[Row]) -> Any:
    """Ratios against n, one panel for each dimension and peer; above the line at 1 the peer takes longer.

    None if no peer was run.
    """
    import matplotlib.pyplot as plt

    from unstruct.view import setup
    from unstruct.view.draw.colors import role

    setup()
    roles = {"uniform": "circumcircle", "clustered": "voronoi", "lattice": "inserted"}
    cases = {key: case for key, case in times(rows).items() if key[0] in (2, 3) and OURS in case}
    panels = sorted({(key[0], name) for key, case in cases.items() for name in case if name != OURS})
    if not panels:
        return None
    figure, axes = plt.subplots(1, len(panels), figsize=(8, 3.1), sharey=True, squeeze=False)
    for ax, (d, peer) in zip(axes[0], panels):
        for kind in dict.fromkeys(key[1] for key in cases if key[0] == d):
            line = [
                (n, ratio(case, peer))
                for (e, k, n), case in cases.items()
                if (e, k) == (d, kind) and peer in case
            ]
            style = role(roles.get(kind, "front"))
            ax.loglog(*zip(*line), color=style.color, marker=style.marker, label=kind)
        ax.axhline(1.0, color=role("edge").color, linewidth=1.0)
        ax.set_title(f"{d}D: {peer}", fontsize=10)
        ax.set_xlabel("points")
        ax.legend(fontsize=7)
    axes[0, 0].set_ylabel(f"time of the peer ÷ {OURS}")
    return figure


def write(result: dict[str, Any], folder: Path, reporter: Any) -> list[Path]:
    """Write the rows as JSON and CSV, and the Markdown report and plot by ``reporter``; return the paths.

    There is no plot if the run was too small for one.
    """
    import matplotlib.pyplot as plt

    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{result['suite']}.{ending}" for ending in ("json", "csv", "md", "png")]
    paths[0].write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    names = list(dict.fromkeys(key for row in result["rows"] for key in row))
    with paths[1].open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(result["rows"])
    paths[2].write_text(reporter.markdown(result), encoding="utf-8")
    figure = reporter.plot(result["rows"])
    if figure is None:
        return paths[:3]
    figure.savefig(paths[3], dpi=90)
    plt.close(figure)
    return paths
