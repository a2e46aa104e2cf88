"""A metric in the plane: its ellipse, a triangle that is equilateral in it, and the length of an edge."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt

from ..draw import frames as fr

__all__ = ["METRIC_ACROSS", "METRIC_ALONG", "METRIC_TURNS", "METRIC_WINDOW", "metric_state"]

METRIC_ALONG = [0.2, 0.4, 0.7, 1.0]
METRIC_ACROSS = [0.1, 0.2, 0.4, 1.0]
METRIC_TURNS = list(range(0, 180, 15))  # degrees
METRIC_WINDOW = (-1.1, 1.1, -1.1, 1.1)
METRIC_EDGE = (0.6, 0.3)
ON_ELLIPSE = [2 * pi * k / 72 for k in range(72)]


def metric_state(turn: int = 30, along: float = 0.7, across: float = 0.2) -> fr.Frame:
    """The metric with the lengths ``along`` and ``across`` in two orthogonal directions.

    Parameters
    ----------
    turn : int
        The direction of the first length, in degrees.
    along, across : float
        How long an edge should be in the first direction, and at right angles to it.

    Returns
    -------
    dict
        All vectors of the length 1 end on the ellipse. The triangle has three sides of the length 1. The
        caption has the length of the dashed edge, the number the matrix.
    """
    d, e = (cos(radians(turn)), sin(radians(turn))), (-sin(radians(turn)), cos(radians(turn)))

    def place(s: float, t: float) -> tuple[float, float]:
        return s * along * d[0] + t * across * e[0], s * along * d[1] + t * across * e[1]

    matrix = [[d[i] * d[j] / along**2 + e[i] * e[j] / across**2 for j in range(2)] for i in range(2)]
    x, y = METRIC_EDGE
    length = sqrt(x * x * matrix[0][0] + 2 * x * y * matrix[0][1] + y * y * matrix[1][1])
    items = [
        fr.polygons("waiting", [[place(cos(t), sin(t)) for t in ON_ELLIPSE]]),
        fr.segments("voronoi", [((0, 0), place(1, 0)), ((0, 0), place(0, 1))]),
        fr.polygons("highlight", [[(0, 0), place(1, 0), place(0.5, sqrt(0.75))]]),
        fr.segments("front", [((0, 0), METRIC_EDGE)]),
        fr.dots("vertex", [(0, 0), METRIC_EDGE]),
    ]
    word = "too long" if length > sqrt(2) else "too short" if length < sqrt(0.5) else "about as wanted"
    rows = ", ".join(f"[{round(a, 1) + 0.0:.1f}, {round(b, 1) + 0.0:.1f}]" for a, b in matrix)
    return fr.frame(f"the edge has the length {length:.2f}: {word}", *items, number=f"M = [{rows}]")
