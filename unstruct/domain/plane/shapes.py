"""Ready-made regions: polygons, discs, smooth closed curves, airfoils, letters.

Each function gives the arguments of a `Domain`: points, facets, and options. See the book, chapter 2.6d.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from math import pi, radians
from typing import Any

import numpy as np

from ...base.arguments import finite, positive
from ...base.arrays import as_points
from ...base.elementary import cosine, sine
from ...base.errors import InputError
from ...base.jit import kernel
from ...base.optional import optional
from ...geometry.curves import Arc, Bezier, Curve, CurveLike
from ..arguments import around, as_ring

__all__ = ["Parts", "airfoil", "disc", "letters", "rectangle", "rings"]

Parts = dict[str, Any]  # points, facets, and further arguments of `Domain`


def _pair(value: Any, name: str) -> tuple[float, float]:
    """Two coordinates, or an error that names the argument."""
    rows = as_points([value], name) if np.ndim(value) == 1 else np.empty((1, 0))
    if rows.shape[1] != 2:
        raise InputError(f"{name} must be two coordinates, not {value!r}")
    return float(rows[0, 0]), float(rows[0, 1])


def ring_names(holes: Any) -> list[str]:
    """What messages call the outer ring and the holes of a polygon."""
    if not isinstance(holes, Iterable):
        raise InputError(f"holes must be a sequence of rings, not {holes!r}")
    return ["outer", *(f"holes[{i}]" for i, _ in enumerate(holes))]


def rings(outer: Any, holes: Sequence[Any], least: int = 3) -> Parts:
    """A polygon with holes: points and facets along the rings, which have at least so many corners.

    A single corner becomes two equal ones, for ``resolve=True`` to drop with an account.
    """
    found = [as_ring(ring, name, least) for name, ring in zip(ring_names(holes), [outer, *holes])]
    found = [np.repeat(ring, 2, axis=0) if len(ring) == 1 else ring for ring in found]
    start = np.cumsum([0] + [len(ring) for ring in found])
    facets = [around(first, len(ring)) for first, ring in zip(start, found)]
    return {"points": np.concatenate(found), "facets": np.concatenate(facets)}


def rectangle(lower: Any, upper: Any) -> Parts:
    """A rectangle; its sides are the pieces bottom, right, top, left, with markers of these names."""
    (x0, y0), (x1, y1) = _pair(lower, "lower"), _pair(upper, "upper")
    if not (x0 < x1 and y0 < y1):
        raise InputError(f"lower {[x0, y0]} must be less than upper {[x1, y1]} in both coordinates")
    markers = {name: [i] for i, name in enumerate(("bottom", "right", "top", "left"))}
    return {"points": [[x0, y0], [x1, y0], [x1, y1], [x0, y1]], "facets": around(0, 4), "markers": markers}


def disc(center: Any, radius: float) -> Parts:
    """A disc, bounded by four arcs."""
    (x, y), r = _pair(center, "center"), positive(radius, "radius")
    points = [[x + r, y], [x, y + r], [x - r, y], [x, y - r]]
    arcs = {i: Arc((x, y), r, i * pi / 2, pi / 2) for i in range(4)}
    return {"points": points, "facets": around(0, 4), "curves": arcs}


# ---------------------------------------------------------------------- airfoils


def airfoil(digits: str, chord: float, nose: Any, attack: float, closed: bool) -> Parts:
    """A NACA four-digit section as two curves, trailing edge to nose and back; see `Domain.naca`."""
    if not (isinstance(digits, str) and len(digits) == 4 and digits.isdigit()):
        raise InputError(f"a four-digit section is named by a string such as '2412', not {digits!r}")
    camber, place, thickness = int(digits[0]) / 100, int(digits[1]) / 10, int(digits[2:]) / 100
    if thickness == 0 or (camber > 0) != (place > 0):
        raise InputError(
            f"NACA {digits}: the thickness must not be 0, and camber and its place must come together: both "
            "0 or neither"
        )
    (x0, y0), c, turn = _pair(nose, "nose"), positive(chord, "chord"), radians(finite(attack, "attack"))
    move = np.array([[cosine(turn), -sine(turn)], [sine(turn), cosine(turn)]])
    section = (camber, place, thickness, -0.1036 if closed else -0.1015)
    skin = partial(_skin, section, c, move, (x0, y0))  # made of a function of the module, to be pickled
    tail = skin(np.array([pi, -pi]))
    upper, lower = Curve(skin, pi, 0.0), Curve(skin, 0.0, -pi)
    if closed:
        points = [skin(np.array([pi]))[0], [x0, y0]]
        facets, names = [[0, 1], [1, 0]], {"upper": [0], "lower": [1]}
    else:
        points = [tail[0], [x0, y0], tail[1]]
        facets, names = [[0, 1], [1, 2], [2, 0]], {"upper": [0], "lower": [1], "trailing edge": [2]}
    return {"points": points, "facets": facets, "curves": {0: upper, 1: lower}, "markers": names}


def _skin(
    section: tuple[float, float, float, float],
    chord: float,
    move: np.ndarray,
    nose: tuple[float, float],
    angle: np.ndarray,
) -> np.ndarray:
    """Points of the surface, turned and moved to their place."""
    made = np.empty((angle.size, 2))
    _surface(section, chord, move, nose, np.ascontiguousarray(angle, dtype=np.float64).ravel(), made)
    return made.reshape(*angle.shape, 2)


@kernel
def _surface(section, chord, move, nose, angle, made):
    """Write points of the surface for angles from pi (tail) over 0 (nose) to -pi.

    x = sin^2(angle / 2) makes the curve smooth at the nose.
    """
    camber, place, thickness, last = section
    for i in range(angle.shape[0]):
        root = abs(sine(angle[i] / 2))
        x = root * root
        half = 5 * thickness * (0.2969 * root + x * (-0.1260 + x * (-0.3516 + x * (0.2843 + x * last))))
        y, slope = 0.0, 0.0
        if camber != 0.0:
            front = x < place
            part = place if front else 1 - place
            scale = camber / (part * part)
            y = scale * ((0.0 if front else 1 - 2 * place) + 2 * place * x - x * x)
            slope = 2 * scale * (place - x)
        side = (-half if angle[i] < 0 else half) / math.hypot(1.0, slope)
        u, v = chord * (x - side * slope), chord * (y + side)
        for k in range(2):
            made[i, k] = u * move[0, k] + v * move[1, k] + nose[k]


# ---------------------------------------------------------------------- letters


def letters(text: str, size: float, font: str) -> Parts:
    """The outlines of a text, with their Bezier curves as the font has them; see `Domain.letters`."""
    if not (isinstance(text, str) and text.strip()):  # matplotlib fails on these
        raise InputError(f"the text {text!r} has no outline: give at least one visible letter")
    fonts = optional("matplotlib.font_manager", "Domain.letters")
    paths = optional("matplotlib.textpath", "Domain.letters")
    path = paths.TextPath((0, 0), text, size=positive(size, "size"), prop=fonts.FontProperties(family=font))
    points: list[list[float]] = []
    facets: list[list[int]] = []
    curves: dict[int, CurveLike] = {}
    for controls in _contours(path):
        first = len(points)
        points += [piece[0].tolist() for piece in controls]
        for i, piece in enumerate(controls):
            if len(piece) > 2:
                curves[len(facets)] = Bezier(piece)
            facets.append([first + i, first + (i + 1) % len(controls)])
    if not facets:
        raise InputError(f"the text {text!r} has no outline: give at least one visible letter")
    return {"points": points, "facets": facets, "curves": curves}


def _contours(path: Any) -> Iterator[list[np.ndarray]]:
    """Closed contours as lists of control points; each piece begins at the end of the piece before."""
    contour: list[np.ndarray] = []
    at = np.zeros(2)
    degree = {path.LINETO: 1, path.CURVE3: 2, path.CURVE4: 3}
    codes, vertices = path.codes.tolist(), path.vertices
    i = 0
    while i <= len(codes):
        code = codes[i] if i < len(codes) else path.MOVETO
        if code in degree:
            piece = np.concatenate([[at], vertices[i : i + degree[code]]])
            at = piece[-1]
            if (piece != piece[0]).any():
                contour.append(piece)
            i += degree[code]
            continue
        if contour:
            if (at != contour[0][0]).any():
                contour.append(np.array([at, contour[0][0]]))
            else:
                contour[-1][-1] = contour[0][0]
            yield contour
            contour = []
        at = vertices[i] if i < len(codes) else at
        i += 1
