"""Where a new point could go, and what it brings (section 2.3 of the book).

Four places in or near a triangle: a vertex of the Dirichlet tessellation, a point of one of its segments,
the middle of the longest edge, the centroid. The loop that inserts one of them while a triangle is too large.
And the two small things that a size field needs: the control quantity of a triangle, and the limit on the
growth of sizes.

Sources: the chapter, sections 12.2.3 and 12.2.6; for the limit: H. Borouchaki, F. Hecht and P. J. Frey,
International Journal for Numerical Methods in Engineering 43 (1998) 1143-1165.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any

from unstruct.base.errors import InputError
from unstruct.plain.bowyer_watson import GHOST, Cell, Step, bowyer_watson, exact_points, insert
from unstruct.plain.rebay_step import step
from unstruct.plain.voronoi import circumcenter

__all__ = [
    "alpha2",
    "centroid",
    "edge_midpoint",
    "insert_while_large",
    "limit",
    "new_edges",
    "voronoi_segment",
    "voronoi_vertex",
]

Point = tuple[Fraction, Fraction]


def voronoi_vertex(a: Any, b: Any, c: Any) -> Point:
    """The circumcenter: as far from all three corners."""
    found = circumcenter(*_exact(a, b, c))
    if found is None:
        raise InputError(f"the triangle {a}, {b}, {c} is flat and has no circumcenter")
    return found


def voronoi_segment(a: Any, b: Any, d: Any, f: float) -> tuple[float, float]:
    """On the bisector of AB, so far on the side of D that circle AXB has the radius f, if it can.

    (12.4) and (12.5) of the chapter: see `unstruct.plain.rebay_step`.
    """
    found = step(a, b, d, f).point
    if found is None:
        raise InputError(
            f"the circumcenter of {a}, {b}, {d} is not beyond the first edge: choose another one"
        )
    return found


def edge_midpoint(a: Any, b: Any, c: Any) -> Point:
    """The middle of the longest edge."""
    a, b, c = _exact(a, b, c)
    p, q = max(((a, b), (b, c), (c, a)), key=lambda edge: square(*edge))
    return ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)


def centroid(a: Any, b: Any, c: Any) -> Point:
    """The center of mass."""
    a, b, c = _exact(a, b, c)
    return ((a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3)


def new_edges(points: list[Any], cells: Iterable[Cell], p: Any) -> tuple[Step, dict[int, Fraction]]:
    """Insert p into a Delaunay triangulation: the step, and the square of each new edge by its other end."""
    exact = exact_points([*points, p])
    done = insert(exact, cells, len(points))
    others = {v for cell in done.star for v in cell} - {GHOST, len(points)}
    return done, {v: square(*_exact(exact[v], exact[-1])) for v in others}


def insert_while_large(
    points: list[Any],
    f: Callable[[Point], Any],
    place: Callable[..., Any],
    most: int = 200,
) -> tuple[list[Any], list[Cell]]:
    """While a triangle has alpha > 1: take the worst, and insert its place.

    The result has at most ``most`` points. Places are rounded to doubles.
    """
    have = exact_points(points)
    cells = list(bowyer_watson(have))[-1].cells
    while len(have) < most:
        corners = {t: [have[v] for v in t] for t in sorted(cells) if GHOST not in t}
        alphas = {t: alpha2(a, b, c, f) for t, (a, b, c) in corners.items()}
        worst = max(alphas, key=alphas.__getitem__)
        if alphas[worst] <= 1:
            break
        new = place(*corners[worst])
        have = [*have, tuple(Fraction(float(x)) for x in new)]
        cells = insert(have, cells, len(have) - 1).cells
    return have, sorted(cell for cell in cells if GHOST not in cell)


def alpha2(a: Any, b: Any, c: Any, f: Callable[[Point], Any]) -> Fraction:
    """The square of alpha: circumradius over the wanted one at the circumcenter."""
    q = voronoi_vertex(a, b, c)
    return square(_exact(a)[0], q) / Fraction(f(q)) ** 2


def limit(
    values: Mapping[int, Any],
    lengths: Mapping[tuple[int, int], Any],
    growth: Any,
) -> dict[int, Any]:
    """Lower the upper end of an edge that is too steep, until there is none.

    Parameters
    ----------
    values : a size for each vertex
    lengths : the length of each edge (i, j)
    growth : the most that a size may differ per unit of length
    """
    sizes = dict(values)
    steep = True
    while steep:
        steep = False
        for (i, j), length in lengths.items():
            low, high = (i, j) if sizes[i] <= sizes[j] else (j, i)
            if sizes[high] > sizes[low] + growth * length:
                sizes[high] = sizes[low] + growth * length
                steep = True
    return sizes


def square(a: Point, b: Point) -> Fraction:
    """Square of the distance."""
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def _exact(*points: Any) -> list[Point]:
    return [(p[0], p[1]) for p in exact_points(points)]
