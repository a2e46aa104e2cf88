"""Rebay's insertion as pictures with sliders: pure functions from numbers to frames.

One picture shows the step of figure 12.8, the place of the new point on the Voronoi segment. The other shows
how the deviation epsilon = f / p - 2 / sqrt(3) of an edge determines that of the edges of the triangle built
on it. The formulas are those of `unstruct.plain.rebay_step`. Book: 2.6c.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, sqrt
from typing import Any

import numpy as np

from ...base.errors import InputError
from ...geometry.simplex import angles, circumcenter, circumradius
from ...plain import rebay_step as rs
from ...plain.rebay_step import Step
from ...predicates.batch import in_sphere
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = [
    "COBWEBS",
    "FRONT_EXAMPLES",
    "chain_frame",
    "cobweb_state",
    "voronoi_segment_state",
]

# ---- one step: figure 12.8 -----------------------------------------------------------------------

A, B = np.array([-1.0, 0.0]), np.array([1.0, 0.0])  # so that p = 1
FRONT_EXAMPLES: dict[str, dict[str, Any]] = {
    "a short edge: p < f": {"c": (0.1, 1.6), "turn": 0.8, "f": 1.1, "q": 1.8},
    "a long edge: p > f": {"c": (0.1, 1.6), "turn": 0.8, "f": 0.8, "q": 1.8},
    "the cap is active": {"c": (0.1, 1.6), "turn": 0.8, "f": 1.6, "q": 1.5},
    "q < p: d is beyond F": {"c": (0.1, 1.4), "turn": 0.8, "f": 0.75, "q": 0.75},
    "nasty: AB is deleted": {"c": (0.0, 0.5), "turn": 0.25, "f": 0.875, "q": 1.6},
}
F_RANGE, Q_RANGE = (0.3, 2.0), (0.1, 2.0)  # the ranges of f and q, for p = 1


def voronoi_segment_state(f: float, q: float, preset: str = "a short edge: p < f") -> fr.Frame:
    """Figure 12.8: the accepted triangle ABC above, the other triangle ADB below, and the new point X.

    Parameters
    ----------
    f : float
        The wanted circumradius, between 0.3 and 2, for p = 1.
    q : float
        The distance of F from M, between 0.1 and 2.
    preset : str
        A key of `FRONT_EXAMPLES`, which determines C, and the place of D on its circle.

    Returns
    -------
    dict
        A frame; its caption states, by exact signs, what happens to the edge AB. Its number compares d with q
        and gives the angle at X.
    """

    given = preset_named(FRONT_EXAMPLES, preset)
    within("f", f, *F_RANGE)
    within("q", q, *Q_RANGE)
    c, d = np.array(given["c"]), _on_circle(q, given["turn"])
    got, raw = rs.step(A, B, d, f, c), rs.step(A, B, d, f, c, clamp=False)
    assert got.point is not None and raw.point is not None and got.accepted_center is not None
    x, e, center = np.array(got.point), np.array(got.accepted_center), np.array([0.0, -q])
    items = [
        fr.polygons("accepted", [[A, B, c]]),
        fr.polygons("waiting", [[A, d, B]]),
        fr.circles("circumcircle", [e, center], [np.hypot(*(A - e)), np.hypot(*(A - center))]),
        fr.circles("inserted", [circumcenter(np.array([A, B, x]))], [circumradius(np.array([A, B, x]))]),
        fr.segments("voronoi", [[e, center]]),
        fr.segments("inserted", [[A, x], [B, x]]),
        fr.segments("front", [[A, B]]),
        fr.dots("vertex", [A, B, c, d]),
        fr.dots("voronoi", e),
        fr.dots("voronoi", center, handles=["F"]),
        fr.dots("muted", got.middle),
    ]
    at_center = got.beyond or got.capped
    if got.beyond:
        items += [fr.dots("bad", raw.point), fr.labels("bad", raw.point + np.array([0.05, -0.3]), ["at d"])]
    items += [
        fr.dots("inserted", x, handles=["X"]),
        fr.labels("vertex", [A - [0.35, 0.0], B, c, d, got.middle], "ABCDM"),
        fr.labels("voronoi", [e] if at_center else [e, center], "EF"[: 2 - at_center]),
        fr.labels("inserted", [x], ["X = F" if at_center else "X"]),
    ]
    number = f"d = {raw.distance:.2f}, q = {q:.2f}, angle AXB = {_angle_at(x):.0f}°"
    return fr.frame(_what_happens(got, c, d, x), *items, number=number, view=[-2.4, 2.4, -4.3, 2.0])


def _what_happens(got: Step, c: np.ndarray, d: np.ndarray, x: np.ndarray) -> str:
    if in_sphere(np.array([A, B, c]), d) > 0:
        return "D is in circle ABC: this mesh is not Delaunay"
    if got.beyond:
        where = "q < p: d leads beyond F, so stop at F"
    elif got.capped:
        where = "f is too large for this triangle: X = F"
    elif got.radius > got.p:
        where = "the circle AXB has the radius f"
    else:
        where = "f < p: the smallest circle, with a right angle at X"
    return where + ("; X is in circle ABC, so AB is deleted" if in_sphere(np.array([A, B, c]), x) > 0 else "")


def _on_circle(q: float, turn: float) -> np.ndarray:
    """The point at ``turn``, from 0 (near A) to 1 (near B), on the arc below AB around the center (0, -q)."""
    half = np.pi - np.arctan2(1.0, q)  # half the angle of the arc, seen from the center
    a = -np.pi / 2 + (2 * turn - 1) * half * 0.9
    return np.array([0.0, -q]) + np.hypot(1.0, q) * np.array([np.cos(a), np.sin(a)])


def _angle_at(x: np.ndarray) -> float:
    return float(np.degrees(angles(np.array([A, B, x]))[2]))


# ---- the recurrence ------------------------------------------------------------------------------

COBWEBS: dict[str, tuple[float, float]] = {  # the factor of f per step, and p / f of the first edge
    "constant size": (1.0, 0.55),
    "f grows by a quarter": (1.25, 0.55),
    "f shrinks: a start near the fixed point": (0.88, 0.9),
    "the same, a start from afar": (0.88, 0.8),
    "f shrinks: nothing is stable": (0.75, 0.8),
    "nasty: f shrinks faster than p": (0.69, 0.8),
}
GROWTH, START, COBWEB_STEPS = (0.65, 1.4), (0.5, 1.5), 24
WINDOW_LOW, WINDOW_HIGH = -0.62, 0.88  # the range of epsilon in the window
IDEAL = 2 / sqrt(3)


def cobweb_state(growth: float, start: float, measured: Sequence[Sequence[float]] = ()) -> fr.Frame:
    """The cobweb of epsilon: from an edge to those of its triangle, while f changes by a factor in each step.

    Parameters
    ----------
    growth : float
        The factor of f from an edge to the next one, between 0.65 and 1.4.
    start : float
        p / f of the first edge, between 0.5 and 1.5.
    measured : pairs of floats, optional
        Pairs (epsilon of an edge, epsilon of an edge made from it) of a real run with one size, drawn over
        the curve while ``growth`` is 1.

    Returns
    -------
    dict
        A frame; its number gives the deviation from the fixed point after the last step, and the slope there.
    """
    within("growth", growth, *GROWTH)
    within("start", start, *START)
    orbit, web = _web(growth, start)
    curve = [[e, _next(e, growth)] for e in np.linspace(WINDOW_LOW, WINDOW_HIGH, 89).tolist()]
    inside = [piece for piece in pairwise(curve) if max(p[1] for p in piece) < 2]
    pairs = np.reshape(np.asarray(measured if abs(growth - 1) < 5e-3 else (), dtype=float), (-1, 2))
    items = [
        fr.segments(
            "edge",
            [[[WINDOW_LOW, 0.0], [WINDOW_HIGH, 0.0]], [[0.0, WINDOW_LOW], [0.0, WINDOW_HIGH]]],
            opacity=0.5,
        ),
        fr.segments("muted", [[[WINDOW_LOW, WINDOW_LOW], [WINDOW_HIGH, WINDOW_HIGH]]]),
        fr.segments("circumcircle", _tangent(growth)),
        fr.segments("constrained", inside),
        fr.segments("inserted", web, opacity=0.7),
        fr.dots("accepted", pairs[(abs(pairs) < WINDOW_HIGH).all(axis=1)], opacity=0.5),
        fr.dots("inserted", [orbit[0], 0.0], handles=["start"]),
        fr.labels("edge", [[WINDOW_HIGH - 0.13, 0.0], [0.0, WINDOW_HIGH - 0.13]], ["εₙ", "εₙ₊₁"]),
        fr.labels("edge", [[0.5, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.0, -0.5]], ["0.5", "−0.5"] * 2),
    ]
    caption, number = _fate(growth, orbit)
    return fr.frame(caption, *items, number=number, view=[WINDOW_LOW, WINDOW_HIGH, WINDOW_LOW, WINDOW_HIGH])


def _next(deviation: float, growth: float) -> float:
    """The epsilon of the next edges, given that of an edge."""

    ratio = deviation + IDEAL
    return rs.epsilon(rs.next_ratio(1 / ratio, growth), 1.0)


def _web(growth: float, start: float) -> tuple[list[float], list[Any]]:
    """The deviations of a chain of edges, and the segments between the curve and the diagonal."""
    orbit = [1 / start - IDEAL]
    for _ in range(COBWEB_STEPS):
        orbit.append(_next(orbit[-1], growth))
    web, here = [], [orbit[0], 0.0]
    for now, then in pairwise(orbit):
        web += [[here, [now, then]], [[now, then], [then, then]]]
        here = [then, then]
    return orbit, web


def _rest(growth: float) -> tuple[float, float]:
    """The fixed point of epsilon and the slope there; both -inf if sizes shrink faster than the edges."""
    s = growth * growth
    if s <= 0.5:
        return -inf, -inf
    ratio = sqrt(4 * s - 1) / (2 * s)  # p / f = sin(2 arcsin(1 / (2 growth)))
    return 1 / ratio - IDEAL, -1 / (4 * s - 2)


def _tangent(growth: float) -> list[Any]:
    """A short piece of the tangent of the curve at the fixed point."""
    rest, slope = _rest(growth)
    if rest == -inf or abs(slope) > 20:
        return []
    run = 0.45 / sqrt(1 + slope * slope)
    return [[[rest - run, rest - slope * run], [rest + run, rest + slope * run]]]


def _fate(growth: float, orbit: list[float]) -> tuple[str, str]:
    """A caption about the last steps, and the number of the frame."""
    rest, slope = _rest(growth)
    if rest == -inf:
        return "f shrinks faster than the edges: p / f grows without bound", f"p/f = {_ratio(orbit):.3g}"
    number = f"after {COBWEB_STEPS} steps ε − ε* = {orbit[-1] - rest:.0e}; slope at ε* {slope:.3f}"
    away = [abs(deviation - rest) for deviation in orbit]
    if away[-1] < 1e-3 or (abs(slope) < 1 and away[-1] < 0.7 * away[-9]):
        return "all later triangles tend to one shape", number
    if max(abs(orbit[k] - orbit[k - 2]) for k in (-1, -2, -3)) < 2e-3:
        return "two shapes in turn: the chain does not converge", number
    return "no convergence within these steps", number


def _ratio(orbit: list[float]) -> float:
    return 1 / (orbit[-1] + IDEAL)


# ---- a chain of triangles ------------------------------------------------------------------------


def chain_frame(start: float = 0.55, growth: float = 1.0, count: int = 10) -> fr.Frame:
    """The triangles of one chain, each built on an edge of the previous one, alternately left and right.

    Parameters
    ----------
    start : float
        p / f of the first edge.
    growth : float
        The factor of f from an edge to the next one.
    count : int
        The number of triangles, at least one.

    Returns
    -------
    dict
        A frame; its number gives the angle at the new point of the first and of the last triangle.
    """

    if count < 1:
        raise InputError(f"count = {count} must be at least 1")
    a, b, f = np.array([0.0, 0.0]), np.array([2 * start, 0.0]), 1.0
    triangles = []
    for k in range(count):
        p = float(np.hypot(*(b - a))) / 2
        if p < 1e-9:
            raise InputError(f"after {k} of {count} triangles the edges are too short to be drawn")
        normal = np.array([a[1] - b[1], b[0] - a[0]]) / (2 * p)
        x = (a + b) / 2 + rs.distance(max(f, p), p) * normal
        triangles.append(np.array([a, b, x]))
        a, b, f = (x, b, f * growth) if k % 2 else (a, x, f * growth)
    first, last = (float(np.degrees(angles(t)[2])) for t in (triangles[0], triangles[-1]))
    items = [
        fr.polygons("accepted", triangles),
        fr.segments("front", [triangles[0][:2]]),
        fr.dots("vertex", np.unique(np.concatenate(triangles).round(12), axis=0)),
    ]
    number = f"angle at X: {first:.0f}° at first, {last:.2f}° at last"
    return fr.frame(f"start p/f = {start:g}, f times {growth:g} each step", *items, number=number)
