"""Widgets of constrained triangulation: a segment goes in; the principal component follows a point."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..scenes.constraints import (
    COMPONENTS,
    SEGMENT_EXAMPLES,
    component_mesh,
    principal_component_state,
    segment_history,
)
from .widgets import Panel, chosen, live, presets, slider

__all__ = ["constrained_insertion", "principal_component"]


def constrained_insertion() -> Panel:
    """Step through the insertion of segments: crossed triangles, two polygons, filling. Book: 2.5."""
    histories = {name: segment_history(name) for name in SEGMENT_EXAMPLES}
    return chosen(histories, "A segment is put into a triangulation: what it crosses, what comes instead.")


def principal_component() -> Panel:
    """Move P through a triangulation, with and without fixed triangles: Figure 12.7 alive. Book: 2.5."""
    first = next(iter(COMPONENTS))
    start = _start(first)
    controls = {
        "preset": presets(COMPONENTS),
        "x": slider("x of P", start["x"], 0, 1, 0.01),
        "y": slider("y of P", start["y"], 0, 1, 0.01),
    }
    alt = (
        "A triangulation, a point P that can be moved, the triangles whose circles hold it, fixed triangles."
    )

    def drag(values: dict[str, Any], handle: str, px: float, py: float) -> dict[str, Any]:
        points = component_mesh(COMPONENTS[values["preset"]])[0].points
        low, high = points.min(axis=0), points.max(axis=0)
        return dict(zip("xy", ((np.array([px, py]) - low) / (high - low)).tolist()))

    return live(principal_component_state, controls, alt, drag, _start)


def _start(preset: str) -> dict[str, Any]:
    given = COMPONENTS[preset]
    points = np.array(given["points"], dtype=float)
    low, high = points.min(axis=0), points.max(axis=0)
    return dict(zip("xy", ((np.array(given["start"]) - low) / (high - low)).tolist()))
