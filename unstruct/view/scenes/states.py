"""The pictures of widgets as pure functions from the values of the controls to a frame.

The functions do not depend on widgets or on a running notebook, so that tests can call every state, both ends
included. The two proofs of section 2.4a have their states in `unstruct.view.scenes.proofs`.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from ...connect.insertion.delaunay import delaunay
from ...connect.voronoi.diagram import Voronoi
from ...examples.running import sweep_triangulation
from ...geometry.simplex import circumcenter, circumradius
from ...predicates.batch import in_sphere, orient
from ..draw import frames as fr
from ..draw.plots import dual_segments
from .choices import preset_named, within
from .histories import baker_frames, insertion_frames

__all__ = [
    "CIRCLES",
    "INSERTIONS",
    "SITES",
    "bowyer_watson_history",
    "bowyer_watson_state",
    "empty_circle_state",
    "float_in_circle",
    "voronoi_dual_state",
]

# ---- the empty circle ----------------------------------------------------------------------------

CIRCLES: dict[str, dict[str, Any]] = {
    "any triangle": {"triangle": [[-1.0, -0.7], [1.2, -0.5], [0.2, 1.1]]},
    "corners of a square": {"triangle": [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]]},
    "nasty: neighboring doubles": {
        "triangle": [[1.7, 1.0], [0.9, 1.6], [-0.2, 0.7]],
        "origin": (0.03, -0.022936474715370983),  # a double next to the circle
    },
}
REACH = 16  # how many units in the last place the window of neighboring doubles shows on each side


def empty_circle_state(x: float, y: float, preset: str = "any triangle") -> fr.Frame:
    """Whether D is inside the circle of A, B, C: the exact answer and that of floating-point numbers.

    Parameters
    ----------
    x, y : float
        The place of D, between -2 and 2. In the preset with neighboring doubles, 1/8 is one unit in the last
        place, and the picture is a window of 33 by 33 neighboring doubles.
    preset : str
        A key of `CIRCLES`.

    Returns
    -------
    dict
        A frame; its number shows the determinant and the exact sign, or, in the preset with neighboring
        doubles, how many doubles of the window get a wrong sign.
    """
    given = preset_named(CIRCLES, preset)
    within("x", x, -2, 2)
    within("y", y, -2, 2)
    triangle = np.array(given["triangle"])
    if "origin" in given:
        return _nasty_window(triangle, given["origin"], round(8 * x), round(8 * y))
    d = np.array([x, y], dtype=float)
    exact, rounded = int(in_sphere(triangle, d)), float_in_circle(triangle, d)
    caption = {
        1: "D is inside the circle: ABC is not Delaunay",
        -1: "D is outside: ABC may stay",
        0: "D is on the circle: ABC may stay, and may go",
    }[exact]
    items = [
        fr.polygons("cavity" if exact > 0 else "accepted", [triangle]),
        fr.circles("circumcircle", [circumcenter(triangle)], [circumradius(triangle)]),
        fr.dots("vertex", triangle),
        fr.dots("inserted", d, handles=["D"]),
        fr.labels("vertex", [*triangle, d], "ABCD"),
    ]
    number = f"determinant = {rounded:.3g}, exact sign {_sign(exact)}"
    return fr.frame(caption, *items, number=number, view=[-2.2, 2.2, -2.2, 2.2])


def float_in_circle(triangle: np.ndarray, d: np.ndarray) -> float:
    """The in-circle determinant by the plain formula in floating-point numbers; its sign may be wrong."""
    (ax, ay), (bx, by), (cx, cy) = (triangle - d).tolist()
    a, b, c = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return ax * (by * c - b * cy) - ay * (bx * c - b * cx) + a * (bx * cy - by * cx)


def _nasty_window(triangle: np.ndarray, origin: tuple[float, float], i: int, j: int) -> fr.Frame:
    """The doubles around ``origin``, with marks at wrong floating-point signs; D is the double (i, j)."""
    marks, line, wrong = _signs(triangle.tobytes(), origin)
    exact, rounded = marks[i, j]
    right = exact == np.sign(rounded)
    places = {name: [p for p in marks if _verdict(*marks[p]) == name] for name in ("muted", "waiting", "bad")}
    items = [fr.dots(name, where) for name, where in places.items()]
    items += [
        fr.segments("circumcircle", [line]),
        fr.polygons("constrained", [np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.8 + [i, j]]),
        fr.dots("inserted", [i, j], handles=["D"]),
        fr.labels("vertex", [[i, j]], "D"),
    ]
    where = {1: "inside", -1: "outside", 0: "on the circle"}
    caption = f"D is {where[exact]}; floating-point numbers say {where[int(np.sign(rounded))]}" + (
        "" if right else ": wrong"
    )
    number = f"wrong signs here: {wrong} of {len(marks)} (crosses: opposite, triangles: zero)"
    side = REACH + 1.0
    return fr.frame(caption, *items, number=number, view=[-side, side, -side, side])


@lru_cache(maxsize=4)
def _signs(
    corners: bytes, origin: tuple[float, float]
) -> tuple[dict[tuple[int, int], tuple[int, float]], list, int]:
    """Exact signs and floating-point determinants of all doubles in the window; the circle; error count."""
    triangle = np.frombuffer(corners).reshape(3, 2)
    steps = np.arange(-REACH, REACH + 1)
    unit = [float(np.spacing(abs(v))) for v in origin]
    grid = [(int(i), int(j)) for i in steps for j in steps]
    points = np.array(origin) + np.array(grid) * unit
    exact = np.asarray(in_sphere(triangle, points))
    marks = {key: (int(s), float_in_circle(triangle, p)) for key, s, p in zip(grid, exact, points)}
    # In the window the circle is a straight line, because the determinant is linear to one part in 1e15.
    at = [
        _exact_in_circle(triangle, [origin[0] + a * unit[0], origin[1] + b * unit[1]])
        for a, b in ((0, 0), (8, 0), (0, 8))
    ]
    value, slope_x, slope_y = float(at[0]), float(at[1] - at[0]) / 8, float(at[2] - at[0]) / 8
    far = REACH + 1
    line = (
        [[-(value + slope_y * t) / slope_x, t] for t in (-far, far)]
        if abs(slope_x) > abs(slope_y)
        else [[t, -(value + slope_x * t) / slope_y] for t in (-far, far)]
    )
    return marks, line, sum(_verdict(*m) != "muted" for m in marks.values())


def _exact_in_circle(triangle: np.ndarray, d: list[float]) -> Fraction:
    rows = [[Fraction(float(v)) - Fraction(w) for v, w in zip(p, d)] for p in triangle]
    (ax, ay, a), (bx, by, b), (cx, cy, c) = ((x, y, x * x + y * y) for x, y in rows)
    return ax * (by * c - b * cy) - ay * (bx * c - b * cx) + a * (bx * cy - by * cx)


def _verdict(exact: int, rounded: float) -> str:
    sign = int(np.sign(rounded))
    return "muted" if sign == exact else "waiting" if sign == 0 else "bad"


def _sign(value: int) -> str:
    return {1: "+", -1: "−", 0: "0"}[value]


# ---- the Voronoi diagram and its dual ------------------------------------------------------------

SITES: dict[str, list[list[float]]] = {
    "nine sites": [
        [0.4, 0.7],
        [2.1, 0.2],
        [3.6, 0.9],
        [0.9, 2.1],
        [2.3, 1.7],
        [3.9, 2.4],
        [0.2, 3.6],
        [1.9, 3.4],
        [3.3, 3.9],
    ],
    "four sites": [[0.3, 0.5], [3.5, 0.2], [3.0, 3.2], [0.8, 2.4]],
    "lattice: four on each circle": [[x, y] for y in (0.0, 2.0, 4.0) for x in (0.0, 2.0, 4.0)],
    "three neighbors, no triangle": [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [1.0, 1.0]],
    "vertices outside their triangles": [[0.0, 0.0], [1.0, 3.0], [2.0, 3.0], [3.0, 1.0]],
}


def voronoi_dual_state(fade: float, preset: str = "nine sites") -> fr.Frame:
    """The Voronoi diagram (``fade`` = 0) fading into its dual, the Delaunay triangulation (``fade`` = 1).

    Parameters
    ----------
    fade : float
        Between 0 and 1.
    preset : str
        A key of `SITES`.

    Returns
    -------
    dict
        A frame; its number counts triangles and corners of the diagram, which correspond one to one if no
        four sites lie on an empty circle.
    """
    sites = np.array(preset_named(SITES, preset))
    within("fade", fade, 0, 1)
    diagram = _diagram(preset)
    mesh = diagram.mesh
    view = fr.bounds([fr.frame("", fr.dots("vertex", sites))], 0.3)
    lines, nodes, _ = dual_segments(diagram, reach=4 * (view[1] - view[0]))
    strong, weak = 0.12 + 0.88 * fade, 1 - 0.88 * fade
    items = [
        fr.polygons("cell", mesh.corners, opacity=strong),
        fr.segments("edge", mesh.points[mesh.edges], opacity=strong),
        fr.segments("voronoi", lines, opacity=weak),
        fr.dots("voronoi", nodes, opacity=weak),
        fr.dots("vertex", sites),
        fr.labels("vertex", sites, range(len(sites))),
    ]
    number = f"{_many(mesh.size, 'triangle')}, {_many(len(nodes), 'corner')}"
    caption = "Sites and their cells" if fade < 0.34 else "Around each corner: triangles of its sites"
    caption = caption if fade < 0.67 else "The dual: the Delaunay triangulation"
    if preset.startswith("three"):
        items[2:2] = [
            fr.polygons("bad", [sites[:3]], opacity=strong),
            fr.circles("bad", [[2, 2]], [8**0.5], opacity=strong),
        ]
        caption = caption if fade < 0.67 else "0, 1, 2 are neighbors in pairs, but their circle contains 3"
    if preset.startswith("vertices"):
        lost = [k for k, v in enumerate(diagram.simplex_vertex) if not _inside(mesh.corners[k], nodes[v])]
        items.append(fr.dots("bad", nodes[diagram.simplex_vertex[lost]], opacity=weak))
        number += f", {len(lost)} outside its triangle"
    return fr.frame(caption, *items, number=number, view=view)


@lru_cache(maxsize=8)
def _diagram(preset: str) -> Voronoi:
    return Voronoi(delaunay(np.array(SITES[preset])))


def _inside(triangle: np.ndarray, point: np.ndarray) -> bool:
    sides = [np.array([triangle[k], triangle[(k + 1) % 3], point]) for k in range(3)]
    return bool((np.asarray(orient(np.array(sides))) >= 0).all())


def _many(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


# ---- Bowyer and Watson, step by step -------------------------------------------------------------

INSERTIONS: dict[str, dict[str, Any]] = {
    "seven points": {"points": [[0, 0], [4, 0.3], [1.8, 3.4], [2, 1.2], [3.6, 2.8], [0.4, 2.2], [1.2, 0.7]]},
    "lattice: ties": {
        "points": [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [1, 0], [2, 1], [1, 2], [0, 1]],
        "start": 4,
    },
    "nasty: not Delaunay at first": {
        "mesh": [[5, 1], [1, 2], [3, 0], [8, 0], [0, 0], [4, 8], [8, 7], [1, 8]],
        "points": [[7, 4.5], [3, 4]],
    },
}


@lru_cache(maxsize=4)
def _insertions(preset: str) -> tuple[fr.Frame, ...]:
    given = preset_named(INSERTIONS, preset)
    points = np.array(given["points"], dtype=float)
    if "mesh" in given:
        return tuple(baker_frames(sweep_triangulation(np.array(given["mesh"], dtype=float)), points))
    return tuple(insertion_frames(points, start=given.get("start")))


def bowyer_watson_history(preset: str = "seven points") -> list[fr.Frame]:
    """All frames of one of the histories in `INSERTIONS`: locate, cavity and star for each point."""
    return list(_insertions(preset))


def bowyer_watson_state(step: int, preset: str = "seven points") -> fr.Frame:
    """One frame of `bowyer_watson_history`; ``step`` starts at 0.

    Its number counts what the theorem relates: a cavity in the interior has k edges and k − 2 triangles,
    which are replaced by k new triangles.
    """
    history = _insertions(preset)
    within("step", step, 0, len(history) - 1)
    return history[step]
