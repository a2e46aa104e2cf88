"""Close cases: signs that the filter leaves open, decided in floating point where this is provably exact.

There are up to three stages before `unstruct.predicates.exact`. Coordinates are at most 1 in magnitude.

* *Short* differences. On lattices and other rounded data the coordinate differences are exact, and they are
  multiples, by integers of few bits, of one power of two. Then plain floating point makes no error at
  all, and the sign is exact, ties included.
* *Whole* differences: integers below 2^57 times one power of two, as mirrored points, lattices with steps
  such as 0.1 and most points of a turned plane have them. The sign is exact, ties included
  (`unstruct.predicates.fixed`).
* Double-double arithmetic: numbers are sums of two doubles, and differences are exact. With u = 2^-53, a
  product errs by at most 7 u^2 and a sum by 3 u^2 (M. Joldes, J.-M. Muller, V. Popescu, *Tight and rigorous
  error bounds for basic building blocks of double-word arithmetic*, ACM TOMS 44, 2017). This adds up to
  33 u^2 of the permanent for `close_incircle`, 23 u^2 for `close_orient3` and 52 u^2 for `close_insphere`;
  the bounds used below are 64 u^2, 64 u^2 and 128 u^2.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.jit import inline, kernel
from .exact import exact_incircle, exact_insphere, exact_orient2, exact_orient3
from .filters import TINY
from .fixed import WHOLE_BITS, fixed_incircle, fixed_insphere, fixed_orient2, fixed_orient3, whole

SPLITTER = 2.0**27 + 1.0
INCIRCLE_CLOSE = 2.0**-100
ORIENT3_CLOSE = 2.0**-100
INSPHERE_CLOSE = 2.0**-99
# A difference d with |d| <= M is short if adding s = 1.5 * 2^k M and subtracting it again leaves d unchanged.
# Then d is a multiple of a power of two above 2^(k - 53) M. In units of that power, the differences are
# integers below 2^(53 - k): below 2^23, 2^14, 2^11, 2^8 for k = 30, 39, 42, 45. The determinants and all
# their intermediate results stay below 2^53.
SHORT_ORIENT2, SHORT_ORIENT3 = 1.5 * 2.0**30, 1.5 * 2.0**39
SHORT_INCIRCLE, SHORT_INSPHERE = 1.5 * 2.0**42, 1.5 * 2.0**45
LEAST_SAFE = 2.0**-160  # products of five differences below this could underflow


@inline
def _sign(value):
    return 1 if value > 0.0 else (-1 if value < 0.0 else 0)


@inline
def _two_difference(a, b):
    """a - b = high + low, exactly."""
    high = a - b
    part = a - high
    return high, (a - (high + part)) + (part - b)


@inline
def _short(d, tail, s):
    return tail == 0.0 and (d + s) - s == d


@inline
def two_product(a, b):
    """a * b = high + low, exactly (Dekker)."""
    high = a * b
    c = SPLITTER * a
    ah = c - (c - a)
    al = a - ah
    c = SPLITTER * b
    bh = c - (c - b)
    bl = b - bh
    return high, al * bl - (((high - ah * bh) - al * bh) - ah * bl)


@inline
def _times(ah, al, bh, bl):
    high, low = two_product(ah, bh)
    low += ah * bl + al * bh
    total = high + low
    return total, low - (total - high)


@inline
def _plus(ah, al, bh, bl):
    high = ah + bh
    part = high - ah
    low = (ah - (high - part)) + (bh - part)
    tail = al + bl
    part = tail - al
    rest = (al - (tail - part)) + (bl - part)
    low += tail
    total = high + low
    low = (low - (total - high)) + rest
    result = total + low
    return result, low - (result - total)


@inline
def _cross(ah, al, bh, bl, ch, cl, dh, dl):
    """a * d - b * c."""
    ph, pl = _times(ah, al, dh, dl)
    qh, ql = _times(bh, bl, ch, cl)
    return _plus(ph, pl, -qh, -ql)


@kernel
def close_orient2(ax, ay, bx, by, cx, cy):
    """`orient2` for points whose sign the filter leaves open."""
    px, t0 = _two_difference(ax, cx)
    py, t1 = _two_difference(ay, cy)
    qx, t2 = _two_difference(bx, cx)
    qy, t3 = _two_difference(by, cy)
    most = max(max(abs(px), abs(py)), max(abs(qx), abs(qy)))
    if most > LEAST_SAFE:
        s = SHORT_ORIENT2 * most
        if _short(px, t0, s) and _short(py, t1, s) and _short(qx, t2, s) and _short(qy, t3, s):
            return _sign(px * qy - py * qx)
        s = math.ldexp(1.0, WHOLE_BITS - math.frexp(most)[1])
        w0, r0 = whole(px, t0, s)
        w1, r1 = whole(py, t1, s)
        w2, r2 = whole(qx, t2, s)
        w3, r3 = whole(qy, t3, s)
        if r0 + r1 + r2 + r3 == 0.0:
            return fixed_orient2(w0, w1, w2, w3)
    return exact_orient2(ax, ay, bx, by, cx, cy)


@kernel
def close_incircle(ax, ay, bx, by, cx, cy, px, py):
    """`incircle` for points whose sign the filter leaves open."""
    ax_, axt = _two_difference(ax, px)
    ay_, ayt = _two_difference(ay, py)
    bx_, bxt = _two_difference(bx, px)
    by_, byt = _two_difference(by, py)
    cx_, cxt = _two_difference(cx, px)
    cy_, cyt = _two_difference(cy, py)
    most = max(max(max(abs(ax_), abs(ay_)), max(abs(bx_), abs(by_))), max(abs(cx_), abs(cy_)))
    alift, blift, clift = ax_ * ax_ + ay_ * ay_, bx_ * bx_ + by_ * by_, cx_ * cx_ + cy_ * cy_
    s = SHORT_INCIRCLE * most
    if (
        most > LEAST_SAFE
        and _short(ax_, axt, s) and _short(ay_, ayt, s) and _short(bx_, bxt, s)
        and _short(by_, byt, s) and _short(cx_, cxt, s) and _short(cy_, cyt, s)
    ):  # fmt: skip
        return _sign(
            alift * (bx_ * cy_ - cx_ * by_)
            + blift * (cx_ * ay_ - ax_ * cy_)
            + clift * (ax_ * by_ - bx_ * ay_)
        )
    if most > LEAST_SAFE:
        s = math.ldexp(1.0, WHOLE_BITS - math.frexp(most)[1])
        w0, r0 = whole(ax_, axt, s)
        w1, r1 = whole(ay_, ayt, s)
        w2, r2 = whole(bx_, bxt, s)
        w3, r3 = whole(by_, byt, s)
        w4, r4 = whole(cx_, cxt, s)
        w5, r5 = whole(cy_, cyt, s)
        if r0 + r1 + r2 + r3 + r4 + r5 == 0.0:
            return fixed_incircle(w0, w1, w2, w3, w4, w5)
    permanent = (
        alift * (abs(bx_ * cy_) + abs(cx_ * by_))
        + blift * (abs(cx_ * ay_) + abs(ax_ * cy_))
        + clift * (abs(ax_ * by_) + abs(bx_ * ay_))
    )
    high, low = _lifted(ax_, axt, ay_, ayt, *_cross(bx_, bxt, by_, byt, cx_, cxt, cy_, cyt))
    h, t = _lifted(bx_, bxt, by_, byt, *_cross(cx_, cxt, cy_, cyt, ax_, axt, ay_, ayt))
    high, low = _plus(high, low, h, t)
    h, t = _lifted(cx_, cxt, cy_, cyt, *_cross(ax_, axt, ay_, ayt, bx_, bxt, by_, byt))
    high, low = _plus(high, low, h, t)
    if abs(high) > INCIRCLE_CLOSE * permanent + TINY:
        return _sign(high)
    return exact_incircle(ax, ay, bx, by, cx, cy, px, py)


@inline
def _lifted(xh, xl, yh, yl, ch, cl):
    """(x^2 + y^2) c."""
    ph, pl = _times(xh, xl, xh, xl)
    qh, ql = _times(yh, yl, yh, yl)
    ph, pl = _plus(ph, pl, qh, ql)
    return _times(ph, pl, ch, cl)


@kernel
def close_orient3(x):
    """Sign of the determinant of rows a - d, b - d, c - d, if the filter leaves it open."""
    e0, t0 = _two_difference(x[0], x[9])
    e1, t1 = _two_difference(x[1], x[10])
    e2, t2 = _two_difference(x[2], x[11])
    e3, t3 = _two_difference(x[3], x[9])
    e4, t4 = _two_difference(x[4], x[10])
    e5, t5 = _two_difference(x[5], x[11])
    e6, t6 = _two_difference(x[6], x[9])
    e7, t7 = _two_difference(x[7], x[10])
    e8, t8 = _two_difference(x[8], x[11])
    one = max(abs(e0), abs(e3), abs(e6))
    two = max(abs(e1), abs(e4), abs(e7))
    three = max(abs(e2), abs(e5), abs(e8))
    if one == 0.0 or two == 0.0 or three == 0.0:
        return 0  # in a plane of constant coordinate
    most = max(one, two, three)
    s = SHORT_ORIENT3 * most
    if (
        most > LEAST_SAFE
        and _short(e0, t0, s) and _short(e1, t1, s) and _short(e2, t2, s)
        and _short(e3, t3, s) and _short(e4, t4, s) and _short(e5, t5, s)
        and _short(e6, t6, s) and _short(e7, t7, s) and _short(e8, t8, s)
    ):  # fmt: skip
        return _sign(e0 * (e4 * e8 - e5 * e7) + e1 * (e5 * e6 - e3 * e8) + e2 * (e3 * e7 - e4 * e6))
    if most > LEAST_SAFE:
        s = math.ldexp(1.0, WHOLE_BITS - math.frexp(most)[1])
        w0, r0 = whole(e0, t0, s)
        w1, r1 = whole(e1, t1, s)
        w2, r2 = whole(e2, t2, s)
        w3, r3 = whole(e3, t3, s)
        w4, r4 = whole(e4, t4, s)
        w5, r5 = whole(e5, t5, s)
        w6, r6 = whole(e6, t6, s)
        w7, r7 = whole(e7, t7, s)
        w8, r8 = whole(e8, t8, s)
        if r0 + r1 + r2 + r3 + r4 + r5 + r6 + r7 + r8 == 0.0:
            return fixed_orient3(w0, w1, w2, w3, w4, w5, w6, w7, w8)
    permanent = (
        abs(e0) * (abs(e4 * e8) + abs(e5 * e7))
        + abs(e1) * (abs(e5 * e6) + abs(e3 * e8))
        + abs(e2) * (abs(e3 * e7) + abs(e4 * e6))
    )
    high, low = _times(e0, t0, *_cross(e4, t4, e5, t5, e7, t7, e8, t8))
    h, t = _times(e1, t1, *_cross(e5, t5, e3, t3, e8, t8, e6, t6))
    high, low = _plus(high, low, h, t)
    h, t = _times(e2, t2, *_cross(e3, t3, e4, t4, e6, t6, e7, t7))
    high, low = _plus(high, low, h, t)
    if abs(high) > ORIENT3_CLOSE * permanent + TINY:
        return _sign(high)
    return exact_orient3(np.array(x))


@kernel
def _minor(e, t, a, b, c):
    """The determinant of rows a, b, c of the differences e + t, and its permanent."""
    high, low, permanent = 0.0, 0.0, 0.0
    for i in range(3):
        u, v = (i + 1) % 3, (i + 2) % 3
        ch, cl = _cross(
            e[b + u], t[b + u], e[b + v], t[b + v], e[c + u], t[c + u], e[c + v], t[c + v]
        )  # fmt: skip
        ph, pl = _times(e[a + i], t[a + i], ch, cl)
        high, low = _plus(high, low, ph, pl)
        permanent += abs(e[a + i]) * (abs(e[b + u] * e[c + v]) + abs(e[b + v] * e[c + u]))
    return high, low, permanent


@kernel
def close_insphere(x):
    """Sign of the determinant of rows (p_i - p, |p_i - p|^2), if the filter leaves it open."""
    e, t = x[:12].copy(), x[:12].copy()
    most, short = 0.0, True
    for i in range(12):
        e[i], t[i] = _two_difference(x[i], x[12 + i % 3])
        most = max(most, abs(e[i]))
        short = short and t[i] == 0.0
    s = SHORT_INSPHERE * most
    short = short and most > LEAST_SAFE
    for i in range(12):
        short = short and (e[i] + s) - s == e[i]
    if not short and most > LEAST_SAFE:
        w, rest = np.empty(12, dtype=np.int64), 0.0
        s = math.ldexp(1.0, WHOLE_BITS - math.frexp(most)[1])
        for i in range(12):
            w[i], r = whole(e[i], t[i], s)
            rest += r
        if rest == 0.0:
            return fixed_insphere(w)
    high, low, permanent = 0.0, 0.0, 0.0
    for k in range(4):
        a, b, c = 0 if k > 0 else 3, 3 if k > 1 else 6, 6 if k > 2 else 9
        lift = e[3 * k] * e[3 * k] + e[3 * k + 1] * e[3 * k + 1] + e[3 * k + 2] * e[3 * k + 2]
        sign = 1.0 if k % 2 == 1 else -1.0
        if short:
            high += sign * lift * (
                e[a] * (e[b + 1] * e[c + 2] - e[b + 2] * e[c + 1])
                - e[a + 1] * (e[b] * e[c + 2] - e[b + 2] * e[c])
                + e[a + 2] * (e[b] * e[c + 1] - e[b + 1] * e[c])
            )  # fmt: skip
            continue
        mh, ml, size = _minor(e, t, a, b, c)
        lh, ll = _times(e[3 * k], t[3 * k], e[3 * k], t[3 * k])
        for i in range(3 * k + 1, 3 * k + 3):
            ph, pl = _times(e[i], t[i], e[i], t[i])
            lh, ll = _plus(lh, ll, ph, pl)
        ph, pl = _times(lh, ll, sign * mh, sign * ml)
        high, low = _plus(high, low, ph, pl)
        permanent += lift * size
    if short or abs(high) > INSPHERE_CLOSE * permanent + TINY:
        return _sign(high)
    return exact_insphere(x)
