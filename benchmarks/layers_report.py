"""The report of the suite ``layers``: a table for each work."""

from __future__ import annotations

from typing import Any

from .planar_report import ratio, speed, times
from .report import OURS, figures, grid, page, relative
from .scatter import Marks, scatter

Row = dict[str, Any]
TITLES = {
    "layers": "Layers along a wing and its flap",
    "stretched": "Cells ten times as long as wide, in a direction that turns",
}


def table(rows: list[Row], work: str) -> str:
    """A line for each case and contestant; **bold** if a peer makes more triangles per second."""
    layers = work == "layers"
    head = ["spacing", "first height"] if layers else ["metric"]
    head += ["by", "triangles", "seconds", "1000 triangles/s", f"{OURS} ÷ it", "largest angle"]
    head += ["least angle beyond", "mean 2r/R beyond", "99 % of area ratios below"] if layers else []
    head += [] if layers else ["metric edges within √2", "mean metric quality", "valid"]
    lines = []
    for (name, kind, _), case in times(rows).items():
        if name != work or OURS not in case:
            continue
        for peer, row in case.items():
            cells = kind.split() if layers else [kind]
            cells += [peer, str(row["cells"]), figures(row["seconds"]), figures(speed(row) / 1e3)]
            cells += [
                "" if peer.startswith(OURS) else relative(ratio(case, peer)),
                f"{row['max_angle']:.0f}°",
            ]
            if layers:
                cells += [f"{row['min_angle']:.1f}°", f"{row['mean_2r_R']:.3f}", f"{row['area_ratio']:.2f}"]
            else:
                close = f"{100 * row['conforming']:.2f} %"
                cells += [close, f"{row['mean_metric']:.4f}", "yes" if row["valid"] else "no"]
            lines.append(cells)
    return grid(head, 3 if layers else 2, lines)


def _layered(rows: list[Row]) -> dict[str, dict[str, Row]]:
    """The cases with layers, by spacing and first height."""
    return {kind: case for (work, kind, _), case in times(rows).items() if work == "layers" and OURS in case}


def speeds(rows: list[Row]) -> str:
    """A line for each case with layers: seconds, and our triangles per second by those of others."""
    cases = _layered(rows)
    names = list(dict.fromkeys(name for case in cases.values() for name in case))
    peers = [name for name in names if not name.startswith(OURS)]
    head = ["spacing", "first height", "our triangles", *(f"{name}, seconds" for name in names)]
    lines = []
    for kind, case in cases.items():
        cells = [*kind.split(), str(case[OURS]["cells"])]
        cells += [figures(case[name]["seconds"]) if name in case else "–" for name in names]
        lines.append([*cells, *(relative(ratio(case, peer)) if peer in case else "–" for peer in peers)])
    return grid([*head, *(["our triangles/s ÷ theirs"] * len(peers))], 2, lines)


def qualities(rows: list[Row]) -> str:
    """A line for each case with layers: each measure for all contestants, in the order of `speeds`."""
    measures = {
        "largest angle": ("max_angle", "{:.0f}°"), "least angle beyond": ("min_angle", "{:.1f}°"),
        "mean 2r/R beyond": ("mean_2r_R", "{:.3f}"), "99 % of area ratios below": ("area_ratio", "{:.2f}"),
    }  # fmt: skip
    lines = []
    for kind, case in _layered(rows).items():
        found = [
            " · ".join(text.format(row[key]) for row in case.values()) for key, text in measures.values()
        ]
        lines.append([*kind.split(), *found])
    return grid(["spacing", "first height", *measures], 2, lines)


def marks(rows: list[Row]) -> Any:
    """The seconds and the worst angles of each mesh with layers, as a picture."""
    panels: dict[str, tuple[str, Marks]] = {
        "The largest angle": ("degrees", {}), "The least angle beyond the layers": ("degrees", {}),
    }  # fmt: skip
    for case in _layered(rows).values():
        for (_, found), measure in zip(panels.values(), ("max_angle", "min_angle")):
            for name, row in case.items():
                found.setdefault(name, []).append((row["seconds"], row[measure]))
    return scatter(panels, "seconds")


def markdown(result: dict[str, Any]) -> str:
    """The report of the suite."""
    rows = result["rows"]
    done = {row["work"] for row in rows}
    return page(result, {title: table(rows, work) for work, title in TITLES.items() if work in done})


def plot(rows: list[Row]) -> None:
    """There is no picture: the tables have it all."""
