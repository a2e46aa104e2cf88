"""Widgets of constrained triangulation: insertion of a segment; the principal component of a point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..draw import frames as fr
from ..scenes.constraints import (
    COMPONENTS,
    SEGMENT_EXAMPLES,
    principal_component_state,
    segment_history,
)
from .panels import panel
from .player import Player
from .widgets import Panel, chosen

__all__ = ["constrained_insertion", "principal_component"]


def constrained_insertion() -> Panel:
    """Step through the insertion of segments: crossed triangles, two polygons, new triangles. Book: 2.5."""
    histories = {name: segment_history(name) for name in SEGMENT_EXAMPLES}
    alt = "A segment is inserted into a triangulation: the triangles that it crosses, and the new triangles."
    return chosen(histories, alt)


def principal_component() -> Player:
    """Move P through a triangulation, with and without fixed triangles: Fig. 12.7 as a panel. Book: 2.5."""
    alt = (
        "A triangulation, a point P that can be moved, the triangles whose circles contain it, "
        "and fixed triangles."
    )
    steps = [round(0.05 * k, 2) for k in range(1, 20)]
    grid: dict[str, Sequence[Any]] = {"preset": list(COMPONENTS), "x": steps, "y": steps}
    labels = {"preset": "triangulation", "x": "x of P", "y": "y of P"}
    start = {"x": 0.8, "y": 0.25}
    return panel(by_preset, grid, alt=alt, start=start, labels=labels)


def by_preset(preset: str, x: float, y: float) -> fr.Frame:
    return principal_component_state(x, y, preset)
