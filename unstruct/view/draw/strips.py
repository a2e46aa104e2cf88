"""Frames drawn by matplotlib: as one picture, or as a static strip of a whole history."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from ...base.errors import InputError
from . import frames as fr
from .colors import PAPER, ROLES, line_style, role

__all__ = ["axes_for", "draw", "draw_items", "fit", "flat_axes", "label", "marks", "strip"]

CIRCLE = 0.06  # the largest opacity inside circles, because they overlap
HALO = [patheffects.Stroke(linewidth=2.2, foreground=PAPER)]


def draw_items(ax: Axes, items: Iterable[fr.Item]) -> None:
    """Draw the items of a frame into existing axes, from back to front."""
    for z, item in enumerate(items, start=2):
        style, opacity, data = role(item["role"]), item.get("opacity", 1.0), item["data"]
        if not data:
            continue
        if item["kind"] == "points":
            marks(ax, np.asarray(data), item["role"], z, opacity)
        elif item["kind"] == "labels":
            for place, text in zip(data, item["text"]):
                label(ax, place, text, style.ink, opacity, z + 30)
        elif item["kind"] == "segments":
            ax.add_collection(LineCollection(data, zorder=z, alpha=opacity, **line_style(item["role"])))
        else:
            _shapes(ax, item, z)


def marks(
    ax: Axes, points: np.ndarray, name: str, z: float, opacity: float = 1.0, scale: float = 1.0
) -> None:
    """The markers of a role, with a thin edge of background color that separates them from lines below."""
    style = role(name)
    ax.plot(
        *points.T,
        linestyle="none",
        marker=style.marker,
        markersize=scale * style.size,
        color=style.color,
        markeredgecolor=PAPER,
        markeredgewidth=0.4,
        alpha=opacity,
        zorder=z,
    )


def label(ax: Axes, place: Sequence[float], text: str, color: str, opacity: float, z: float) -> None:
    """A short text beside a point, drawn over a halo; a stroke of the text itself would hide thin bars."""
    for effects in (HALO, None):
        ax.annotate(
            text,
            (place[0], place[1]),
            xytext=(4, 4),
            textcoords="offset points",
            fontsize=8.5,
            color=color,
            alpha=opacity,
            zorder=z,
            path_effects=effects,
            annotation_clip=True,
        )


def _shapes(ax: Axes, item: fr.Item, z: int) -> None:
    """Polygons or circles, with a fill and an outline in the line style of the role."""
    style, opacity, data = role(item["role"]), item.get("opacity", 1.0), item["data"]
    line = line_style(item["role"])
    veil = style.alpha if item["kind"] == "polygons" else min(style.alpha, CIRCLE)
    look = {
        "facecolors": [to_rgba(style.fill, veil * opacity)],
        "linewidths": line["linewidth"],
        "edgecolors": [to_rgba(style.color, opacity)],
        "linestyles": [line["linestyle"]],
        "zorder": z,
    }
    if item["kind"] == "polygons":
        hatch = 3 * style.hatch if style.hatch != "." else "..."
        shared = style.dash and len(data) > 1  # on a common side, dashes of two outlines would fill the gaps
        if shared:
            edges = LineCollection(fr.outline(data), zorder=z, alpha=opacity, **line)
            look["linewidths"] = 0.0
        ax.add_collection(PolyCollection([np.asarray(p) for p in data], hatch=hatch or None, **look))
        if shared:
            ax.add_collection(edges)
    else:
        x0, x1, y0, y1 = *ax.get_xlim(), *ax.get_ylim()
        huge = [row for row in data if row[2] > 6 * (abs(x1 - x0) + abs(y1 - y0))]
        arcs = [fr.arc(row, (x0, x1, y0, y1)) for row in huge]
        if arcs:
            ax.add_collection(LineCollection(arcs, zorder=z, alpha=opacity, **line))
        x, y, r = np.reshape([row for row in data if row not in huge], (-1, 3)).T
        ax.add_collection(
            EllipseCollection(
                2 * r,
                2 * r,
                np.zeros_like(r),
                units="xy",
                transOffset=ax.transData,
                offsets=np.column_stack([x, y]),
                **look,
            )
        )


def draw(frame: fr.Frame, ax: Axes | None = None, *, view: Sequence[float] | None = None) -> Axes:
    """Draw one frame, without its caption.

    Parameters
    ----------
    frame : dict
        See `unstruct.view.draw.frames`.
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    view : (xmin, xmax, ymin, ymax), optional
        The window; by default that of the frame, or all of its items.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = flat_axes(ax)
    x0, x1, y0, y1 = fr.bounds([frame]) if view is None else view
    ax.set(xlim=(x0, x1), ylim=(y0, y1))
    draw_items(ax, frame["items"])
    return ax


def strip(
    frames: Sequence[fr.Frame],
    columns: int | None = None,
    *,
    width: float = 8.0,
    view: Sequence[float] | None = None,
) -> Figure:
    """A static strip of frames: the pictures of a player, for paper and for pages without widgets.

    Parameters
    ----------
    frames : sequence of dict
        The history, with one change per frame.
    columns : int, optional
        The number of pictures side by side; by default at most four.
    width : float
        Width of the figure in inches.
    view : (xmin, xmax, ymin, ymax), optional
        The window of all pictures; by default it contains the items of all frames.

    Returns
    -------
    matplotlib.figure.Figure
    """
    if not frames:
        raise InputError("a strip needs at least one frame")
    columns = min(len(frames), 4) if columns is None else columns
    rows = -(-len(frames) // columns)
    x0, x1, y0, y1 = fr.bounds(frames) if view is None else view
    panel = width / columns
    letters = max(12, int(panel * 72 / 5.3))  # how many letters of 8.5 points fit above one picture
    titles = [textwrap.fill(f"{k}  {f['caption']}", letters) for k, f in enumerate(frames, start=1)]
    numbers = [textwrap.fill(f["number"], letters) for f in frames]
    text = 0.17 * sum(max(t.count("\n") + bool(t) for t in texts) for texts in (titles, numbers))
    size = (width, rows * (panel * (y1 - y0) / (x1 - x0) + text))
    figure, axes = plt.subplots(rows, columns, squeeze=False, figsize=size, layout="constrained")
    for ax in axes.flat[len(frames) :]:
        ax.set_axis_off()
    for ax, one, title, number in zip(axes.flat, frames, titles, numbers):
        draw(one, ax, view=(x0, x1, y0, y1))
        ax.set_axis_on()
        ax.set(xticks=[], yticks=[])
        ax.spines[:].set(visible=True, color=ROLES["muted"].color, linewidth=0.6)
        ax.set_title(title, fontsize=8.5, loc="left", pad=3)
        ax.set_xlabel(number, fontsize=8.5, labelpad=2)
    return figure


def axes_for(ax: Any, size: tuple[float, float]) -> Axes:
    """The axes that are given, or those of a new figure of this size in inches."""
    if ax is None:
        return plt.subplots(figsize=size)[1]
    if not isinstance(ax, Axes):
        raise InputError(f"ax must be matplotlib axes, such as plt.subplots()[1], not {type(ax).__name__}")
    return ax


def flat_axes(ax: Axes | None) -> Axes:
    """Axes for geometry, with equal scales and without ticks, because coordinates do not matter."""
    ax = axes_for(ax, (4.6, 3.6))
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax


def fit(ax: Axes, points: np.ndarray, margin: float = 0.05) -> None:
    """Make the axes show all points, with a margin relative to the larger side."""
    if len(points) == 0:
        return
    low, high = points.min(axis=0), points.max(axis=0)
    pad = margin * max(float((high - low).max()), 1e-300)
    ax.set(xlim=(low[0] - pad, high[0] + pad), ylim=(low[1] - pad, high[1] + pad))
