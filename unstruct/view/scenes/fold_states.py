"""Two triangles folded at their common edge: its angles, and its plane-centered spheres, as frames."""

from __future__ import annotations

from fractions import Fraction
from math import acos, degrees, dist, radians, sqrt, tan
from typing import Any, NamedTuple

from ...base.errors import InputError
from ...plain import surface_delaunay as plain
from ..draw import frames as fr
from ..draw.items import item3
from .space_frames import space_frame

__all__ = ["FOLD_SHAPES", "Folded", "fold_state", "folded"]

# The triangle abc: the angle at c in degrees, and the turn of c on its circle, as the tangent of the half.
FOLD_SHAPES: dict[str, tuple[int, Fraction]] = {
    "acute at c": (60, Fraction(0)),
    "acute and slanted": (70, Fraction(1, 3)),
    "right at c": (90, Fraction(1, 4)),
    "obtuse at c": (110, Fraction(0)),
    "nasty: very obtuse": (130, Fraction(1, 5)),
}
SLANT_OF_D = Fraction(-1, 8)  # as the turns above
FOLD_ENDS = ((Fraction(0), Fraction(-1), Fraction(0)), (Fraction(0), Fraction(1), Fraction(0)))  # a and b
FINEST_TANGENT = 1000  # the largest denominator of tangents
FLAT_AT = 4.8  # how far to the right the unfolded triangles are drawn
FOLD_AZIMUTH, FOLD_ELEVATION = -25.0, 38.0
FOLD_WINDOW = [-2.3, 7.6, -2.75, 2.3]
STEPS_OF_PATH = 24
SHOWN_ZERO = 5e-3  # a distance that is shown as zero
Place = tuple[Fraction, Fraction, Fraction]


class Folded(NamedTuple):
    """Corners a, b, c, d in space, exactly; d unfolded; and what is true of the edge ab."""

    points: tuple[Place, ...]
    flat: Place
    legal: bool
    inside: tuple[bool, bool]  # d in the sphere of abc, c in the sphere of abd


def _tangent_of_half(angle: float) -> Fraction:
    """tan(angle / 2) as a fraction; those of two angles that add up to 180 degrees have the product 1."""
    if angle > 90:
        return 1 / _tangent_of_half(180 - angle)
    return Fraction(tan(radians(angle) / 2)).limit_denominator(FINEST_TANGENT)


def _turned(half: Fraction) -> tuple[Fraction, Fraction]:
    """Cosine and sine of an angle from the tangent of its half."""
    square = half * half
    return (1 - square) / (1 + square), 2 * half / (1 + square)


def _sees_edge(angle: float, turn: Fraction) -> tuple[Fraction, Fraction]:
    """Distance from the line ab, and place along it, of a point that sees ab under an angle.

    It is on the circle through a and b with the center at cot(angle).
    """
    height = 1 / _tangent_of_half(angle)
    center = (height - 1 / height) / 2
    cosine, sine = _turned(turn)
    return center + cosine * (height - center), sine * (height - center)


def folded(shape: str, angle_at_d: float, fold: float) -> Folded:
    """The pair of triangles abc and abd, with coordinates that are fractions, and its exact signs.

    Parameters
    ----------
    shape : str
        One of `FOLD_SHAPES`: the triangle abc.
    angle_at_d : float
        In degrees, more than 0 and less than 180.
    fold : float
        In degrees, from 0 (flat) to 180 (abd lies upon abc).
    """
    if shape not in FOLD_SHAPES:
        raise InputError(f"shape = {shape!r} must be one of {', '.join(map(repr, FOLD_SHAPES))}")
    if not 0 < angle_at_d < 180:
        raise InputError(f"angle_at_d = {angle_at_d} must be between 0 and 180 degrees")
    if not 0 <= fold <= 180:
        raise InputError(f"fold = {fold} must be from 0 to 180 degrees")
    zero = Fraction(0)
    c = (*_sees_edge(*FOLD_SHAPES[shape]), zero)
    high, along = _sees_edge(angle_at_d, SLANT_OF_D)
    cosine, sine = (Fraction(-1), zero) if fold == 180 else _turned(_tangent_of_half(fold))
    points = (*FOLD_ENDS, c, (-high * cosine, along, high * sine))
    rows = [(0, 1, 2), (1, 0, 3)]
    spheres = plain.is_surface_delaunay(points, rows)
    legal = plain.intrinsic(points, rows)[0, 1]
    return Folded(points, (-high, along, zero), legal, (3 in spheres[0], 2 in spheres[1]))


def _numbers(p: plain.Point) -> tuple[float, float, float]:
    x, y, z = map(float, p)
    return x, y, z


def _sphere(points: Any) -> tuple[float, float, float, float]:
    """Center and radius of the plane-centered sphere of three points."""
    center = plain.circumcenter(*points)
    out = plain.minus(points[0], center)
    return *_numbers(center), sqrt(plain.dot(out, out))


def _angle(corner: plain.Point) -> float:
    """The angle in degrees under which a point sees the edge ab."""
    u, v = (plain.minus(end, corner) for end in FOLD_ENDS)
    return degrees(acos(float(plain.dot(u, v)) / sqrt(plain.dot(u, u) * plain.dot(v, v))))


def _flat_items(c: Place, d: Place) -> list[fr.Item]:
    """The unfolded triangles with their circumcircles; a circle that contains the far corner is bad."""
    items, move = [], lambda p: (float(p[0]) + FLAT_AT, float(p[1]))
    for own, far in ((c, d), (d, c)):
        x, y, _, radius = _sphere((*FOLD_ENDS, own))
        inside = plain.inside((*FOLD_ENDS, own), far, plain.circumcenter(*FOLD_ENDS, own))
        items.append(fr.circles("bad" if inside else "circumcircle", [(x + FLAT_AT, y)], [radius]))
    a, b, c2, d2 = (move(p) for p in (*FOLD_ENDS, c, d))
    items.insert(0, fr.polygons("accepted", [[a, b, c2], [b, a, d2]], opacity=0.6))
    places = [a, b, c2, d2]
    return [*items, fr.segments("constrained", [(a, b)]), fr.dots("vertex", places),
            fr.labels("vertex", places, "abcd")]  # fmt: skip


def _said(pair: Folded, fold: float) -> str:
    """What the theorem says of this edge."""
    whose = ("d is inside of the sphere of abc", "c is inside of the sphere of abd")
    found = " and ".join(text for text, yes in zip(whose, pair.inside) if yes)
    if pair.legal:
        return f"legal by angles, {f'but {found}' if found else 'and no corner is inside of a sphere'}"
    if found:
        return f"illegal by angles, and {found}"
    return "illegal by angles, but no corner is inside: the triangles lie upon each other"


def fold_state(shape: str = "acute at c", angle_at_d: float = 130.0, fold: float = 45.0) -> fr.Frame:
    """Two triangles folded at their edge ab, with their spheres, and beside them the same pair unfolded.

    Parameters
    ----------
    shape, angle_at_d, fold
        As in `folded`.

    Returns
    -------
    dict
        Left the pair in space and its plane-centered spheres, right the pair in the plane and its circles; a
        sphere or a circle that contains the far corner is dashed red. The number is the sum of both angles,
        and how far the corner c or d that is deepest is inside of the other one's sphere, or outside.
    """
    pair = folded(shape, angle_at_d, fold)
    a, b, c, d = (_numbers(p) for p in pair.points)
    spheres = [_sphere((*pair.points[:2], own)) for own in pair.points[2:]]
    depth = max(ball[3] - dist(ball[:3], far) for ball, far in zip(spheres, (d, c)))
    high, along = -float(pair.flat[0]), float(pair.flat[1])
    turns = [_turned(Fraction(k, STEPS_OF_PATH)) for k in range(STEPS_OF_PATH)]
    quarter = [(float(x), float(y)) for x, y in turns]
    half = [*quarter, *((-y, x) for x, y in quarter), (-1.0, 0.0)]
    path = [(-high * x, along, high * y) for x, y in half]
    shown = [
        item3("polygons", "accepted", [(0, 1, 2), (1, 0, 3)], [a, b, c, d], opacity=0.6),
        item3("segments", "inserted", [(i, i + 1) for i in range(len(path) - 1)], path),
        item3("segments", "constrained", [(0, 1)], [a, b]),
        item3("points", "vertex", [a, b, c, d]),
        item3("labels", "vertex", [a, b, c, d], text="abcd"),
        *(item3("spheres", "bad" if inside else "circumcircle", [ball])
          for ball, inside in zip(spheres, pair.inside)),
    ]  # fmt: skip
    made = space_frame(shown, _said(pair, fold), azimuth=FOLD_AZIMUTH, elevation=FOLD_ELEVATION)
    made["items"] += _flat_items(pair.points[2], pair.flat)
    total = _angle(pair.points[2]) + _angle(pair.points[3])
    where = "on a sphere" if depth > -SHOWN_ZERO else f"{-depth:.2f} outside"
    where = f"{depth:.2f} inside" if any(pair.inside) else where
    made["number"] = f"γ + δ = {total:.0f}°; of c and d, the deeper is {where}"
    made["view"] = FOLD_WINDOW
    return made
