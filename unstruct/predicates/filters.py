"""Floating-point filters: the sign of a determinant, if a bound on its rounding error decides it.

Each filter evaluates its determinant together with the same expression in absolute values, which is called
the *permanent*. A small multiple of the permanent bounds the rounding error (Shewchuk, *Adaptive precision
floating-point arithmetic and fast robust geometric predicates*, 1997, stage A). The order of evaluation is
Shewchuk's, because his constants depend on it. Coordinates are at most 1 in magnitude, so that the effect
of underflow stays far below ``TINY``.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.jit import inline, kernel

EPS = 2.0**-53
ORIENT2_BOUND = (3 + 16 * EPS) * EPS
INCIRCLE_BOUND = (10 + 96 * EPS) * EPS
ORIENT3_BOUND = (7 + 56 * EPS) * EPS
INSPHERE_BOUND = (16 + 224 * EPS) * EPS
BALL_BOUND = 21 * INSPHERE_BOUND  # see `filter_balls`
TINY = 1e-300  # with |coordinates| <= 1, underflow changes no determinant by more than 2**-1060
UNDECIDED = 2  # the fourth possible result, besides -1, 0 and 1


@inline
def filter_orient2(ax, ay, bx, by, cx, cy):
    """`orient2` if floating point decides it, otherwise UNDECIDED."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    bound = ORIENT2_BOUND * (abs(left) + abs(right)) + TINY
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return UNDECIDED


@inline
def filter_incircle(ax, ay, bx, by, cx, cy, px, py):
    """`incircle` if floating point decides it, otherwise UNDECIDED."""
    adx, ady, bdx, bdy, cdx, cdy = ax - px, ay - py, bx - px, by - py, cx - px, cy - py
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    alift, blift, clift = adx * adx + ady * ady, bdx * bdx + bdy * bdy, cdx * cdx + cdy * cdy
    det = alift * (bc - cb) + blift * (ca - ac) + clift * (ab - ba)
    permanent = (abs(bc) + abs(cb)) * alift + (abs(ca) + abs(ac)) * blift + (abs(ab) + abs(ba)) * clift
    bound = INCIRCLE_BOUND * permanent + TINY
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return UNDECIDED


@inline
def filter_orient3(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """`orient3` if floating point decides it, otherwise UNDECIDED."""
    adx, ady, adz = ax - dx, ay - dy, az - dz
    bdx, bdy, bdz = bx - dx, by - dy, bz - dz
    cdx, cdy, cdz = cx - dx, cy - dy, cz - dz
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    det = adz * (bc - cb) + bdz * (ca - ac) + cdz * (ab - ba)
    permanent = (
        (abs(bc) + abs(cb)) * abs(adz) + (abs(ca) + abs(ac)) * abs(bdz) + (abs(ab) + abs(ba)) * abs(cdz)
    )
    bound = ORIENT3_BOUND * permanent + TINY
    if det > bound:
        return -1  # rows a - d, b - d, c - d are those of the opposite orientation
    if det < -bound:
        return 1
    return UNDECIDED


@inline
def filter_insphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, px, py, pz):
    """`insphere` if floating point decides it, otherwise UNDECIDED."""
    aex, aey, aez = ax - px, ay - py, az - pz
    bex, bey, bez = bx - px, by - py, bz - pz
    cex, cey, cez = cx - px, cy - py, cz - pz
    dex, dey, dez = dx - px, dy - py, dz - pz
    aexbey, bexaey = aex * bey, bex * aey
    bexcey, cexbey = bex * cey, cex * bey
    cexdey, dexcey = cex * dey, dex * cey
    dexaey, aexdey = dex * aey, aex * dey
    aexcey, cexaey = aex * cey, cex * aey
    bexdey, dexbey = bex * dey, dex * bey
    ab, bc, cd = aexbey - bexaey, bexcey - cexbey, cexdey - dexcey
    da, ac, bd = dexaey - aexdey, aexcey - cexaey, bexdey - dexbey
    abc = aez * bc - bez * ac + cez * ab
    bcd = bez * cd - cez * bd + dez * bc
    cda = cez * da + dez * ac + aez * cd
    dab = dez * ab + aez * bd + bez * da
    alift, blift = aex * aex + aey * aey + aez * aez, bex * bex + bey * bey + bez * bez
    clift, dlift = cex * cex + cey * cey + cez * cez, dex * dex + dey * dey + dez * dez
    det = (dlift * abc - clift * dab) + (blift * cda - alift * bcd)
    aez, bez, cez, dez = abs(aez), abs(bez), abs(cez), abs(dez)
    ab, bc, cd = abs(aexbey) + abs(bexaey), abs(bexcey) + abs(cexbey), abs(cexdey) + abs(dexcey)
    da, ac, bd = abs(dexaey) + abs(aexdey), abs(aexcey) + abs(cexaey), abs(bexdey) + abs(dexbey)
    permanent = (
        (cd * bez + bd * cez + bc * dez) * alift
        + (da * cez + ac * dez + cd * aez) * blift
        + (ab * dez + bd * aez + da * bez) * clift
        + (bc * aez + ac * bez + ab * cez) * dlift
    )
    bound = INSPHERE_BOUND * permanent + TINY
    if det > bound:
        return -1
    if det < -bound:
        return 1
    return UNDECIDED


@inline
def filter_balls(corners, count, px, py, pz, dets, bounds):
    """Determinants of `filter_insphere` for many cells, and bounds on their errors, to be compared.

    Column i of ``corners`` (12, most) has the coordinates of cell i. If ``abs(dets[i]) > bounds[i]``, p is
    inside the ball of positively oriented cell i where ``dets[i] < 0``, outside where it is positive.

    There is no branch in the loop, so that the compiler makes vector instructions of it; each operation
    rounds as it does alone. The bound is a larger one than that of `filter_insphere`, for half its work. If r
    is the largest distance from p to a corner, the absolute values of a row sum up to at most sqrt(3) r. So
    the permanent of three rows is at most 3 sqrt(3) r^3, and the whole permanent 12 sqrt(3) r^5 < 20.8 r^5.
    """
    for i in range(count):
        aex, aey, aez = corners[0, i] - px, corners[1, i] - py, corners[2, i] - pz
        bex, bey, bez = corners[3, i] - px, corners[4, i] - py, corners[5, i] - pz
        cex, cey, cez = corners[6, i] - px, corners[7, i] - py, corners[8, i] - pz
        dex, dey, dez = corners[9, i] - px, corners[10, i] - py, corners[11, i] - pz
        ab, bc, cd = aex * bey - bex * aey, bex * cey - cex * bey, cex * dey - dex * cey
        da, ac, bd = dex * aey - aex * dey, aex * cey - cex * aey, bex * dey - dex * bey
        abc = aez * bc - bez * ac + cez * ab
        bcd = bez * cd - cez * bd + dez * bc
        cda = cez * da + dez * ac + aez * cd
        dab = dez * ab + aez * bd + bez * da
        alift, blift = aex * aex + aey * aey + aez * aez, bex * bex + bey * bey + bez * bez
        clift, dlift = cex * cex + cey * cey + cez * cez, dex * dex + dey * dey + dez * dez
        dets[i] = (dlift * abc - clift * dab) + (blift * cda - alift * bcd)
        square = max(max(alift, blift), max(clift, dlift))
        bounds[i] = BALL_BOUND * (square * square * math.sqrt(square)) + TINY


@kernel
def _determinant_and_permanent(a, size):
    """A determinant by minors over subsets of columns, and the same sum with absolute values."""
    det, permanent = np.empty(1 << size), np.empty(1 << size)
    for subset in range(1 << size):
        det[subset] = permanent[subset] = 0.0
    det[0] = permanent[0] = 1.0
    for subset in range(1, 1 << size):
        row = -1
        for j in range(size):
            row += (subset >> j) & 1
        above = 0  # the number of chosen columns to the right of j, which gives the sign of the minor
        for j in range(size - 1, -1, -1):
            if (subset >> j) & 1:
                rest = subset ^ (1 << j)
                term = a[row, j] * det[rest]
                det[subset] += -term if above & 1 else term
                permanent[subset] += abs(a[row, j]) * permanent[rest]
                above += 1
    return det[-1], permanent[-1]


@kernel
def filter_orient(simplex):
    """Sign of the determinant of rows p_i - p_0, or UNDECIDED, for any d; |coordinates| <= 1."""
    d = simplex.shape[1]
    rows = np.empty((d, d))
    for i in range(d):
        for j in range(d):
            rows[i, j] = simplex[i + 1, j] - simplex[0, j]
    det, permanent = _determinant_and_permanent(rows, d)
    # Each product of the expansion has the errors of d differences, of d multiplications, and of at most
    # d(d-1)/2 additions.
    bound = (d * (d + 3) + 8) * EPS * permanent + TINY
    if abs(det) > bound:
        return 1 if det > 0 else -1
    return UNDECIDED


@kernel
def filter_in_sphere(simplex, q):
    """In-sphere sign for positively oriented simplices, or UNDECIDED, for any d; |coordinates| <= 1."""
    d = simplex.shape[1]
    rows = np.empty((d + 1, d + 1))
    for i in range(d + 1):
        lift = 0.0
        for j in range(d):
            rows[i, j] = simplex[i, j] - q[j]
            lift += rows[i, j] * rows[i, j]
        rows[i, d] = lift
    det, permanent = _determinant_and_permanent(rows, d + 1)
    # As in `filter_orient`, with the errors of the lift added.
    bound = ((d + 1) * (d + 4) + 2 * d + 12) * EPS * permanent + TINY
    if abs(det) > bound:
        sign = 1 if det > 0 else -1
        return sign if d % 2 == 0 else -sign
    return UNDECIDED
