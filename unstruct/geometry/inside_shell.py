"""Inside or outside of triangles in space by the even-odd rule, exactly, and the volume that they enclose.

A ray runs from a point in the direction of x. It may meet vertices and edges. So the point is thought to be
moved by (0, e, e^2) with an infinitesimal e > 0: the ray then meets no edge, and each sign that is 0 takes
that of its derivative. Triangles that are seen edge-on are never met. See the book, 2.8b.
"""

from __future__ import annotations

from fractions import Fraction
from math import fsum

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import fill
from ..base.jit import inline, kernel
from ..predicates.batch import power_of_two
from ..predicates.close import two_product
from ..predicates.kernels import orient2
from .boxes import BoxTree, bounding_boxes
from .parity import PARTIALS, add_exactly
from .triangle_pairs import place_in_triangle, side, turn, unit_points

__all__ = [
    "enclosed_volume", "even_odd_in_space", "front_inside", "side_mates", "triangle_components",
    "volumes_to_compare",
]  # fmt: skip

RAYS_AT_ONCE = 1 << 14
TERMS = 24  # products that each triangle adds to six times a volume
LEAST_TERM = Fraction(1, 2**1000)  # what underflow may change in one of them, and more
SURELY = 2.0**-45  # sums of three determinants of numbers up to 1 err by less than 2^-46


# ---------------------------------------------------------------------- rays from given points


@inline
def _to_the_left(xyz, p, u, v):
    """The side of u v, seen along x, on which p moved by (0, e, e^2) lies; 0 if u v is seen end-on."""
    sign = orient2(xyz[u, 1], xyz[u, 2], xyz[v, 1], xyz[v, 2], xyz[p, 1], xyz[p, 2])
    if sign != 0:
        return sign
    if xyz[u, 2] != xyz[v, 2]:
        return 1 if xyz[u, 2] > xyz[v, 2] else -1
    return 1 if xyz[v, 1] > xyz[u, 1] else (-1 if xyz[v, 1] < xyz[u, 1] else 0)


@kernel
def _rays(xyz, first, triangles, query, hit, odd, on):
    """Count, for each query point, the triangles to its right, and note whether it lies on one.

    Query q is the row ``first + q`` of the coordinates.
    """
    for i in range(query.shape[0]):
        q, t = query[i], hit[i]
        p, a, b, c = first + q, triangles[t, 0], triangles[t, 1], triangles[t, 2]
        above = side(xyz, a, b, c, p)
        if above == 0 and place_in_triangle(xyz, a, b, c, p) > 0:
            on[q] = True
            continue
        facing = turn(xyz, 1, 2, a, b, c)
        if facing == 0 or above * facing >= 0:
            continue
        if (
            _to_the_left(xyz, p, a, b) * facing > 0
            and _to_the_left(xyz, p, b, c) * facing > 0
            and _to_the_left(xyz, p, c, a) * facing > 0
        ):
            odd[q] ^= True


def even_odd_in_space(
    points: np.ndarray, triangles: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Whether rays from ``x`` meet an odd number of triangles, and whether x is on one; both exact.

    Parameters
    ----------
    points : (n, 3) float64
    triangles : (t, 3) int
        None of them flat; an even number at each edge.
    x : (k, 3) float64

    Returns
    -------
    odd, on : (k,) bool
    """
    odd, on = np.zeros(len(x), dtype=np.bool_), np.zeros(len(x), dtype=np.bool_)
    if len(x) == 0 or len(triangles) == 0:
        return odd, on
    xyz = unit_points(np.concatenate([points, x]))
    n = len(points)
    low, high = bounding_boxes(xyz[triangles])
    tree, far = BoxTree(low, high), high[:, 0].max()
    for i in range(0, len(x), RAYS_AT_ONCE):
        part = xyz[n + i : n + i + RAYS_AT_ONCE]
        reach = part.copy()
        reach[:, 0] = np.maximum(far, part[:, 0])
        query, hit = tree.pairs(part, reach)
        _rays(xyz, n + i, triangles, query, hit, odd[i : i + RAYS_AT_ONCE], on[i : i + RAYS_AT_ONCE])
    return odd, on


# ---------------------------------------------------------------------- which side of a triangle is inside


def side_mates(triangles: np.ndarray) -> NDArray[np.int64]:
    """For side 3 t + k, opposite vertex k: the other side at this edge if exactly two meet there, else -1."""
    ends = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2).astype(np.int64)
    key = (ends.min(axis=1) << 32) | ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0])) if len(key) else order
    double = first[np.diff(np.append(first, len(key))) == 2]
    mates = np.full(len(key), -1, dtype=np.int64)
    mates[order[double]], mates[order[double + 1]] = order[double + 1], order[double]
    return mates


@kernel
def _components(triangles, mates, component, against):
    """Number the parts that hang together over edges of two triangles, and compare directions in each."""
    fill(component, -1)
    stack = np.empty(triangles.shape[0], dtype=np.int64)
    count = 0
    for start in range(triangles.shape[0]):
        if component[start] >= 0:
            continue
        component[start], against[start], stack[0], top = count, False, start, 1
        while top > 0:
            top -= 1
            t = stack[top]
            for k in range(3):
                mate = mates[3 * t + k]
                if mate < 0 or component[mate // 3] >= 0:
                    continue
                u, j = mate // 3, mate % 3
                same = triangles[u, (j + 1) % 3] == triangles[t, (k + 1) % 3]
                component[u], against[u], stack[top] = count, against[t] ^ same, u
                top += 1
        count += 1
    return count


def triangle_components(triangles: np.ndarray) -> tuple[NDArray[np.int64], NDArray[np.bool_], int]:
    """The parts that hang together over edges of exactly two triangles.

    Returns
    -------
    component : (t,) int64
    against : (t,) bool
        Whether a triangle is turned against the first one of its part.
    count : int
    """
    component, against = np.empty(len(triangles), dtype=np.int64), np.empty(len(triangles), dtype=np.bool_)
    count = int(_components(triangles, side_mates(triangles), component, against))
    return component, against, count


def front_inside(points: np.ndarray, triangles: np.ndarray) -> NDArray[np.bool_]:
    """Whether the side to which the normal points is inside, for embedded triangles that bound a body; exact.

    The answer is the same, up to its direction, all over a part that hangs together over edges of two
    triangles. So one ray a part is enough; it starts in the barycenter of a triangle, which is on no other.
    """
    if len(triangles) == 0:
        return np.zeros(0, dtype=bool)
    xyz = unit_points(points)
    component, against, count = triangle_components(triangles)
    front = np.zeros(count, dtype=bool)  # of the first triangle of each part
    left = np.arange(count)
    for _ in range(3):  # a part in a plane may be seen edge-on along one axis or two
        heads = _heads(xyz, triangles, component, count)[left]
        turned = np.array([turn(xyz, 1, 2, *triangles[t]) for t in heads.tolist()])
        seen = turned != 0
        heads = heads[seen]
        # an odd number of triangles to the right: the side towards larger x is inside
        inside = _inside_to_the_right(xyz, triangles, heads) == (turned[seen] > 0)
        front[left[seen]] = inside ^ against[heads]
        left = left[~seen]
        if len(left) == 0:
            break
        xyz = np.ascontiguousarray(xyz[:, [1, 2, 0]])
    return front[component] ^ against


def _inside_to_the_right(xyz: np.ndarray, triangles: np.ndarray, heads: np.ndarray) -> NDArray[np.bool_]:
    """Whether rays along x from the barycenters of some triangles meet an odd number of others; exact."""
    corners = xyz[triangles]
    low, high = bounding_boxes(corners)
    center = corners[heads].mean(axis=1)
    reach = center + 2.0**-48
    reach[:, 0] = np.maximum(high[:, 0].max(), reach[:, 0])
    query, hit = BoxTree(low, high).pairs(center - 2.0**-48, reach)
    other = heads[query] != hit
    query, hit = query[other], hit[other]
    met = np.empty(len(query), dtype=np.int8)
    _center_rays(xyz, center, triangles, query, hit, met)
    for i in np.flatnonzero(met == 2).tolist():
        met[i] = _exactly_met(xyz, triangles[heads[query[i]]], triangles[hit[i]])
    return np.bincount(query[met == 1], minlength=len(heads)) % 2 == 1


def _heads(xyz: np.ndarray, triangles: np.ndarray, component: np.ndarray, count: int) -> NDArray[np.int64]:
    """For each part the triangle that is largest, seen along x."""
    a, b, c = (xyz[triangles[:, k]][:, 1:] for k in range(3))
    seen = np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    order = np.lexsort((seen, component))
    last = np.searchsorted(component[order], np.arange(count), side="right") - 1
    return order[last]


@kernel
def _center_rays(xyz, center, triangles, query, hit, met):
    """Whether rays from barycenters meet triangles to the right; 2 where rounding could decide."""
    for i in range(query.shape[0]):
        p, t = center[query[i]], triangles[hit[i]]
        met[i] = 2
        a, b, c = xyz[t[0]], xyz[t[1]], xyz[t[2]]
        by, bz, cy, cz = b[1] - a[1], b[2] - a[2], c[1] - a[1], c[2] - a[2]
        py, pz = p[1] - a[1], p[2] - a[2]
        whole = by * cz - bz * cy
        one, two = by * pz - bz * py, py * cz - pz * cy
        rest = whole - one - two
        if abs(whole) > SURELY:
            facing = 1.0 if whole > 0.0 else -1.0
            if min(one * facing, two * facing, rest * facing) < -SURELY:
                met[i] = 0
            elif min(one * facing, two * facing, rest * facing) > SURELY:
                above = (p[0] - a[0]) * whole - (two * (b[0] - a[0]) + one * (c[0] - a[0]))
                if abs(above) > SURELY:
                    met[i] = 1 if above * facing < 0.0 else 0


def _exactly_met(xyz: np.ndarray, head: np.ndarray, triangle: np.ndarray) -> bool:
    """The same in rational arithmetic, with the barycenter moved by (0, e, e^2)."""
    corners = [tuple(map(Fraction, xyz[v].tolist())) for v in head]
    p = tuple(sum(column) / 3 for column in zip(*corners))
    a, b, c = (tuple(map(Fraction, xyz[v].tolist())) for v in triangle)
    by, bz, cy, cz = b[1] - a[1], b[2] - a[2], c[1] - a[1], c[2] - a[2]
    whole = by * cz - bz * cy
    if whole == 0:
        return False
    for u, v in ((a, b), (b, c), (c, a)):
        y, z = v[1] - u[1], v[2] - u[2]
        signs = (y * (p[2] - u[2]) - z * (p[1] - u[1]), -z, y)
        if next((s for s in signs if s), Fraction(0)) * whole <= 0:
            return False
    py, pz = p[1] - a[1], p[2] - a[2]
    one, two = by * pz - bz * py, py * cz - pz * cy
    above = (p[0] - a[0]) * whole - (two * (b[0] - a[0]) + one * (c[0] - a[0]))
    return bool(above * whole < 0)


# ---------------------------------------------------------------------- volume


@kernel
def _six_volumes(xyz, triangles, partials):
    """Add the determinants of all triangles without error; return how many partial sums they make."""
    count = 0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        for i in range(3):
            for one, two in (((i + 1) % 3, (i + 2) % 3), ((i + 2) % 3, (i + 1) % 3)):
                x = xyz[a, i] if one == (i + 1) % 3 else -xyz[a, i]
                for term in two_product(xyz[b, one], xyz[c, two]):
                    for part in two_product(x, term):
                        count = add_exactly(partials, count, part)
    return count


@kernel
def _six_volumes_nearly(xyz, triangles, sums):
    """Add the same terms in a cascade of three sums: each takes the rounding errors of the one before.

    The last entry gets the sum of their magnitudes.
    """
    first = second = third = size = 0.0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        for i in range(3):
            for one, two in (((i + 1) % 3, (i + 2) % 3), ((i + 2) % 3, (i + 1) % 3)):
                x = xyz[a, i] if one == (i + 1) % 3 else -xyz[a, i]
                for term in two_product(xyz[b, one], xyz[c, two]):
                    for part in two_product(x, term):
                        high = first + part
                        rest = high - first
                        low = (first - (high - rest)) + (part - rest)
                        first, size = high, size + abs(part)
                        high = second + low
                        rest = high - second
                        third += (second - (high - rest)) + (low - rest)
                        second = high
    sums[0], sums[1], sums[2], sums[3] = first, second, third, size


def _rounded_sum(xyz: np.ndarray, triangles: np.ndarray) -> float:
    """The sum of all determinants, correctly rounded but for what underflows.

    Let u be 2^-53 and n the number of terms, A the sum of their magnitudes. The errors that enter the third
    sum have magnitudes of n^2 u^2 A at most in all, so it errs by n^3 u^3 A at most (T. Ogita, S. Rump,
    S. Oishi, *Accurate sum and dot product*, SIAM J. Sci. Comput. 26, 2005); twice that covers all rounding
    of the bound. Where it leaves two doubles, all terms are added without error.
    """
    sums = np.empty(4)
    _six_volumes_nearly(xyz, triangles, sums)
    many = TERMS * len(triangles)
    error = 2 * Fraction(many, 2**53) ** 3 * Fraction(sums[3]) + many * LEAST_TERM
    total = sum(map(Fraction, sums[:3].tolist()), Fraction(0))
    if float(total - error) == float(total + error):
        return float(total)
    partials = np.empty(PARTIALS)
    count = _six_volumes(xyz, triangles, partials)
    return fsum(partials[:count].tolist())


def _exact_sum(xyz: np.ndarray, triangles: np.ndarray) -> Fraction:
    """The sum of all determinants in rational arithmetic."""
    used, place = np.unique(triangles, return_inverse=True)
    x = [tuple(map(Fraction, row)) for row in xyz[used].tolist()]
    total = Fraction(0)
    for i, j, k in place.reshape(-1, 3).tolist():
        a, b, c = x[i], x[j], x[k]
        for m in range(3):
            total += a[m] * (b[m - 2] * c[m - 1] - b[m - 1] * c[m - 2])
    return total


def volumes_to_compare(points: np.ndarray, shells: list[np.ndarray]) -> list[float | Fraction]:
    """Six times the volumes inside of closed triangles whose normals point out, in one unit; exact signs.

    So is the order of two of which one may be within the other: that of rational numbers where doubles are
    equal and one box holds the other, or where volumes are nearly lost below the smallest doubles in that
    unit, the largest coordinate. Neither depends on the unit of length of the points.
    """
    xyz = points * power_of_two(points)
    rows = [one.astype(np.int64) for one in shells]
    found: list[float | Fraction] = [_rounded_sum(xyz, one) if len(one) else 0.0 for one in rows]
    known = np.array(found)
    count = np.array([len(one) for one in rows])
    lost = np.abs(known) <= 2.0**54 * TERMS * float(LEAST_TERM) * count
    lost |= _may_nest(xyz, rows, np.unique(known, return_inverse=True)[1])
    for i in np.flatnonzero(lost & (count > 0)).tolist():
        found[i] = _exact_sum(xyz, rows[i])
    return found


def _may_nest(xyz: np.ndarray, rows: list[np.ndarray], same: np.ndarray) -> np.ndarray:
    """Which shells have the same number as another one whose box holds theirs, or lies in it."""
    found = np.zeros(len(rows), dtype=bool)
    often = np.bincount(same, minlength=1)[same] > 1
    several = np.array([i for i in np.flatnonzero(often).tolist() if len(rows[i])], dtype=np.int64)
    if len(several):
        corners = [xyz[rows[i].ravel()] for i in several.tolist()]
        low = np.array([x.min(axis=0) for x in corners])
        high = np.array([x.max(axis=0) for x in corners])
        one, two = BoxTree(low, high).pairs(low, high)
        within = (low[one] >= low[two]).all(axis=1) & (high[one] <= high[two]).all(axis=1)
        pairs = within & (one != two) & (same[several[one]] == same[several[two]])
        found[several[one[pairs]]] = found[several[two[pairs]]] = True
    return found


def enclosed_volume(points: np.ndarray, triangles: np.ndarray) -> float:
    """The volume inside of closed triangles whose normals point out; correctly rounded.

    The products of three coordinates are split into exact sums of doubles and added without error. Only
    terms that underflow, below 2^-1074 times the cube of the largest coordinate, are lost.
    """
    factor = power_of_two(points)
    return _rounded_sum(points * factor, triangles.astype(np.int64)) / 6 / factor / factor / factor
