"""Determinants in integers of fixed length: two digits for each difference of coordinates.

Mirrored points, regular polygons and lattices with steps such as 0.1 give exact ties whose coordinates use
all bits of a double. Yet the differences to one of the points are integers below 2^57 in magnitude, times
one power of two, unless a coordinate is much smaller than the others. Such an integer is x1 * 2^29 + x0, with
digits 0 <= x0 < 2^29 and -2^28 <= x1 < 2^28. The determinants are evaluated digit by digit, without
arrays: more than ten times faster than in `unstruct.predicates.exact`, where numbers have any length. The
digits are short enough for all sums of their products to stay below 2^62: 64-bit integers hold them.

In space, points of a plane that was turned and rounded are near ties of the same kind.
"""

from __future__ import annotations

from ..base.jit import inline, kernel

DIGIT_BITS = 29
LOW_DIGIT = (1 << DIGIT_BITS) - 1
WHOLE_BITS = 57  # differences are below 2**57 in magnitude


@inline
def whole(high, tail, scale):
    """The integer part of (high + tail) * scale, and a rest that is zero only if this is a whole number."""
    high, tail = high * scale, tail * scale
    a, b = int(high), int(tail)
    return a + b, abs(high - float(a)) + abs(tail - float(b))


@inline
def _cross_digits(ax, ay, bx, by):
    """Four digits of ax * by - ay * bx; only the last is signed."""
    ax0, ax1, ay0, ay1 = ax & LOW_DIGIT, ax >> DIGIT_BITS, ay & LOW_DIGIT, ay >> DIGIT_BITS
    bx0, bx1, by0, by1 = bx & LOW_DIGIT, bx >> DIGIT_BITS, by & LOW_DIGIT, by >> DIGIT_BITS
    c0 = ax0 * by0 - ay0 * bx0
    c1 = ax0 * by1 + ax1 * by0 - ay0 * bx1 - ay1 * bx0 + (c0 >> DIGIT_BITS)
    c2 = ax1 * by1 - ay1 * bx1 + (c1 >> DIGIT_BITS)
    return c0 & LOW_DIGIT, c1 & LOW_DIGIT, c2 & LOW_DIGIT, c2 >> DIGIT_BITS


@inline
def fixed_orient2(ax, ay, bx, by):
    """Sign of ax * by - ay * bx for whole numbers."""
    c0, c1, c2, c3 = _cross_digits(ax, ay, bx, by)
    if c3 != 0:
        return 1 if c3 > 0 else -1
    return 1 if c0 | c1 | c2 else 0


@inline
def fixed_orient3(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Sign of the determinant of rows a, b, c for whole numbers.

    The five columns of products of a (b x c) are added before carries are taken: each product is at most 2^58
    in magnitude, and there are at most six in a column.
    """
    s0 = s1 = s2 = s3 = s4 = 0
    for _ in range(3):
        low, high = ax & LOW_DIGIT, ax >> DIGIT_BITS
        c0, c1, c2, c3 = _cross_digits(by, bz, cy, cz)
        s0 += low * c0
        s1 += low * c1 + high * c0
        s2 += low * c2 + high * c1
        s3 += low * c3 + high * c2
        s4 += high * c3
        ax, ay, az, bx, by, bz, cx, cy, cz = ay, az, ax, by, bz, bx, cy, cz, cx
    s1 += s0 >> DIGIT_BITS
    s2 += s1 >> DIGIT_BITS
    s3 += s2 >> DIGIT_BITS
    s4 += s3 >> DIGIT_BITS
    if s4 != 0:
        return 1 if s4 > 0 else -1
    return 1 if (s0 | s1 | s2 | s3) & LOW_DIGIT else 0


@inline
def fixed_incircle(ax, ay, bx, by, cx, cy):
    """Sign of the determinant of rows (a, |a|^2), (b, |b|^2), (c, |c|^2) for whole numbers.

    The seven columns of products are added before carries are taken. The digits of the factors of
    |a|^2 (b x c) are below 2^29, and the last ones at most 2^29 in magnitude. So each column is at most 2^60,
    and the sum of the three terms at most 3 * 2^60.
    """
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = 0
    for _ in range(3):
        l0, l1, l2, l3 = _cross_digits(ax, -ay, ay, ax)  # ax^2 + ay^2
        c0, c1, c2, c3 = _cross_digits(bx, by, cx, cy)
        s0 += l0 * c0
        s1 += l0 * c1 + l1 * c0
        s2 += l0 * c2 + l1 * c1 + l2 * c0
        s3 += l0 * c3 + l1 * c2 + l2 * c1 + l3 * c0
        s4 += l1 * c3 + l2 * c2 + l3 * c1
        s5 += l2 * c3 + l3 * c2
        s6 += l3 * c3
        ax, ay, bx, by, cx, cy = bx, by, cx, cy, ax, ay
    s1 += s0 >> DIGIT_BITS
    s2 += s1 >> DIGIT_BITS
    s3 += s2 >> DIGIT_BITS
    s4 += s3 >> DIGIT_BITS
    s5 += s4 >> DIGIT_BITS
    s6 += s5 >> DIGIT_BITS
    if s6 != 0:
        return 1 if s6 > 0 else -1
    return 1 if (s0 | s1 | s2 | s3 | s4 | s5) & LOW_DIGIT else 0


@inline
def _six_digits(s0, s1, s2, s3, s4):
    """Digits of a number by its columns; only the last is signed."""
    s1 += s0 >> DIGIT_BITS
    s2 += s1 >> DIGIT_BITS
    s3 += s2 >> DIGIT_BITS
    s4 += s3 >> DIGIT_BITS
    return (
        s0 & LOW_DIGIT, s1 & LOW_DIGIT, s2 & LOW_DIGIT, s3 & LOW_DIGIT, s4 & LOW_DIGIT, s4 >> DIGIT_BITS
    )  # fmt: skip


@inline
def _minor(w, a, b, c):
    """Six digits of the determinant of the rows that begin at a, b, c; it is below 2^174 in magnitude."""
    s0 = s1 = s2 = s3 = s4 = 0
    for i in range(3):
        u, v = (i + 1) % 3, (i + 2) % 3
        low, high = w[a + i] & LOW_DIGIT, w[a + i] >> DIGIT_BITS
        c0, c1, c2, c3 = _cross_digits(w[b + u], w[b + v], w[c + u], w[c + v])
        s0 += low * c0
        s1 += low * c1 + high * c0
        s2 += low * c2 + high * c1
        s3 += low * c3 + high * c2
        s4 += high * c3
    return _six_digits(s0, s1, s2, s3, s4)


@inline
def _square(x, y, z):
    """Four digits of x^2 + y^2 + z^2, none of them negative."""
    c0, c1, c2, c3 = _cross_digits(x, -y, y, x)
    low, high = z & LOW_DIGIT, z >> DIGIT_BITS
    c0 += low * low
    c1 += 2 * low * high + (c0 >> DIGIT_BITS)
    c2 += high * high + (c1 >> DIGIT_BITS)
    return c0 & LOW_DIGIT, c1 & LOW_DIGIT, c2 & LOW_DIGIT, c3 + (c2 >> DIGIT_BITS)


@kernel
def fixed_insphere(w):
    """Sign of the determinant of four rows (a, |a|^2), whose twelve whole numbers are an array.

    The nine columns of products are added before carries are taken. The digits of the factors are at most
    2^29 in magnitude, at most four products are in a column of each row, and there are four rows: each
    column is at most 2^62.
    """
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = s8 = 0
    for k in range(4):
        a, b, c = 0 if k > 0 else 3, 3 if k > 1 else 6, 6 if k > 2 else 9
        m0, m1, m2, m3, m4, m5 = _minor(w, a, b, c)
        l0, l1, l2, l3 = _square(w[3 * k], w[3 * k + 1], w[3 * k + 2])
        if k % 2 == 0:
            l0, l1, l2, l3 = -l0, -l1, -l2, -l3
        s0 += l0 * m0
        s1 += l0 * m1 + l1 * m0
        s2 += l0 * m2 + l1 * m1 + l2 * m0
        s3 += l0 * m3 + l1 * m2 + l2 * m1 + l3 * m0
        s4 += l0 * m4 + l1 * m3 + l2 * m2 + l3 * m1
        s5 += l0 * m5 + l1 * m4 + l2 * m3 + l3 * m2
        s6 += l1 * m5 + l2 * m4 + l3 * m3
        s7 += l2 * m5 + l3 * m4
        s8 += l3 * m5
    s1 += s0 >> DIGIT_BITS
    s2 += s1 >> DIGIT_BITS
    s3 += s2 >> DIGIT_BITS
    s4 += s3 >> DIGIT_BITS
    s5 += s4 >> DIGIT_BITS
    s6 += s5 >> DIGIT_BITS
    s7 += s6 >> DIGIT_BITS
    s8 += s7 >> DIGIT_BITS
    if s8 != 0:
        return 1 if s8 > 0 else -1
    return 1 if (s0 | s1 | s2 | s3 | s4 | s5 | s6 | s7) & LOW_DIGIT else 0
