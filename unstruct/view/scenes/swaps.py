"""Diagonal swapping as pictures with controls: one quadrilateral, and runs of swaps.

The chapter's Fig. 12.6 shows one quadrilateral and its two diagonals. `diagonal_choice_state` shows both
triangulations side by side, with their angles, for any place of D. `swap_history` shows a triangulation and
the sorted list of all its angles, which grows from swap to swap: the first bar that changes always rises.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ...connect.swapping import replay, swap_diagonals
from ...examples.running import sweep_triangulation
from ...geometry.simplex import angles, circumcenter, circumradius
from ...mesh.mesh import Mesh
from ...predicates.batch import in_sphere, orient
from ..draw import frames as fr
from .choices import preset_named, within
from .histories import flip_frames

__all__ = [
    "CORNER_X",
    "CORNER_Y",
    "QUADRILATERALS",
    "RUNS",
    "diagonal_choice_state",
    "swap_history",
    "swap_state",
]

# A, B, C and a place for D, all in [-2, 2] x [-2, 2]
QUADRILATERALS: dict[str, dict[str, Any]] = {
    "any quadrilateral": {"triangle": [[-1.6, -0.8], [1.2, -1.2], [1.5, 1.0]], "start": (-0.6, 1.0)},
    "a rectangle: a tie": {"triangle": [[-1.6, -1.0], [1.6, -1.0], [1.6, 1.0]], "start": (-1.6, 1.0)},
    "the largest angle grows": {"triangle": [[-1.8, -1.8], [1.8, 0.6], [0.6, 1.8]], "start": (-0.6, 1.8)},
    "one triangle gets worse": {"triangle": [[-1.6, -1.6], [1.6, -1.6], [0.0, 1.6]], "start": (-1.6, 0.0)},
}
CORNER_X = tuple(k / 5 for k in range(-10, 2))  # the places of D in panels, all starts among them
CORNER_Y = tuple(k / 5 for k in range(-2, 11))
Cells = list[tuple[int, int, int]]
APART = 2.6  # the two pictures are centered at x = -APART and x = APART
WINDOW = [-5.2, 5.2, -2.5, 2.7]


def diagonal_choice_state(x: float, y: float, preset: str = "any quadrilateral") -> fr.Frame:
    """The quadrilateral A, B, C, D with each of its diagonals, the six angles in each case, and the choice.

    Parameters
    ----------
    x, y : float
        The place of D, between -2 and 2.
    preset : str
        A key of `QUADRILATERALS`, which determines A, B, C.

    Returns
    -------
    dict
        A frame; its number compares the minimum and the maximum of the six angles. The caption states the
        result of the exact circle test and the choice that follows.
    """
    given = preset_named(QUADRILATERALS, preset)
    within("x", x, -2, 2)
    within("y", y, -2, 2)
    corners = np.array([*given["triangle"], [x, y]], dtype=float)
    if orient(corners[[0, 2, 3]]) <= 0:
        items = _panel(corners, [(0, 1, 2)], "cell", -APART)
        return fr.frame("D must lie beyond AC", *items, view=WINDOW)
    sign = int(in_sphere(corners[:3], corners[3]))
    with_ac, with_bd = [(0, 1, 2), (0, 2, 3)], [(0, 1, 3), (1, 2, 3)]
    if min(int(orient(corners[list(t)])) for t in with_bd) <= 0:
        items = [*_panel(corners, with_ac, "accepted", -APART), *_circle(corners)]
        text = "ABCD is not strictly convex: AC is its only diagonal, and D is not in circle ABC"
        return fr.frame(
            text, *items, number=f"minimum angle {_angle(corners, with_ac).min():.1f}°", view=WINDOW
        )
    caption = {
        1: "D is inside circle ABC: BD replaces AC",
        -1: "D is outside circle ABC: AC remains",
        0: "D is on the circle: both minimum angles are equal, AC may remain",
    }[sign]
    roles = ("accepted", "cell") if sign <= 0 else ("cell", "accepted")
    items = [
        *_panel(corners, with_ac, roles[0], -APART),
        *_panel(corners, with_bd, roles[1], APART, handle=False),
        *_circle(corners),
    ]
    one, two = _angle(corners, with_ac), _angle(corners, with_bd)
    number = (
        f"minimum angle: AC {one.min():.1f}°, BD {two.min():.1f}°; "
        f"maximum: AC {one.max():.1f}°, BD {two.max():.1f}°"
    )
    return fr.frame(caption, *items, number=number, view=WINDOW)


def _angle(corners: np.ndarray, cells: Cells) -> np.ndarray:
    """The angles of two triangles in degrees, (2, 3)."""
    return np.degrees(angles(corners[np.array(cells)]))


def _panel(corners: np.ndarray, cells: Cells, role: str, shift: float, handle: bool = True) -> list[fr.Item]:
    """Triangles with their angles; the minimum angle is highlighted."""
    at = corners + np.array([shift, 0.0])
    sizes = _angle(corners, cells)
    least = np.unravel_index(np.argmin(sizes), sizes.shape)
    items = [fr.polygons(role, [at[list(t)] for t in cells])]
    places, texts = [], []
    for i, t in enumerate(cells):
        for k in range(3):
            p, q, r = at[t[k]], at[t[k - 2]], at[t[k - 1]]
            way = (q - p) / np.linalg.norm(q - p) + (r - p) / np.linalg.norm(r - p)
            reach = 0.38 * min(np.linalg.norm(q - p), np.linalg.norm(r - p))
            places.append(p + reach * way / max(float(np.linalg.norm(way)), 1e-9) - [0.16, 0.12])
            texts.append(f"{sizes[i, k]:.0f}°")
            if (i, k) == least:
                near = np.array([p, p + 0.3 * (q - p), p + 0.3 * (r - p)])
                items.append(fr.polygons("highlight", [near]))
    away = at - at.mean(axis=0)  # names are outside, so that they do not cover the angles
    names = at + 0.3 * away / np.linalg.norm(away, axis=1)[:, None] - [0.22, 0.22]
    items += [fr.dots("vertex", at[:3]), fr.labels("vertex", names, "ABCD")]
    items.append(fr.labels("edge", places, texts))
    items.append(fr.dots("inserted", at[3], handles=["D"]) if handle else fr.dots("inserted", at[3]))
    return items


def _circle(corners: np.ndarray) -> list[fr.Item]:
    """The circle of A, B, C in the left picture, cut off where the right picture begins."""
    center, radius = circumcenter(corners[:3]), float(circumradius(corners[:3]))
    turn = np.linspace(0, 2 * np.pi, 121)
    ring = center + radius * np.column_stack([np.cos(turn), np.sin(turn)]) + [-APART, 0]
    seen = (ring[:, 0] < -0.1) & (np.abs(ring[:, 1]) < 2.6) & (ring[:, 0] > WINDOW[0])
    pieces = [ring[k : k + 2] for k in range(120) if seen[k] and seen[k + 1]]
    return [fr.segments("circumcircle", pieces)] if pieces else []


# ---- runs ----------------------------------------------------------------------------------------

RUNS: dict[str, dict[str, Any]] = {
    "nine points": {
        "points": [[0, 3], [1, 6], [2, 0], [3, 4], [4, 7], [5, 2], [6, 5], [7, 0], [8, 6]],
    },
    "convex: many swaps": {"points": [[0, 0], [1, 2.4], [2, 3.6], [4, 4.6], [6, 4.4], [7, 3.6], [8, 2]]},
    "hexagon on a circle: ties": {"points": [[8, 4], [7, 7], [1, 7], [0, 4], [1, 1], [7, 1]]},
    "one edge must stay": {
        "points": [[0, 3], [1, 6], [2, 0], [3, 4], [4, 7], [5, 2], [6, 5], [7, 0], [8, 6]],
        "fixed": [[1, 2]],
    },
}
BARS = 10.0  # the width of the bar chart of angles


def swap_history(preset: str = "nine points") -> list[fr.Frame]:
    """All frames of one of the runs in `RUNS`: the triangulation, and its sorted angles as bars."""
    return list(_run(preset))


def swap_state(step: int, preset: str = "nine points") -> fr.Frame:
    """One frame of `swap_history`; ``step`` starts at 0.

    Its number shows the first entries of the sorted list of all angles. The first bar that differs from the
    list before the swap is highlighted.
    """
    history = _run(preset)
    within("step", step, 0, len(history) - 1)
    return history[step]


@lru_cache(maxsize=8)
def _run(preset: str) -> tuple[fr.Frame, ...]:
    given = preset_named(RUNS, preset)
    points = np.array(given["points"], dtype=float)
    mesh = sweep_triangulation(points)
    fixed = given.get("fixed")
    if fixed:
        mesh = Mesh(mesh.points, mesh.simplices, markers={"shore": fixed})
    _, swaps = swap_diagonals(mesh, history=True)
    frames = flip_frames(mesh, swaps, names=True)
    lists = [_sorted_angles(replay(mesh, swaps[:k])) for k in range(len(swaps) + 1)]
    lists.append(lists[-1])
    made = []
    for k, (one, now) in enumerate(zip(frames, lists)):
        before = lists[max(k - 1, 0)]
        items = list(one["items"])
        if fixed:
            items.append(fr.segments("constrained", points[fixed]))
        caption = one["caption"] if not fixed else one["caption"].replace("Delaunay", "constrained Delaunay")
        number = "sorted angles: " + ", ".join(f"{a:.0f}°" for a in now[:6]) + ", …"
        made.append(fr.frame(caption, *items, *_bars(now, before), number=number))
    view = [-0.8, 9.0 + BARS + 0.6, -0.8, 8.0]
    return tuple({**f, "view": view} for f in made)


def _sorted_angles(mesh: Mesh) -> np.ndarray:
    return np.sort(np.degrees(angles(mesh.corners)).ravel())


def _bars(now: np.ndarray, before: np.ndarray) -> list[fr.Item]:
    """The sorted angles as bars to the right of the points; the angles before the swap are dashes."""
    width = BARS / len(now)
    left, high = 9.0 + width * np.arange(len(now)), now / 180 * 7
    changed = np.flatnonzero(np.abs(now - before) > 1e-9)
    boxes = [[[x, 0], [x + 0.8 * width, 0], [x + 0.8 * width, h], [x, h]] for x, h in zip(left, high)]
    first = int(changed[0]) if len(changed) else -1
    items = [fr.polygons("accepted", [box for i, box in enumerate(boxes) if i != first])]
    if first >= 0:
        items.append(fr.polygons("highlight", [boxes[first]]))
        old = before / 180 * 7
        items.append(
            fr.segments("bad", [[[left[i], old[i]], [left[i] + 0.8 * width, old[i]]] for i in changed])
        )
    return items
