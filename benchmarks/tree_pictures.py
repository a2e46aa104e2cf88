"""Pictures for the report of the suite ``tree``."""

from __future__ import annotations

from typing import Any

import numpy as np

from .planar_report import DASHES
from .scatter import Marks, scatter

Series = dict[str, list[tuple[float, float]]]
SPEEDS = (0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10)
TICKS = (50, 100, 200, 500, 1000)
COLORED_AS = ("circumcircle", "inserted", "voronoi", "front")  # roles

__all__ = ["growth_and_angles", "marks"]


def marks(panels: dict[str, tuple[str, Marks]]) -> Any:
    """Speeds against least angles."""
    figure = scatter(panels, "million cells per second")
    for ax in figure.axes:
        low, high = ax.get_xlim()
        ticks = [tick for tick in SPEEDS if low <= tick <= high]
        ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        ax.minorticks_off()
    return figure


def growth_and_angles(series: Series, counts: dict[str, Any], bounds: tuple[float, float]) -> Any:
    """Nanoseconds a leaf by the number of leaves, and histograms of dihedral angles beside their bounds."""
    import matplotlib.pyplot as plt

    from unstruct.view import setup
    from unstruct.view.draw.colors import role

    setup()
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.1))
    for name, color, dash in zip(series, COLORED_AS, DASHES):
        style = role(color)
        line = {"color": style.color, "linestyle": dash, "marker": style.marker, "markersize": 5}
        left.loglog(*zip(*series[name]), label=name, **line)
    left.set_xlabel("leaves")
    left.set_ylabel("nanoseconds a leaf")
    left.set_yticks(TICKS, [str(tick) for tick in TICKS])
    left.minorticks_off()
    for (name, found), color, dash in zip(counts.items(), COLORED_AS, DASHES):
        edges = np.linspace(0.0, 180.0, len(found) + 1)
        share = 100 * np.asarray(found) / np.sum(found)
        right.stairs(share, edges, color=role(color).color, linestyle=dash, label=name)
    for bound in bounds:
        right.axvline(bound, color=role("edge").color, linewidth=1.0)
    right.set_xticks(range(0, 181, 30))
    right.set_xlabel("dihedral angle in degrees")
    right.set_ylabel("% of all dihedral angles")
    right.set_yscale("log")
    for ax in (left, right):
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=7)
    return figure
