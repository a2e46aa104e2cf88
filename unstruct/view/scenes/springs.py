"""The spring criterion at one edge of a front, and layers over a wall until they match, as frames."""

from __future__ import annotations

from functools import lru_cache
from math import ceil, isclose, log

import numpy as np

from ...plain import layers as plain
from ..draw import frames as fr

__all__ = ["SPRING_X", "SPRING_Y", "spring_state", "stretch_state"]

SPRING_X = [round(-0.6 + 0.2 * k, 1) for k in range(12)]  # where the point of the other front may be
SPRING_Y = [round(-0.8 + 0.2 * k, 1) for k in range(13)]
EDGE_ENDS = (0.0, 0.0), (1.0, 0.0)


def spring_state(x: float = 0.4, y: float = 0.8, height: float = 0.4) -> fr.Frame:
    """A front edge from (0, 0) to (1, 0), the new points above its ends, and a point of another front.

    Parameters
    ----------
    x, y : float
        The point of the other front, which the reader can drag.
    height : float
        That of the new layer.

    Returns
    -------
    dict
        The springs of the point to the ends of the edge, whether it is near and why, and the forces. Dots
        are the places in the grid of `SPRING_X` and `SPRING_Y` where such a point would be near.
    """
    a, b = EDGE_ENDS
    new = (0.0, height), (1.0, height)
    force, least = (plain.spring_force(q, a, b, 1.0) for q in ((x, y), new[0]))
    if y <= 0:
        text = "the point is not ahead of the edge: it makes no valid cell, whatever its force is"
    elif not plain.near(a, b, new, [(x, y)]):
        text = "more force than at the new points: the layer is made"
    elif force < least:
        text = "less force than at the new points: the other front is near, the march stops"
    else:
        text = "no spring is stretched: the other front is near, the march stops"
    items = [
        fr.dots("edge", near_places(height)),
        fr.polygons("layer", [[a, b, new[1], new[0]]]),
        fr.segments("front", [(a, b)]),
        fr.segments("voronoi", [((x, y), a), ((x, y), b)]),
        fr.dots("accepted", new),
        fr.dots("inserted", [(x, y)], handles=["Q"]),
        fr.labels("vertex", [a, b, (x, y)], ["A", "B", "Q"]),
    ]
    return fr.frame(text, *items, number=f"force at Q {force:.2f}, at each new point {least:.2f}")


@lru_cache(maxsize=16)
def near_places(height: float) -> list[tuple[float, float]]:
    """The places of the grid where an existing point is near."""
    a, b = EDGE_ENDS
    new = (0.0, height), (1.0, height)
    return [(x, y) for y in SPRING_Y for x in SPRING_X if plain.near(a, b, new, [(x, y)])]


def stretch_state(first: float = 0.01, growth: float = 1.3, spacing: float = 0.1) -> fr.Frame:
    """Geometric layers over a flat wall, until one would be as high as the wall's points are apart.

    Parameters
    ----------
    first : float
        The height of the first layer, below ``spacing``.
    growth : float
        Each further layer is so many times as high, above 1.
    spacing : float
        The distance of the points along the wall.

    Returns
    -------
    dict
        The layers, squares above them for comparison, the number of layers, and their thickness with its
        bounds.
    """
    exact = log(spacing / first) / log(growth)
    count = round(exact) if isclose(exact, round(exact)) else ceil(exact)
    tops = np.concatenate([[0.0], np.cumsum(first * growth ** np.arange(count))])
    thick, wide = float(tops[-1]), 5 * spacing
    x = np.arange(6) * spacing
    square = [((v, thick), (v, thick + spacing)) for v in x]
    items = [
        fr.segments("muted", [*square, ((0, thick + spacing), (wide, thick + spacing))]),
        fr.segments("layer", [((0, y), (wide, y)) for y in tops[1:]]),
        fr.segments("layer", [((v, 0), (v, thick)) for v in x]),
        fr.segments("front", [((0, thick), (wide, thick))]),
        fr.segments("constrained", [((0, 0), (wide, 0))]),
    ]
    low, high = (spacing - first) / (growth - 1), (growth * spacing - first) / (growth - 1)
    text = f"{count} layers, the last one {first * growth ** (count - 1):.3f} high"
    return fr.frame(text, *items, number=f"{thick:.2f} thick, between {low:.2f} and {high:.2f}")
