"""A picture for reports: meshes as marks in panels, time against quality, with a mark for each contestant."""

from __future__ import annotations

from typing import Any

MARKED_AS = ("circumcircle", "inserted", "voronoi", "front", "cavity", "layer")  # roles

Marks = dict[str, list[tuple[float, float]]]

__all__ = ["Marks", "scatter"]


def scatter(panels: dict[str, tuple[str, Marks]], across: str) -> Any:
    """A figure of panels side by side, with one legend.

    Parameters
    ----------
    panels : dict of str to (str, dict of str to list of pairs)
        By title the label of the vertical axis, and the marks (x, y) of each contestant; x is logarithmic.
    across : str
        The label of the horizontal axes.
    """
    import matplotlib.pyplot as plt

    from unstruct.view import setup
    from unstruct.view.draw.colors import role

    setup()
    names = list(dict.fromkeys(name for _, marks in panels.values() for name in marks))
    styles = dict(zip(names, map(role, MARKED_AS)))
    figure, axes = plt.subplots(1, len(panels), figsize=(8, 3.6), squeeze=False)
    lines = {}
    for ax, (title, (up, marks)) in zip(axes[0], panels.items()):
        for name, found in marks.items():
            style = styles[name]
            size = 0.8 * style.size
            (lines[name],) = ax.plot(
                *zip(*found), style.marker, color=style.color, markersize=size, alpha=0.8, label=name
            )
        ax.set_xscale("log")
        ax.set_title(title, fontsize=9)
        ax.set_xlabel(across)
        ax.set_ylabel(up)
    figure.legend([lines[name] for name in names], names, loc="outside lower center", ncol=3, fontsize=9)
    return figure
