"""Layers from two walls whose gap narrows, as a frame."""

from __future__ import annotations

import numpy as np

from ...domain.domain import Domain
from ...generate.layers.advancing_layers import advancing_layers
from ...sizing.stretching import Layers
from ..draw import frames as fr

__all__ = ["gap_state"]

CHANNEL_LENGTH, LEFT_END, CHANNEL_SPACING = 4.0, 1.2, 0.25


def gap_state(gap: float = 0.4, first: float = 0.02, stop: str = "nearest") -> fr.Frame:
    """Layers in a channel that narrows from left to right.

    Parameters
    ----------
    gap : float
        The width at the right end; that at the left end is 1.2, the length 4.
    first : float
        The height of the first layer; each further one is 1.3 times as high.
    stop : "nearest" or "spring"
        How an opposing front is recognized.

    Returns
    -------
    dict
        The layers, the rest, and how many layers there are at both ends.
    """
    domain = Domain.polygon([(0, 0), (CHANNEL_LENGTH, 0), (CHANNEL_LENGTH, gap), (0, LEFT_END)])
    layers = Layers(first=first, growth=1.3)
    mesh = advancing_layers(domain, CHANNEL_SPACING, layers=layers, walls=[0, 2], cells="quad", stop=stop)
    steps = mesh.steps
    assert steps is not None
    kinds = [mesh.points[cell] for cells in mesh.cells.values() for cell in cells]
    inside = steps["cell_layer"] > 0
    x, level = steps["place"][:, 0], steps["level"]
    left, right = (
        level[(x > 0.3) & (x < 0.7)].max(),
        level[(x > CHANNEL_LENGTH - 0.7) & (x < CHANNEL_LENGTH - 0.3)].max(),
    )
    near = int((steps["reason"] == "near").sum())
    items = [
        fr.polygons("cell", [cell for cell, layer in zip(kinds, inside) if not layer]),
        fr.polygons("layer", [cell for cell, layer in zip(kinds, inside) if layer]),
        fr.segments("front", mesh.points[steps["envelope"]]),
        fr.segments("constrained", mesh.points[mesh.segments[np.isin(mesh.piece, [0, 2])]]),
    ]
    text = f"{near} rays are stopped by the opposite front"
    return fr.frame(text, *items, number=f"{left} layers on the left, {right} on the right")
