"""The Jacobian of linear cells, as Bernstein coefficients, and its sign over the whole cell: exact.

A quadrilateral, pyramid, wedge or hexahedron is the image of a square, ..., cube under the bilinear, ...,
trilinear map of its corners (in VTK's order, see `unstruct.mesh.cells`); the cell is good when the Jacobian
of that map is positive everywhere. In Bernstein form the Jacobian lies between its least and its greatest
coefficient, and equals the coefficients at the corners. For the three simple kinds this decides:

* quadrilateral: J is affine, because the product of the two mixed terms vanishes: four corners decide.
* pyramid, x = (1 - t) Q(u, v) + t apex: J = (1 - t)^2 D(u, v), and expanding the determinant
  D = det(Q_u, Q_v, apex - Q) with Q = p + e u + f v + g u v, w = apex - p, leaves
  D = det(e, f, w) + u det(e, g, w) + v det(g, f, w) + u v det(e, f, g): bilinear, so that its four corners
  decide. (At the apex itself J is 0 for every pyramid; it is left out.)
* wedge, x = sum l_i (p_i + t v_i): J = A(t) . sum l_i v_i with A(t) = (e + t e') x (f + t f'), linear in l.
  It is positive everywhere exactly when the three quadratics A(t) . v_i are positive on [0, 1], that is, with
  Bernstein coefficients b0, b1, b2: b0 > 0, b2 > 0, and b1 >= 0 or b1^2 < b0 b2.
* hexahedron: J has degree 2 in each variable, 27 coefficients. Positive ones suffice; where they do not
  decide, the cube is halved again and again, in one direction after the other (de Casteljau). A cell is
  bad as soon as the Jacobian is not positive at a corner of some part. Only where its least value inside is
  0, or some 2^-60 of the greatest, the budget ends before that: such cells are reported as undecided.

All is done in doubles with a bound on their error, and what that does not decide in integers, without
rounding: every double is an integer times a power of two. See the book, 12.5; for hexahedra in Bernstein form
A. Johnen, J.-C. Weill, J.-F. Remacle, *Robust and efficient validation of the linear hexahedral element*,
Procedia Engineering 203 (2017) 271-283.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import comb

import numpy as np

from ..predicates.filters import TINY, UNDECIDED

__all__ = [
    "COEFFICIENTS",
    "content_signs",
    "hexahedron_signs",
    "integers",
    "pyramid_signs",
    "signs_of",
    "wedge_signs",
]

JACOBIANS_PER_PART = 1 << 13  # cells at a time: their coefficients stay in the cache
ERROR = 2.0**-42  # of the product of the extents of a cell: far above the rounding of any coefficient
LEVELS = {True: 96, False: 24}  # halvings of a hexahedron, in integers and in doubles
BOXES = 1024  # parts of one hexahedron, above which it is left undecided


def _cross(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    x, y, z = a[..., 1] * b[..., 2], a[..., 2] * b[..., 0], a[..., 0] * b[..., 1]
    return x - a[..., 2] * b[..., 1], y - a[..., 0] * b[..., 2], z - a[..., 1] * b[..., 0]


def _dot(n: tuple[np.ndarray, np.ndarray, np.ndarray], v: np.ndarray) -> np.ndarray:
    return n[0] * v[..., 0] + n[1] * v[..., 1] + n[2] * v[..., 2]


def ring_coefficients(x: np.ndarray) -> np.ndarray:
    """Cross products p_0 p_i x p_0 p_i+1 of polygons (m, c, 2): their sum is twice the area."""
    rows = x[:, 1:] - x[:, :1]
    return rows[:, :-1, 0] * rows[:, 1:, 1] - rows[:, :-1, 1] * rows[:, 1:, 0]


def pyramid_coefficients(x: np.ndarray) -> np.ndarray:
    """D at the corners of the base (see the top of this module): (m, 4)."""
    base = [
        _dot(_cross(x[:, (i + 1) % 4] - x[:, i], x[:, (i + 3) % 4] - x[:, i]), x[:, 4] - x[:, i])
        for i in range(4)
    ]
    return np.stack(base, axis=1)


def wedge_coefficients(x: np.ndarray) -> np.ndarray:
    """2 b0, 2 b1, 2 b2 of the quadratics A(t) . v_i: (m, 3 corners, 3)."""
    e, f = (x[:, i] - x[:, 0] for i in (1, 2))
    other_e, other_f = (x[:, i] - x[:, 3] for i in (4, 5))
    low, high = _cross(e, f), _cross(other_e, other_f)
    one, two = _cross(e, other_f), _cross(other_e, f)
    heights = [x[:, i + 3] - x[:, i] for i in range(3)]
    rows = [
        np.stack([2 * _dot(low, v), _dot(one, v) + _dot(two, v), 2 * _dot(high, v)], axis=1) for v in heights
    ]
    return np.stack(rows, axis=1)


def hexahedron_coefficients(x: np.ndarray) -> np.ndarray:
    """8 times the 27 Bernstein coefficients of the Jacobian: (m, 3, 3, 3)."""
    p = x[:, [[[0, 4], [3, 7]], [[1, 5], [2, 6]]]]  # by directions: p[:, i, j, k]
    u, v, w = p[:, 1] - p[:, 0], p[:, :, 1] - p[:, :, 0], p[:, :, :, 1] - p[:, :, :, 0]
    result = np.zeros((len(x), 3, 3, 3), dtype=x.dtype)
    for i1, k2, i2, j2 in product((0, 1), repeat=4):
        normal = _cross(v[:, i1, k2], w[:, i2, j2])
        for j1, k1 in product((0, 1), repeat=2):
            place = (i1 + i2, j1 + j2, k1 + k2)
            weight = 8 // (comb(2, place[0]) * comb(2, place[1]) * comb(2, place[2]))
            result[:, place[0], place[1], place[2]] += weight * _dot(normal, u[:, j1, k1])
    return result


COEFFICIENTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "quad": ring_coefficients,
    "polygon": ring_coefficients,
    "pyramid": pyramid_coefficients,
    "wedge": wedge_coefficients,
    "hexahedron": hexahedron_coefficients,
}


# ---------------------------------------------------------------------- doubles first, integers after


def integers(corners: np.ndarray) -> np.ndarray:
    """The coordinates of each cell (m, c, d) as Python integers, in units of a power of two of its own."""
    fraction, exponent = np.frexp(corners)
    whole = np.ldexp(fraction, 53).astype(np.int64)
    exponent = np.where(whole == 0, np.iinfo(np.int32).max, exponent)
    shift = exponent - exponent.min(axis=(1, 2))[:, None, None]
    return whole.astype(object) << np.where(whole == 0, 0, shift).astype(object)


def _scaled(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cells scaled by powers of two to coordinates of at most 1, and the bounds of their coefficients."""
    largest = np.abs(corners).max(axis=(1, 2))
    x = corners * np.ldexp(1.0, np.minimum(-np.frexp(largest)[1], 1023))[:, None, None]
    extent = (x.max(axis=1) - x.min(axis=1)).prod(axis=1)
    return x, ERROR * x.shape[1] * extent + TINY


def signs_of(corners: np.ndarray, decide: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Signs of cells by a rule that is first given doubles and bounds of error, then integers and 0.

    Parameters
    ----------
    corners : ndarray, shape (m, c, d)
    decide : function of (x, bound)
        ``x`` (r, c, d) are the corners of some cells, up to a positive factor of each; coefficients made of
        them are wrong by at most ``bound`` (r,). Returns -1, 0, 1, or 2 for what is not decided.

    Returns
    -------
    ndarray of int8, shape (m,)
    """
    signs = np.empty(len(corners), dtype=np.int8)
    for i in range(0, len(corners), JACOBIANS_PER_PART):
        part = corners[i : i + JACOBIANS_PER_PART]
        found = decide(*_scaled(part))
        rest = np.nonzero(found == UNDECIDED)[0]
        if len(rest):
            found[rest] = decide(integers(part[rest]), np.zeros(len(rest), dtype=np.int64))
        signs[i : i + JACOBIANS_PER_PART] = found
    return signs


def _simple(low: np.ndarray, high: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """1 where the least value is positive, -1 where the greatest is negative, 0 where neither can be."""
    signs = np.full(len(low), UNDECIDED, dtype=np.int8)
    signs[(low <= -bound) & (high >= bound)] = 0
    signs[low > bound] = 1
    signs[high < -bound] = -1
    return signs


def content_signs(kind: str, corners: np.ndarray) -> np.ndarray:
    """The sign of the area or volume: of the Jacobian's integral over the cell.

    Parameters
    ----------
    kind : str
        A key of `COEFFICIENTS`. For "polygon" all have the same number of corners.
    corners : ndarray, shape (m, c, d)

    Returns
    -------
    ndarray of int8, shape (m,)
    """
    # All Bernstein polynomials of one degree have the same integral, so that the plain sum does; that of
    # faces which are not plane is taken as the bilinear patch's.
    coefficients = COEFFICIENTS[kind]

    def decide(x: np.ndarray, bound: np.ndarray) -> np.ndarray:
        rows = coefficients(x).reshape(len(x), -1)
        total = rows.sum(axis=1)
        return _simple(total, total, rows.shape[1] * bound)

    return signs_of(corners, decide)


def pyramid_signs(corners: np.ndarray) -> np.ndarray:
    """Sign of the Jacobian over pyramids, shape (m, 5, 3), the apex left out: as `wedge_signs`."""

    def decide(x: np.ndarray, bound: np.ndarray) -> np.ndarray:
        rows = pyramid_coefficients(x)
        return _simple(rows.min(axis=1), rows.max(axis=1), bound)

    return signs_of(corners, decide)


def wedge_signs(corners: np.ndarray) -> np.ndarray:
    """Sign of the Jacobian over wedges.

    Parameters
    ----------
    corners : ndarray, shape (m, 6, 3)

    Returns
    -------
    ndarray of int8, shape (m,)
        1 where it is positive on the whole closed cell, -1 where negative, 0 else: exact.
    """
    return signs_of(corners, _decide_wedges)


def _decide_wedges(x: np.ndarray, bound: np.ndarray) -> np.ndarray:
    rows = wedge_coefficients(x)
    ends = rows[:, :, ::2].reshape(len(x), 6)
    signs = _simple(ends.min(axis=1), ends.max(axis=1), bound)
    for s in (-1, 1):  # the ends agree: now the quadratics between them
        cells = np.nonzero(signs == s)[0]
        b0, b1, b2 = (s * rows[cells, :, i] for i in range(3))
        error = bound[cells, None]
        # The computed difference is off by three errors times the coefficients, and by its own rounding.
        slack = error * (4 * (abs(b0) + abs(b1) + abs(b2)) + 4)
        gap = b0 * b2 - b1 * b1
        good = ((b1 >= error) | (gap > slack)).all(axis=1)
        bad = ((b1 < -error) & (gap <= -slack)).any(axis=1)
        signs[cells] = np.where(good, s, np.where(bad, 0, UNDECIDED))
    return signs


# ---------------------------------------------------------------------- hexahedra


def hexahedron_signs(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sign of the Jacobian over hexahedra.

    Parameters
    ----------
    corners : ndarray, shape (m, 8, 3)

    Returns
    -------
    signs : ndarray of int8, shape (m,)
        1 where it is positive on the whole closed cell, -1 where negative, 0 else.
    undecided : ndarray of bool, shape (m,)
        Where the budget did not suffice to tell; the sign is then 0.
    """
    signs = signs_of(corners, _decide_hexahedra)
    undecided = signs == UNDECIDED
    return np.where(undecided, 0, signs).astype(np.int8), undecided


def _decide_hexahedra(x: np.ndarray, bound: np.ndarray) -> np.ndarray:
    rows = hexahedron_coefficients(x)
    every, ends = rows.reshape(len(x), 27), rows[:, ::2, ::2, ::2].reshape(len(x), 8)
    signs = _simple(ends.min(axis=1), ends.max(axis=1), bound)
    clear = _simple(every.min(axis=1), every.max(axis=1), bound)
    rest = np.nonzero(np.isin(signs, (-1, 1)) & (signs != clear))[0]
    if len(rest):
        # Factors of Python's own integers where the coefficients are such.
        turn = signs[rest].astype(x.dtype)[:, None, None, None]
        good = _halve(rows[rest] * turn, bound[rest])
        signs[rest] = np.where(good == 1, signs[rest], good)
    return signs


def _halve(boxes: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Whether the Jacobian is positive on each cube, 1 or 0, by halving; 2 where the budget ends.

    Halves are multiplied by 4, so that integers remain integers, and so are the bounds.
    """
    exact = boxes.dtype == object
    found = np.ones(len(boxes), dtype=np.int8)
    owner = np.arange(len(boxes))
    bound = bound.astype(boxes.dtype)
    for level in range(LEVELS[exact]):
        a, b, c = np.moveaxis(boxes, 1 + level % 3, 0)
        middle = a + 2 * b + c
        left, right = ([4 * a, 2 * (a + b), middle], [middle, 2 * (b + c), 4 * c])
        boxes = np.concatenate([np.moveaxis(np.stack(half), 0, 1 + level % 3) for half in (left, right)])
        bound, owner = 4 * np.concatenate([bound, bound]), np.concatenate([owner, owner])
        if not exact:  # the rounding of the halving itself, with room
            bound = bound * (1 + 2.0**-5)
        ends = boxes[:, ::2, ::2, ::2].reshape(len(boxes), 8).min(axis=1)
        found[owner[ends <= -bound]] = 0
        every = boxes.reshape(len(boxes), 27).min(axis=1)
        left_over = (every <= bound) & (found[owner] == 1)
        many = np.bincount(owner[left_over], minlength=len(found)) > BOXES
        found[many] = UNDECIDED
        keep = left_over & ~many[owner]
        boxes, bound, owner = boxes[keep], bound[keep], owner[keep]
        if len(boxes) == 0:
            return found
    found[owner] = UNDECIDED
    return found
