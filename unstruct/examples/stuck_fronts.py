"""Small bodies on whose faces an advancing front sticks: no cell on its vertices may be made at any of them.

The twisted prism is Schönhardt's, with integer points: it has no tetrahedralization without further points at
all. The other bodies are convex, so that they have one; but the classical front, face by face in its order
and with a size of 2, comes to a twisted prism of their vertices, or to a body of ten faces. They were found
among the convex hulls of a few random points. That of eight points is a special case: its corners 0, 2, 6 and
4 lie in one plane, and what is left could be filled if this side were cut along its other diagonal. No four
of the seven points of "general" are in one plane.
"""

from __future__ import annotations

import numpy as np

from ..base.errors import InputError
from ..domain.domain import Domain

__all__ = ["stuck_body"]

STUCK_BODIES: dict[str, tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]]] = {
    "twisted prism": (
        [(6, 0, 0), (-3, 5, 0), (-3, -5, 0), (5, 3, 8), (-5, 3, 8), (0, -6, 8)],
        [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)],
    ),
    "convex": (
        [(0, 1, 0), (0, 4, 0), (1, 0, 2), (1, 1, 4), (2, 3, 0), (3, 1, 3), (3, 3, 1), (4, 4, 3)],
        [
            (1, 4, 0), (4, 2, 0), (7, 6, 4), (1, 7, 4), (1, 0, 3), (0, 2, 3), (6, 5, 2), (5, 3, 2),
            (3, 7, 1), (5, 7, 3), (7, 5, 6), (6, 2, 4),
        ],
    ),
    "general": (
        [(0, 8, 7), (1, 0, 0), (3, 6, 0), (5, 3, 7), (5, 8, 5), (6, 4, 4), (8, 0, 5)],
        [
            (2, 6, 1), (5, 6, 2), (0, 3, 4), (1, 6, 3), (2, 1, 0), (1, 3, 0), (6, 5, 4), (3, 6, 4),
            (2, 0, 4), (5, 2, 4),
        ],
    ),
    "ten faces": (
        [
            (1, 0, 4), (1, 3, 3), (2, 0, 3), (2, 3, 2), (3, 0, 3), (3, 4, 1), (3, 4, 3), (4, 1, 1),
            (4, 3, 2), (4, 3, 4),
        ],
        [
            (8, 5, 6), (3, 2, 1), (7, 5, 8), (5, 7, 3), (6, 5, 1), (5, 3, 1), (1, 2, 0), (2, 4, 0),
            (4, 9, 0), (8, 9, 7), (9, 4, 7), (9, 1, 0), (6, 1, 9), (9, 8, 6), (7, 2, 3), (7, 4, 2),
        ],
    ),
}  # fmt: skip


def stuck_body(name: str = "convex") -> Domain:
    """A small body with integer points, on whose faces the classical front in space sticks.

    Parameters
    ----------
    name : "twisted prism", "convex", "general" or "ten faces"
        Six points, of which no four span a tetrahedron inside (with a small size the front makes points);
        a convex body of eight points, where the front sticks after 4 cells, with the 8 faces of a twisted
        prism left, of which four corners lie in a side of the body; one of seven points, no four of them in
        a plane, where it sticks after 5 cells, with 8 faces left; one of ten points, where it sticks after
        11 cells, with 10 faces left.

    Returns
    -------
    Domain
        In space; its facets are triangles that point outward.

    Notes
    -----
    Source of the prism: E. Schönhardt, Mathematische Annalen 98 (1928) 309-312. Book: 3.5.
    """
    if not isinstance(name, str) or name not in STUCK_BODIES:
        raise InputError(f"name = {name!r} must be one of {', '.join(map(repr, STUCK_BODIES))}")
    points, facets = STUCK_BODIES[name]
    return Domain(np.array(points, dtype=float), facets)
