"""Prismatic layers around a notched body, cut through the middle: what a panel with three controls shows."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...domain.domain import Domain
from ...examples.bodies import notched_box
from ...examples.surfaces import meshed_sides
from ...generate.prisms.prismatic_layers import prismatic_layers
from ...sizing.stretching import Layers
from ..draw import frames as fr
from ..draw.sections import as_plane, shown_faces

__all__ = ["PRISM_STOPS", "prism_state"]

PRISM_STOPS = ("squeeze", "stop")
PRISM_COUNT = 8  # layers
BODY_SIZE = 0.3
CUT_AT = 0.02  # beside the middle, so that the plane meets no vertex
PRISM_WINDOW = [-2.3, 2.3, -2.15, 2.45]


@lru_cache(maxsize=1)
def _body() -> Domain:
    return meshed_sides(notched_box(0.5, 1.1), BODY_SIZE)


def prism_state(first: float = 0.03, growth: float = 1.2, stop: str = "squeeze") -> fr.Frame:
    """Eight layers around a box with a notch, cut in the middle.

    Parameters
    ----------
    first, growth : float
        The height of the first layer, and how many times as high each further one is.
    stop : str
        One of `PRISM_STOPS`.

    Returns
    -------
    dict
        The sections of the body and of the cells; the rays near the plane that are lower than wanted;
        the worst cell, by its least scaled Jacobian.
    """
    if stop not in PRISM_STOPS:
        raise InputError(f"stop = {stop!r} must be one of {', '.join(map(repr, PRISM_STOPS))}")
    layers = Layers(first=first, growth=growth, count=PRISM_COUNT)
    mesh = prismatic_layers(_body(), layers=layers, stop=stop)
    steps: Any = mesh.steps
    low = (steps["reason"] != "full") & (np.abs(steps["place"][:, 1]) < BODY_SIZE)
    ends = steps["place"] + steps["height"][:, None] * steps["direction"]
    quality = mesh.quality("scaled_jacobian")
    worst = int(np.argmin(quality))
    text = f"{mesh.size} cells; full heights: {mesh.figures['share of full heights']:.0%}"
    return fr.frame(
        f"{PRISM_COUNT} layers, {float(layers.cumulative()[-1]):.2f} thick: {stop}",
        fr.polygons("cell", _section(mesh)),
        fr.segments("constrained", _outline(_body().triangulated)),
        fr.segments("highlight", np.stack([steps["place"][low], ends[low]], axis=1)[:, :, ::2]),
        fr.dots("inserted", [_middle(mesh, worst)[::2]]),
        number=f"{text}; least scaled Jacobian {float(quality[worst]):.3f}",
        view=PRISM_WINDOW,
    )


def _section(mesh: Any) -> list[Any]:
    """The cells cut by the plane, as polygons of (x, z)."""
    shown = shown_faces(mesh.points, mesh.cells, as_plane(("y", CUT_AT)), flat=True)
    places = shown.extended(mesh.points)[:, ::2]
    return [places[[v for v in row if v >= 0]] for row in shown.rows[shown.cap].tolist()]


def _outline(body: Any) -> list[Any]:
    """Where the plane cuts the surface, as segments of (x, z)."""
    corners = body.points[body.triangles]
    above = corners[:, :, 1] > CUT_AT
    ends = []
    for x, side in zip(corners, above):
        crossed = [(x[k], x[k - 1]) for k in range(3) if side[k] != side[k - 1]]
        if crossed:
            shares = [(CUT_AT - p[1]) / (q[1] - p[1]) for p, q in crossed]
            ends.append([(p + s * (q - p))[::2] for (p, q), s in zip(crossed, shares)])
    return ends


def _middle(mesh: Any, cell: int) -> Any:
    """The mean of the corners of a cell."""
    for block in mesh.cells.values():
        if cell < len(block):
            return mesh.points[block[cell]].mean(axis=0)
        cell -= len(block)
    raise AssertionError(f"the mesh has no cell {cell}")
