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

from ..base.jit import inline

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
