"""Intrinsic flips on a folded ribbon, step by step, as frames: unrolled into the plane, and in space."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos, degrees, dist, pi, sin, sqrt
from typing import Any

from ...plain import intrinsic_delaunay as plain
from ..draw import frames as fr

__all__ = ["RIBBON_NAMES", "ribbon", "ribbon_flips", "surface_flip_frames", "unrolled"]

RIBBON_NAMES = "ABCDEFGH"
RIBBON_WINDOW = [-0.5, 4.6, -2.3, 1.9]
LOWEST_ARC = -0.35  # circles belong to the unrolled ribbon and end above the one in space
ARC_DASH, ARC_GAP = 0.09, 0.07
SPACE_OFFSET = (0.2, -2.0)  # where the ribbon in space is drawn, below the unrolled one
SEEN_RIGHT, SEEN_UP = (1.0, -0.4, 0.0), (-0.1, 0.5, 0.9)  # a view from above, as sums of coordinates
Point = tuple[float, float, float]
Flat = tuple[float, float]
Edge = tuple[int, int]


def ribbon() -> tuple[list[Point], list[tuple[int, int, int]]]:
    """A ribbon of six triangles that is folded at five edges: A to D below, E to H above."""
    points = [
        (0.0, 0.0, 0.0), (1.2, 0.5, 0.0), (2.3, 0.1, 0.1), (3.5, 0.6, 0.0),
        (0.2, 0.1, 1.1), (1.1, 0.6, 1.2), (2.4, 0.2, 1.1), (3.6, 0.6, 1.2),
    ]  # fmt: skip
    return points, [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 5, 4), (3, 6, 5), (3, 7, 6)]


def unrolled(points: Sequence[Point], triangles: Sequence[Sequence[int]]) -> list[Flat]:
    """The corners in the plane: each triangle, known by its three sides, is laid beside the one before."""
    a, b, _ = triangles[0]
    flat: dict[int, Flat] = {a: (0.0, 0.0), b: (dist(points[a], points[b]), 0.0)}
    for row in triangles:
        for k in range(3):
            u, v, w = row[k], row[k - 2], row[k - 1]
            if w not in flat and u in flat and v in flat:
                base = dist(points[u], points[v])
                left, right = dist(points[u], points[w]), dist(points[v], points[w])
                x = (base * base + left * left - right * right) / (2 * base)
                y = sqrt(left * left - x * x)
                (px, py), (qx, qy) = flat[u], flat[v]
                ex, ey = (qx - px) / base, (qy - py) / base
                flat[w] = (px + x * ex - y * ey, py + x * ey + y * ex)
    return [flat[v] for v in range(len(points))]


def _cross(p: Flat, q: Flat, r: Flat) -> float:
    return (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])


def edges_of(surface: plain.Glued) -> list[Edge]:
    """The ends of each edge, the lesser vertex first."""
    ends = {tuple(sorted((v, surface.vertex[plain.following(side)]))) for side, v in surface.vertex.items()}
    return sorted((a, b) for a, b in ends)


def energy_of(surface: plain.Glued) -> float:
    """The sum of the cotangents of all angles: squares of the sides over four times the area."""
    total = 0.0
    for t in {side[0] for side in surface.vertex}:
        a, b, c = plain.sides_of(surface, (t, 0))
        half = (a + b + c) / 2
        area = sqrt(half * (half - a) * (half - b) * (half - c))
        total += (a * a + b * b + c * c) / (4 * area)
    return total


def ribbon_flips() -> list[dict[str, Any]]:
    """The flips in order, and what is there before each.

    Returns
    -------
    list of dict
        ``edge`` and ``new``, pairs of vertices; ``angles``, the sum of both opposite angles in degrees;
        ``edges`` and ``energy`` before the flip. The last entry has only these two, after all flips.
    """
    points, triangles = ribbon()
    _, flips = plain.intrinsic_delaunay(points, triangles)
    surface, found = plain.glue(points, triangles), []
    for side in flips:
        far = [plain.following(plain.following(s)) for s in (side, surface.twin[side])]
        found.append(
            {
                "edges": edges_of(surface),
                "energy": energy_of(surface),
                "edge": (surface.vertex[side], surface.vertex[plain.following(side)]),
                "new": (surface.vertex[far[0]], surface.vertex[far[1]]),
                "angles": degrees(plain.opposite_angles(surface, side)),
            }
        )
        plain.flip(surface, side)
    return [*found, {"edges": edges_of(surface), "energy": energy_of(surface)}]


def on_ribbon(edge: Edge, flat: Sequence[Flat], given: Sequence[Edge], points: Sequence[Point]) -> list[Flat]:
    """A straight edge of the unrolled ribbon as it is seen in space: it bends where it crosses a fold."""
    a, b = edge
    places: list[tuple[float, Point]] = [(0.0, points[a]), (1.0, points[b])]
    for u, v in given:
        one, two = _cross(flat[a], flat[b], flat[u]), _cross(flat[a], flat[b], flat[v])
        first, last = _cross(flat[u], flat[v], flat[a]), _cross(flat[u], flat[v], flat[b])
        if {u, v} & {a, b} or one * two >= 0 or first * last >= 0:
            continue
        s, r = one / (one - two), first / (first - last)
        p, q = points[u], points[v]
        places.append((r, (p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), p[2] + s * (q[2] - p[2]))))
    return [seen(p) for _, p in sorted(places)]


def seen(p: Point) -> Flat:
    """Where a point in space is drawn."""
    x, y = (sum(c * v for c, v in zip(way, p)) for way in (SEEN_RIGHT, SEEN_UP))
    return x + SPACE_OFFSET[0], y + SPACE_OFFSET[1]


def _circle(p: Flat, q: Flat, r: Flat) -> tuple[Flat, float]:
    (x, y), (u, v) = (q[0] - p[0], q[1] - p[1]), (r[0] - p[0], r[1] - p[1])
    one, two, twice = x * x + y * y, u * u + v * v, 2 * (x * v - y * u)
    cx, cy = (one * v - two * y) / twice, (two * x - one * u) / twice
    return (p[0] + cx, p[1] + cy), sqrt(cx * cx + cy * cy)


def _arc(center: Flat, radius: float) -> fr.Item:
    """The part of a circle at the unrolled ribbon, as dashes."""
    count = int(2 * pi * radius / (ARC_DASH + ARC_GAP))
    turn, dash = 2 * pi / count, ARC_DASH / radius
    at = lambda t: (center[0] + radius * cos(t), center[1] + radius * sin(t))  # noqa: E731
    dashes = [(at(k * turn), at(k * turn + dash)) for k in range(count)]
    return fr.segments("circumcircle", [pair for pair in dashes if min(y for _, y in pair) > LOWEST_ARC])


def surface_flip_frames() -> list[fr.Frame]:
    """The ribbon, its flips one by one, and the result."""
    points, triangles = ribbon()
    flat, steps = unrolled(points, triangles), ribbon_flips()
    given = steps[0]["edges"]
    rows = [[flat[v] for v in row] for row in triangles]
    folded = [[seen(points[v]) for v in row] for row in triangles]
    name = lambda edge: "".join(sorted(RIBBON_NAMES[v] for v in edge))  # noqa: E731
    places = flat + [seen(p) for p in points]

    def lines(role: str, edges: Sequence[Edge]) -> fr.Item:
        bent = [on_ribbon(edge, flat, given, points) for edge in edges]
        parts = [pair for path in bent for pair in pairwise(path)]
        return fr.segments(role, [(flat[a], flat[b]) for a, b in edges] + parts)

    def drawn(caption: str, step: dict[str, Any], *items: fr.Item) -> fr.Frame:
        return fr.frame(
            caption,
            fr.polygons("cell", rows + folded),
            lines("muted", given),
            lines("edge", step["edges"]),
            *items,
            fr.dots("vertex", places),
            fr.labels("vertex", places, RIBBON_NAMES * 2),
            number=f"sum of cotangents {step['energy']:.2f}",
            view=RIBBON_WINDOW,
        )

    frames = [drawn("a ribbon: unrolled, and in space", steps[0])]
    for step, after in pairwise(steps):
        (a, b), far = step["edge"], step["new"]
        center, radius = min((_circle(flat[a], flat[b], flat[c]) for c in far), key=lambda found: found[1])
        corners = " and ".join(sorted(RIBBON_NAMES[c] for c in far))
        frames += [
            drawn(
                f"{name((a, b))}: the angles at {corners} make {step['angles']:.0f} degrees",
                step,
                _arc(center, radius),
                lines("bad", [(a, b)]),
            ),
            drawn(f"{name(far)} takes its place", after, lines("inserted", [far])),
        ]
    frames.append(drawn("no angles make more than 180 degrees", steps[-1]))
    return frames
