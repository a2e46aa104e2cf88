"""A wing, a body with a wing, and a bent duct, as closed surfaces of even triangles with names.

Every part is unrolled into a plane: the wing along its section, the body as a cylinder, its ends by
stereographic projection. So triangles that are round there are round in space, but for the stretch of the
ends. Halves and quarters are meshed once and mirrored.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.arguments import positive
from ..base.elementary import arcsine, cosines, sines
from ..base.errors import InputError
from ..domain.domain import Domain
from ..geometry.edge_vectors import lengths
from .surfaces import Patch, joined_patches, mirrored, patch_of, spread

__all__ = ["duct", "wing", "wing_body"]

Array = NDArray[np.float64]
SECTION_ROWS = 2048  # samples of half a section
FINER_NOSE, FINER_TAIL = 0.25, 0.5  # edges at the leading and the trailing edge; unit: the wanted length
GROWTH_ALONG = 0.5  # of lengths, away from them
THICKNESS_TERMS = (0.2969, -0.1260, -0.3516, 0.2843, -0.1036)  # NACA, with a sharp trailing edge
HALF_SPAN, TAPER, SWEEP, THICKNESS = 1.5, 0.5, 0.35, 0.14
RADIUS, FAR_BEFORE, FAR_BEHIND = 0.22, 0.6, 0.5  # of the body; its cylinder is longer than the chord
NOSE, TAIL = 1.6, 2.2  # lengths of the ends; unit: the radius


class Section(NamedTuple):
    """Half a section of chord 1: places along it, the coordinates there, and its length."""

    along: Array
    x: Array
    z: Array

    def at(self, s: Array) -> tuple[Array, Array]:
        """Coordinates at places s from the nose; exactly 0 high at both ends."""
        z = np.interp(s, self.along, self.z)
        return np.interp(s, self.along, self.x), z


def _section(thickness: float) -> Section:
    t = np.arange(SECTION_ROWS + 1) / SECTION_ROWS
    x = t * t  # dense at the nose
    a0, a1, a2, a3, a4 = THICKNESS_TERMS
    z = 5.0 * thickness * (a0 * t + x * (a1 + x * (a2 + x * (a3 + x * a4))))
    z[-1] = 0.0
    steps = lengths(np.column_stack([np.diff(x), np.diff(z)]))
    return Section(np.concatenate([[0.0], np.cumsum(steps)]), x, z)


def _chord(y: Array) -> tuple[Array, Array]:
    """Where the leading edge is, and the chord, at a place along the span."""
    return SWEEP * y, 1.0 + (TAPER - 1.0) / HALF_SPAN * y


class Upper(NamedTuple):
    """The upper side of half a wing, unrolled: (along the section, along the span)."""

    section: Section
    h: float

    def flat(self, s: Array, y: Array) -> Array:
        """The place in the plane of s (share of the section's length at chord 1) and y."""
        front, chord = _chord(y)
        return np.column_stack([front + chord * s, y])

    def space(self, s: Array, y: Array) -> Array:
        """The place in space."""
        x, z = self.section.at(s)
        front, chord = _chord(y)
        return np.column_stack([front + chord * x, y, chord * z])

    def place(self, flat: Array) -> Array:
        """From the plane to space."""
        front, chord = _chord(flat[:, 1])
        return self.space((flat[:, 0] - front) / chord, flat[:, 1])

    def across(self, chord: float) -> Array:
        """Places along the section at which it is cut, where the chord is given."""
        end = float(self.section.along[-1])

        def wanted(s: Array) -> Array:
            from_nose = FINER_NOSE + GROWTH_ALONG * s * chord / self.h
            from_tail = FINER_TAIL + GROWTH_ALONG * (end - s) * chord / self.h
            return self.h / chord * np.minimum(np.minimum(from_nose, from_tail), 1.0)

        return spread(0.0, end, wanted)

    def patches(self, root: tuple[Array, Array]) -> tuple[Patch, Array]:
        """The upper side and the tip from a root (s, y); and the points of the root in space."""
        s, y = root
        tip = self.across(TAPER)
        end = self.section.along[-1]
        h, tall = self.h, float(HALF_SPAN)
        nose = spread(float(y[0]), tall, lambda t: np.full(len(t), FINER_NOSE * h))[1:-1]
        tail = spread(float(y[-1]), tall, lambda t: np.full(len(t), FINER_TAIL * h))[1:-1]
        places = [
            (s, y),
            (np.full(len(tail), end), tail),
            (tip[::-1], np.full(len(tip), tall)),
            (np.zeros(len(nose)), nose[::-1]),
        ]
        ring = np.concatenate([self.flat(*p) for p in places])
        corners = np.concatenate([self.space(*p) for p in places])
        side = patch_of(ring, corners, self.place, "wing", h)
        return side, self.space(tip, np.full(len(tip), tall))


def _tip(upper: Array, h: float) -> Patch:
    """The plane tip, seen from larger y; its border is the upper edge and its mirror image."""
    lower = upper[-2:0:-1] * np.array([1.0, 1.0, -1.0])
    corners = np.concatenate([upper, lower])[::-1]
    ring = corners[:, [2, 0]]

    def place(flat: Array) -> Array:
        return np.column_stack([flat[:, 1], np.full(len(flat), HALF_SPAN), flat[:, 0]])

    return patch_of(ring[::-1], corners[::-1], place, "tip", h)


def wing(size: float = 0.05) -> Domain:
    """A tapered and swept wing with a sharp trailing edge and plane tips.

    Parameters
    ----------
    size : float
        The wanted edge length; edges are shorter by 4 at the leading edge, by 2 at the trailing edge. At most
        0.15, in units of the chord in the middle.

    Returns
    -------
    Domain
        Triangles, with the markers "wing" and "tip". The section is a NACA 0014; the span is 3 along y.
    """
    h = _small(size)
    half = Upper(_section(THICKNESS), h)
    s = half.across(1.0)
    side, edge = half.patches((s, np.zeros(len(s))))
    above_and_below = mirrored([side], 2)
    return joined_patches(mirrored([*above_and_below, _tip(edge, h)], 1))


def _small(size: float) -> float:
    h = positive(size, "size")
    if h > 0.15:
        raise InputError(f"size = {h:g} must be at most 0.15: the wing is 0.07 thick at its tip")
    return h


# ---------------------------------------------------------------------- a body with a wing


def wing_body(size: float = 0.05) -> Domain:
    """A round body with a wing at half its height; edges are shorter along the wing's edges.

    Parameters
    ----------
    size : float
        As for `wing`.

    Returns
    -------
    Domain
        Triangles, with the markers "wing", "tip" and "body". The wing is that of `wing`, cut where it meets
        the body, a cylinder with two ellipsoids as its ends.
    """
    h = _small(size)
    half = Upper(_section(THICKNESS), h)
    s = half.across(1.0)
    y = _root(half, s)
    side, edge = half.patches((s, y))
    root = half.space(s, y)
    root[:, 1] = np.sqrt(RADIUS * RADIUS - root[:, 2] * root[:, 2])
    side.points[: len(root)] = root
    quarter = _body(root, h)
    upper = mirrored([side, *quarter], 2)
    return joined_patches(mirrored([*upper, _tip(edge, h)], 1))


def _root(half: Upper, s: Array) -> Array:
    """Where the wing's lines along the span meet the cylinder: y^2 + z^2 is the square of its radius."""
    y = np.full(len(s), RADIUS)
    for _ in range(60):
        z = half.space(s, y)[:, 2]
        y = np.sqrt(RADIUS * RADIUS - z * z)
    return y


def _body(root: Array, h: float) -> list[Patch]:
    """A quarter of the body, y and z not negative: the cylinder, and both ends."""
    begin, end = root[0, 0] - FAR_BEFORE, root[-1, 0] + FAR_BEHIND
    quarter = RADIUS * np.pi / 2

    def near(x: Array) -> Array:
        before = FINER_NOSE * h + GROWTH_ALONG * (root[0, 0] - x)
        behind = FINER_TAIL * h + GROWTH_ALONG * (x - root[-1, 0])
        return np.minimum(np.maximum(before, behind), h)

    def constant(x: Array) -> Array:
        return np.full(len(x), h)

    front, back = spread(begin, root[0, 0], near), spread(root[-1, 0], end, near)
    top = spread(end, begin, constant)
    turn = spread(0.0, quarter, constant)[1:-1]
    around = np.concatenate([arcsine_of(root[:, 2] / RADIUS) * RADIUS])
    circle = np.column_stack([RADIUS * cosines(turn / RADIUS), RADIUS * sines(turn / RADIUS)])
    flat = [
        np.column_stack([front[:-1], np.zeros(len(front) - 1)]),
        np.column_stack([root[:, 0], around]),
        np.column_stack([back[1:], np.zeros(len(back) - 1)]),
        np.column_stack([np.full(len(turn), end), turn]),
        np.column_stack([top, np.full(len(top), quarter)]),
        np.column_stack([np.full(len(turn), begin), turn[::-1]]),
    ]
    zero, one = np.zeros, np.ones
    corners = [
        np.column_stack([front[:-1], RADIUS * one(len(front) - 1), zero(len(front) - 1)]),
        root,
        np.column_stack([back[1:], RADIUS * one(len(back) - 1), zero(len(back) - 1)]),
        np.column_stack([np.full(len(turn), end), circle]),
        np.column_stack([top, zero(len(top)), RADIUS * one(len(top))]),
        np.column_stack([np.full(len(turn), begin), circle[::-1]]),
    ]

    def rolled(x: Array) -> Array:
        angle = x[:, 1] / RADIUS
        return np.column_stack([x[:, 0], RADIUS * cosines(angle), RADIUS * sines(angle)])

    # seen from outside, x to the right and the angle upward run clockwise
    ring, around_ = np.concatenate(flat), np.concatenate(corners)
    middle = _turned(patch_of(ring, around_, rolled, "body", h))
    arc = np.concatenate([[[RADIUS, 0.0]], circle, [[0.0, RADIUS]]])
    return [middle, _end(arc, begin, -NOSE, h), _end(arc, end, TAIL, h)]


def arcsine_of(x: Array) -> Array:
    """The arcsine of each number."""
    return np.array([arcsine(v) for v in x.tolist()])


def _turned(patch: Patch) -> Patch:
    return Patch(patch.points, patch.triangles[:, ::-1], patch.name)


def _end(arc: Array, x: float, length: float, h: float) -> Patch:
    """A quarter of an ellipsoid beyond a circle, by stereographic projection from its other end."""

    def wanted(rho: Array) -> Array:
        return h * (1.0 + rho * rho) / (2.0 * RADIUS)

    def place(w: Array) -> Array:
        square = (w * w).sum(axis=1)
        round_ = 2.0 * RADIUS * w / (1.0 + square)[:, None]
        return np.column_stack([x + length * RADIUS * (1.0 - square) / (1.0 + square), round_])

    legs = spread(0.0, 1.0, wanted)[1:-1]
    zero = np.zeros(len(legs))
    ring = np.concatenate(
        [
            [[0.0, 0.0]],
            np.column_stack([legs, zero]),
            arc / RADIUS,
            np.column_stack([zero, legs[::-1]]),
        ]
    )
    corners = place(ring)
    first = 1 + len(legs)
    corners[first : first + len(arc)] = np.column_stack([np.full(len(arc), x), arc])
    patch = patch_of(ring, corners, place, "body", h / RADIUS)
    return patch if length > 0 else _turned(patch)


# ---------------------------------------------------------------------- a duct


def duct(size: float = 0.1, *, radius: float = 0.5, bend: float = 1.5) -> Domain:
    """A round duct with a bend of 90 degrees between two straight parts, for layers inside.

    Parameters
    ----------
    size : float
        The wanted edge length.
    radius : float
    bend : float
        The radius of the bend, larger than that of the duct. Straight parts are as long.

    Returns
    -------
    Domain
        Triangles, with the markers "wall", "inlet" (in the plane z = 0) and "outlet" (in a plane of x).
    """
    h, r, far = positive(size, "size"), positive(radius, "radius"), positive(bend, "bend")
    if r >= far:
        raise InputError(f"radius = {r:g} must be less than bend = {far:g}")
    quarter = far * np.pi / 2
    tube = Domain.cylinder((0, 0, 0), (0, 0, 2 * far + quarter), r, size=h)
    x, y, s = tube.points.T
    angle = np.clip((s - far) / far, 0.0, np.pi / 2)
    c, d = cosines(angle), sines(angle)
    outlet = angle >= np.pi / 2
    c[outlet], d[outlet] = 0.0, 1.0
    before, beyond = np.minimum(s, far), np.maximum(s - far - quarter, 0.0)
    points = np.column_stack([far - (far - x) * c + beyond * d, y, before + (far - x) * d])
    names = {"wall": "side", "inlet": "bottom", "outlet": "top"}
    markers = {name: tube.markers[old] for name, old in names.items()}
    return Domain(points, tube.facets, markers=markers)
