"""Prismatic layers on a bar with a groove, step by step, as frames: what is drawn is the bar's section."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from ...plain import prism_normals, prisms
from ..draw import frames as fr

__all__ = ["GROOVE_NAMES", "groove", "groove_frames", "groove_layers"]

GROOVE_NAMES = "ABCDEFGH"
SECTION = [(0.0, 0.0), (6.4, 0.0), (6.4, 2.4), (4.4, 2.4), (3.6, 1.0), (2.7, 1.0), (1.9, 2.4), (0.0, 2.4)]
GROOVE_WANTED = 1.3  # the height that is asked for
SHARE_OF_ROOT = 0.7  # of the least root, the height of a column
GROOVE_SLOPE = 0.2  # the largest difference of two heights, over the distance of their vertices
GROOVE_SHARES = (0.0, 0.15, 0.35, 0.62, 1.0)  # of the height, where layers end
GROOVE_WINDOW = [-1.3, 7.7, -1.3, 3.8]
Point = tuple[float, float, float]
Flat = tuple[float, float]


def groove() -> tuple[list[Point], list[tuple[int, int, int]]]:
    """The sides of a bar of length 1 with a groove: 16 points, corner k at y = 0 and 8 + k at y = 1."""
    n = len(SECTION)
    points = [(x, float(y), z) for y in (0, 1) for x, z in SECTION]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, n + j, j), (i, n + i, n + j)]
    return points, triangles


def groove_layers(wanted: float = GROOVE_WANTED) -> dict[str, Any]:
    """What the recipe makes of the bar: directions, limits of columns, heights, and places of layers.

    Returns
    -------
    dict
        Of the 8 corners: ``directions``, ``limited`` and ``heights`` (before and after gradation), and
        ``places`` of all layers, (x, y, z). Of the 8 sides: ``normals``; ``limit``, the least positive root
        of the quadratics of its columns; ``turned``, those that are not positive at the wanted height.
    """
    points, triangles = groove()
    n = len(SECTION)
    normals = [prisms.unit(prisms.normal_of(points, t)) for t in triangles]
    rays: Any = [
        prism_normals.most_normal([m for m, t in zip(normals, triangles) if v in t]) for v in range(2 * n)
    ]
    columns = [prisms.column_limit([points[v] for v in t], [rays[v] for v in t]) for t in triangles]
    full = prisms.layer_places(points, rays, [wanted] * (2 * n), [1.0])[0]
    positive = [prisms.wedge_is_positive([points[v] for v in t], [full[v] for v in t]) for t in triangles]
    limited = [
        min([wanted] + [SHARE_OF_ROOT * limit for limit, t in zip(columns, triangles) if v in t])
        for v in range(2 * n)
    ]
    heights = prisms.graded_heights(points, triangles, limited, GROOVE_SLOPE)
    return {
        "normals": normals[::2],
        "directions": rays[:n],
        "limit": [min(columns[2 * i : 2 * i + 2]) for i in range(n)],
        "turned": [i for i in range(n) if not all(positive[2 * i : 2 * i + 2])],
        "limited": limited[:n],
        "heights": heights[:n],
        "places": [row[:n] for row in prisms.layer_places(points, rays, heights, GROOVE_SHARES)],
    }


def _flat(points: Sequence[Point]) -> list[Flat]:
    return [(x, z) for x, _, z in points]


def _along(directions: Sequence[Point], heights: Sequence[float]) -> list[Flat]:
    return [(x + h * u, z + h * w) for (x, z), (u, _, w), h in zip(SECTION, directions, heights)]


def _ring(points: Sequence[Flat]) -> list[tuple[Flat, Flat]]:
    return list(zip(points, [*points[1:], points[0]]))


def groove_frames(wanted: float = GROOVE_WANTED) -> list[fr.Frame]:
    """The recipe on the section: normals, rays, a shift that turns a side over, limits, gradation, layers."""
    made = groove_layers(wanted)
    rays, n = made["directions"], len(SECTION)
    sides = _ring(SECTION)
    body = [fr.polygons("cell", [SECTION]), fr.segments("constrained", sides)]
    inward = [(x - 0.35 * u - 0.25, z - 0.35 * w - 0.25) for (x, z), (u, _, w) in zip(SECTION, rays)]
    named = fr.labels("vertex", inward, GROOVE_NAMES)  # inside of the bar, away from the rays
    middles = [((a + c) / 2, (b + d) / 2) for (a, b), (c, d) in sides]
    tips = [(x + 0.5 * u, z + 0.5 * w) for (x, z), (u, _, w) in zip(middles, made["normals"])]
    call = lambda i: GROOVE_NAMES[i] + GROOVE_NAMES[(i + 1) % n]  # noqa: E731

    def seen(caption: str, number: str, *items: fr.Item) -> fr.Frame:
        return fr.frame(caption, *body, *items, named, number=number, view=GROOVE_WINDOW)

    def shifted(heights: Sequence[float], caption: str, number: str, bad: Sequence[int] = ()) -> fr.Frame:
        tops = _along(rays, heights)
        cells = [[a, b, d, c] for (a, b), (c, d) in zip(sides, _ring(tops))]
        good = [cell for i, cell in enumerate(cells) if i not in bad]
        items = [fr.polygons("layer", good), fr.segments("inserted", list(zip(SECTION, tops)))]
        items.append(fr.segments("front", [side for i, side in enumerate(_ring(tops)) if i not in bad]))
        items += [
            fr.polygons("bad", [cells[i] for i in bad]),
            fr.segments("bad", [_ring(tops)[i] for i in bad]),
        ]
        return seen(caption, number, *items)

    limits, limited, heights = made["limit"], made["limited"], made["heights"]
    least = min(range(n), key=lambda i: limits[i])
    low, at = 0.3 * wanted, limits[least]
    turned = ", ".join(map(call, made["turned"]))
    frames = [
        seen("a bar with a groove, seen from its end", f"{n} corners"),
        seen("the normals of the sides", f"{n} normals", fr.segments("voronoi", list(zip(middles, tips)))),
        seen(
            "a ray from each corner",
            "each sees both of its sides",
            fr.segments("inserted", list(zip(SECTION, _along(rays, [0.7] * n)))),
        ),
        shifted([low] * n, "all corners move by the same height", f"height {low:.1f}: all columns positive"),
        shifted(
            [wanted] * n, "the wanted height", f"height {wanted:.1f}: {turned} turned over", made["turned"]
        ),
        shifted([at] * n, "the least root", f"height {at:.2f}: {call(least)} has no length left", [least]),
        shifted(limited, "0.7 of the least root", f"{sum(h < wanted for h in limited)} rays are lowered"),
        shifted(
            heights, "gradation", f"{sum(h < g for h, g in zip(heights, limited))} neighbors are lowered, too"
        ),
    ]
    levels = [_flat(row) for row in made["places"]]
    lines = [side for row in levels[1:] for side in _ring(row)]
    cells = [
        [a, b, d, c] for low_, high in pairwise(levels) for (a, b), (c, d) in zip(_ring(low_), _ring(high))
    ]
    frames.append(
        seen(
            "layers: the same shares of all heights",
            f"{len(cells)} cells of the section, all positive",
            fr.polygons("layer", cells),
            fr.segments("layer", lines),
            fr.segments("inserted", list(zip(SECTION, levels[-1]))),
        )
    )
    return frames
