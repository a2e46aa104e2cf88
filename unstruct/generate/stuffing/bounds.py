"""A proof, by computing with intervals, that stuffed tetrahedra of one level have bounded dihedral angles.

What a stencil makes of a tetrahedron of the lattice depends on few numbers: each cut point lies on its edge,
not within the share alpha of either end, and a vertex on the surface has moved along one of its 14 edges, by
less than alpha. So every corner is p + s v with a number s from an interval; normals of faces and the volume
are linear in each of these numbers, and with the two normals m, n of an edge, the angle there is between the
bounds if ``cos(bound)**2 |m|**2 |n|**2 - (m n)**2`` is positive. This polynomial is written in Bernstein's
form. If all of its coefficients are positive, so is the polynomial; otherwise the box of parameters is
halved. The coefficients are computed with intervals that are rounded outward. See the book, chapter 4c.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, permutations, product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_count, finite
from ...base.errors import InputError
from .stencils import Cuts, stenciled
from .warping import ALPHA

__all__ = ["Interval", "StuffingBounds", "stuffing_bounds"]

Array = NDArray[np.float64]
# A tetrahedron of the lattice, in halves of the long edges; these join vertices 0, 1 and vertices 2, 3.
REFERENCE_CELL = np.array([(2, 0, 0), (0, 0, 0), (1, 1, 1), (1, 1, -1)])
LONG_SIDES = ({0, 1}, {2, 3})
HALVINGS_OF_BOXES = 40
BOXES_AT_ONCE = 1 << 12
COSINE_ULPS = 4  # by which the squares of cosines are rounded down


class Interval(NamedTuple):
    """Arrays of intervals; sums and products are rounded outward."""

    low: Array
    high: Array

    def __add__(self, other: Any) -> Interval:
        return Interval(_down(self.low + other.low), _up(self.high + other.high))

    def __sub__(self, other: Interval) -> Interval:
        return Interval(_down(self.low - other.high), _up(self.high - other.low))

    def __mul__(self, other: Any) -> Interval:
        a, b = self.low * other.low, self.low * other.high
        c, d = self.high * other.low, self.high * other.high
        low, high = (
            np.minimum(np.minimum(a, b), np.minimum(c, d)),
            np.maximum(np.maximum(a, b), np.maximum(c, d)),
        )
        return Interval(_down(low), _up(high))


def _down(x: Array) -> Array:
    return np.nextafter(x, -np.inf)


def _up(x: Array) -> Array:
    return np.nextafter(x, np.inf)


class StuffingBounds(NamedTuple):
    """What was proved, and how.

    Attributes
    ----------
    proved : bool
        Whether all dihedral angles are at least `lower` and at most `upper` degrees.
    lower, upper : float
    least, most : float
        The extreme angles at the corners of boxes of parameters: no bounds can be better.
    cases, boxes, halvings : int
        Pieces of stencils with all the ways in which their vertices move; boxes of parameters in the end; and
        how often the smallest of these was halved.
    failed : tuple of str
        The signs of stencils for which nothing was proved.
    """

    proved: bool
    lower: float
    upper: float
    least: float
    most: float
    cases: int
    boxes: int
    halvings: int
    failed: tuple[str, ...]


class Case(NamedTuple):
    """One tetrahedron of a stencil: corners ``base + s velocity`` for numbers s in [low, high], (4,) each."""

    base: Array
    velocity: Array
    low: Array
    high: Array


def stuffing_bounds(
    lower: float = 10.7,
    upper: float = 164.8,
    *,
    alpha: tuple[float, float] = ALPHA,
    stencils: str | None = None,
    halvings: int = HALVINGS_OF_BOXES,
) -> StuffingBounds:
    """Prove bounds for the dihedral angles of isosurface stuffing at one level.

    Parameters
    ----------
    lower, upper : float
        Degrees.
    alpha : (float, float)
        The shares of long and of short edges within which a cut point moves a vertex.
    stencils : str, optional
        The signs of one kind of tetrahedron, such as "++--" or "+00-"; by default all ten.
    halvings : int
        A box of parameters that has been halved so often is given up.

    Returns
    -------
    StuffingBounds

    Raises
    ------
    InputError
        For bounds that are no angles, shares that are not between 0 and 1/2, and unknown stencils.

    Notes
    -----
    The stencils are those that meshes are made with; rounding there is not looked at, and changes angles by
    1e-13 degrees or so. Excluded are moves that cannot happen together: a vertex moves only toward vertices
    that had the opposite sign, and never two toward each other, as the first to move takes the cut point.
    The bounds of the paper are found again: with its pair (0.24999, 0.41189), whose long share excludes that
    pieces overlap, 9.3171 to 161.6432 degrees; the largest least angle, 10.784, with 164.738 at the default
    pair; and the smallest largest one, 158.741, with 8.971 at (0.26649, 0.36918). All kinds take some
    seconds. Sources: F. Labelle, J. R. Shewchuk, *Isosurface stuffing: fast tetrahedral
    meshes with good dihedral angles*, ACM Trans. Graph. 26(3), 2007; on Bernstein's form, G. Farin, *Curves
    and Surfaces for CAGD*, 5th ed., 2002. Book: 4c.
    """
    least, most = finite(lower, "lower"), finite(upper, "upper")
    if not 0.0 < least < 90.0 < most < 180.0:
        raise InputError(f"lower = {lower} and upper = {upper} must satisfy 0 < lower < 90 < upper < 180")
    pair = list(alpha) if isinstance(alpha, tuple | list) else []
    shares = tuple(finite(share, f"alpha[{i}]") for i, share in enumerate(pair))
    if len(shares) != 2 or not all(0.0 < share < 0.5 for share in shares):
        raise InputError(f"alpha must be two numbers between 0 and 1/2, not {alpha!r}")
    limit = as_count(halvings, "halvings")
    known = sorted({"".join(signs) for signs in _kinds()})
    if stencils is not None and (not isinstance(stencils, str) or stencils not in known):
        raise InputError(f"stencils must be one of {', '.join(known)}, not {stencils!r}")
    squares = [_down_by(np.cos(np.deg2rad(angle)) ** 2) for angle in (least, most)]
    total = StuffingBounds(True, least, most, 180.0, 0.0, 0, 0, 0, ())
    for kind in known if stencils is None else [stencils]:
        total = _joined(total, _proved(kind, list(_cases(kind, shares)), squares, limit))
    return total


def _down_by(x: float) -> float:
    for _ in range(COSINE_ULPS):
        x = float(np.nextafter(x, 0.0))
    return x


def _joined(total: StuffingBounds, found: StuffingBounds) -> StuffingBounds:
    return total._replace(
        proved=total.proved and found.proved,
        least=min(total.least, found.least),
        most=max(total.most, found.most),
        cases=total.cases + found.cases,
        boxes=total.boxes + found.boxes,
        halvings=max(total.halvings, found.halvings),
        failed=total.failed + found.failed,
    )


# ---------------------------------------------------------------------- what is to be looked at


def _kinds() -> list[tuple[str, ...]]:
    """The signs of four vertices, with at least one inside, in the order + 0 -."""
    kinds = product("+0-", repeat=4)
    return [signs for signs in kinds if signs[0] == "+" and list(signs) == sorted(signs, key="+0-".index)]


def _cases(kind: str, alpha: tuple[float, ...]) -> Iterator[Case]:
    """The tetrahedra of a kind of stencil, for all places of its signs and all moves that are possible.

    Tetrahedra of the lattice are images of each other by turns and mirrors of the lattice, which may exchange
    the two forms of the parity rule. So one of them is looked at, with both forms. Without diagonals it is
    also enough to look at one of all places of the signs that its own symmetries exchange.
    """
    seen: set[tuple[int, ...]] = set()
    for places in sorted(set(permutations(kind))):
        signs = np.array(["-0+".index(sign) - 1 for sign in places], dtype=np.int8)
        plain = kind.count("+") == 1 or "-" not in kind
        if plain:
            image = min(tuple(signs[list(turn)].tolist()) for turn in _symmetries())
            if image in seen:
                continue
            seen.add(image)
        for mirror in (1,) if plain else (1, -1):
            yield from _pieces(signs, np.array([mirror, 1, 1]), alpha)


def _symmetries() -> list[tuple[int, ...]]:
    """The permutations of vertices that keep the long edges."""
    return [turn for turn in permutations(range(4)) if {turn[0], turn[1]} in LONG_SIDES]


def _pieces(signs: NDArray[np.int8], mirror: NDArray[np.int64], alpha: tuple[float, ...]) -> Iterator[Case]:
    """The tetrahedra of one tetrahedron with signs."""
    edges = list(combinations(range(4), 2))
    cut = [edge for edge in edges if signs[edge[0]] * signs[edge[1]] < 0]
    keys = np.array([4 * i + j for i, j in cut], dtype=np.int64)
    cells = np.arange(4, dtype=np.int32)[None]
    if not mirror[0] > 0:
        cells = cells[:, [0, 1, 3, 2]]
    pieces, _ = stenciled(np.ascontiguousarray(cells), signs, REFERENCE_CELL * mirror, Cuts(keys, 4))
    for piece in pieces:
        base, velocity, low, high = np.zeros((4, 3)), np.zeros((4, 3)), np.zeros(4), np.zeros(4)
        for k, vertex in enumerate(piece.tolist()):
            if vertex < 4:
                base[k] = REFERENCE_CELL[vertex]
                continue
            i, j = cut[vertex - 4]
            share = alpha[0] if {i, j} in LONG_SIDES else alpha[1]
            base[k], velocity[k] = REFERENCE_CELL[i], REFERENCE_CELL[j] - REFERENCE_CELL[i]
            low[k], high[k] = share, 1.0 - share
        free = [k for k, vertex in enumerate(piece.tolist()) if vertex < 4 and signs[vertex] == 0]
        for moves in product(_steps(), repeat=len(free)):
            if _possible(signs, {int(piece[k]): move for k, move in zip(free, moves, strict=True)}):
                for k, move in zip(free, moves, strict=True):
                    velocity[k], high[k] = move, alpha[0] if 0 in move else alpha[1]
                yield Case(base.copy(), velocity.copy(), low.copy(), high.copy())


def _steps() -> list[tuple[int, ...]]:
    """The 14 edges at a vertex of the lattice."""
    return [
        step
        for step in product((-2, -1, 0, 1, 2), repeat=3)
        if sorted(map(abs, step)) in ([1, 1, 1], [0, 0, 2])
    ]


def _possible(signs: NDArray[np.int8], moves: dict[int, tuple[int, ...]]) -> bool:
    """Whether vertices may move so at the same time: see `stuffing_bounds`."""
    place = {tuple(row): i for i, row in enumerate(REFERENCE_CELL.tolist())}
    toward = {
        v: place[end]
        for v, move in moves.items()
        if (end := tuple((REFERENCE_CELL[v] + move).tolist())) in place
    }
    if any(toward.get(w) == v for v, w in toward.items()):
        return False
    for before in product((-1, 1), repeat=len(moves)):
        old = {i: int(sign) for i, sign in enumerate(signs) if sign} | dict(zip(moves, before, strict=True))
        if all(w not in old or old[v] != old[w] for v, w in toward.items()):
            return True
    return False


# ---------------------------------------------------------------------- polynomials of the parameters


def _proved(kind: str, cases: list[Case], squares: list[float], limit: int) -> StuffingBounds:
    """Bounds for the cases of one kind of stencil."""
    found = StuffingBounds(True, 0.0, 0.0, 180.0, 0.0, len(cases), 0, 0, ())
    if not cases:
        return found
    base, velocity, low, high = (np.array(part) for part in zip(*cases, strict=True))
    wide = (high > low).sum(axis=1)
    for count in np.unique(wide):
        rows = wide == count
        # the corners with parameters first; an even permutation, or a mirror, changes no angle
        order = np.argsort(low[rows] == high[rows], axis=1, kind="stable")
        b, v = (np.take_along_axis(part[rows], order[:, :, None], axis=1) for part in (base, velocity))
        lo, hi = (np.take_along_axis(part[rows], order, axis=1) for part in (low, high))
        todo, depth = [(b, v, lo, hi)], 0
        while todo and depth <= limit:
            rest = []
            for b, v, lo, hi in todo:
                for i in range(0, len(b), BOXES_AT_ONCE):
                    part = slice(i, i + BOXES_AT_ONCE)
                    good, least, most = _judged(b[part], v[part], lo[part], hi[part], int(count), squares)
                    found = found._replace(
                        least=min(found.least, least),
                        most=max(found.most, most),
                        boxes=found.boxes + int(good.sum()),
                        halvings=max(found.halvings, depth),
                    )
                    if not good.all():
                        bad = ~good
                        rest += _halved(b[part][bad], v[part][bad], lo[part][bad], hi[part][bad], int(count))
            todo, depth = rest, depth + 1
        if todo:
            found = found._replace(proved=False, failed=(kind,))
    return found


def _halved(b: Array, v: Array, lo: Array, hi: Array, count: int) -> list[tuple[Array, Array, Array, Array]]:
    """Boxes divided along their widest side."""
    if not count:
        return [(b, v, lo, hi)]
    length = (hi - lo) * np.sqrt((v * v).sum(axis=2))
    axis, rows = np.argmax(length[:, :count], axis=1), np.arange(len(b))
    middle = lo[rows, axis] + 0.5 * (hi[rows, axis] - lo[rows, axis])
    left, right = hi.copy(), lo.copy()
    left[rows, axis], right[rows, axis] = middle, middle
    return [tuple(np.concatenate(pair) for pair in ((b, b), (v, v), (lo, right), (left, hi)))]  # type: ignore[list-item]


def _judged(
    b: Array, v: Array, lo: Array, hi: Array, count: int, squares: list[float]
) -> tuple[NDArray[np.bool_], float, float]:
    """Which boxes are proved, and the extreme angles at their corners."""
    corners = list(product((0, 1), repeat=count))
    ends = np.stack([lo, hi])
    x = []
    for corner in corners:
        s = np.stack([ends[corner[k] if k < count else 0][:, k] for k in range(4)], axis=1)[:, :, None]
        step = Interval(s, s) * Interval(v, v)
        x.append(Interval(b, b) + step)
    points = Interval(np.stack([p.low for p in x], axis=-1), np.stack([p.high for p in x], axis=-1))
    normal, volume = _normals(points, (len(b),) + (2,) * count)
    good = (_least(volume) > 0.0) | (_greatest(volume) < 0.0)
    square = [_inner(n, n) for n in normal]
    ends_of: Any = (slice(None), *np.ix_(*[(0, 2)] * count)) if count else (slice(None),)
    least, most = 180.0, 0.0
    for i, j in combinations(range(4), 2):
        inner = _inner(normal[i], normal[j])
        both, whole = _times(square[i], square[j]), _times(inner, inner)
        above, below = (_least(both * Interval(c, c) - whole) > 0.0 for c in map(np.array, squares))
        # normals that point to different sides make an acute angle, which has no upper bound to keep
        good &= (above & below) | (above & (_greatest(inner) <= 0.0)) | (below & (_least(inner) >= 0.0))
        cosine = -inner.low[ends_of] / np.sqrt(square[i].low[ends_of] * square[j].low[ends_of])
        angle = np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))
        least, most = min(least, float(angle.min())), max(most, float(angle.max()))
    return good, least, most


def _least(f: Interval) -> Array:
    """The least coefficient of each polynomial."""
    return f.low.reshape(len(f.low), -1).min(axis=1)


def _greatest(f: Interval) -> Array:
    return f.high.reshape(len(f.high), -1).max(axis=1)


def _normals(points: Interval, shape: tuple[int, ...]) -> tuple[list[list[Interval]], Interval]:
    """Outward normals of the four faces, three polynomials each, and the volume times six.

    They are linear in each parameter, so that their values at the corners of the box are their coefficients.
    """
    x = [[Interval(points.low[:, k, a], points.high[:, k, a]) for a in range(3)] for k in range(4)]

    def cross(p: int, q: int, r: int) -> list[Interval]:
        u, v = ([x[k][a] - x[p][a] for a in range(3)] for k in (q, r))
        return [u[a - 2] * v[a - 1] - u[a - 1] * v[a - 2] for a in range(3)]

    faces = [cross(1, 2, 3), cross(0, 3, 2), cross(0, 1, 3), cross(0, 2, 1)]
    side = [x[1][a] - x[0][a] for a in range(3)]
    volume = faces[0][0] * side[0] + faces[0][1] * side[1] + faces[0][2] * side[2]
    shaped = [[Interval(c.low.reshape(shape), c.high.reshape(shape)) for c in face] for face in faces]
    return shaped, volume


def _times(f: Interval, g: Interval) -> Interval:
    """The product of polynomials in the form sum of c_k s^k (1 - s)^(n - k), in each of several variables.

    The signs of these coefficients are those of Bernstein's, which are divided by binomial numbers.
    """
    shape = tuple(m + n - 1 for m, n in zip(f.low.shape[1:], g.low.shape[1:], strict=True))
    low, high = np.zeros((len(f.low), *shape)), np.zeros((len(f.low), *shape))
    for index in np.ndindex(*f.low.shape[1:]):
        one = Interval(f.low[(slice(None), *index)], f.high[(slice(None), *index)])
        wide = (slice(None),) + (None,) * len(index)
        part = g * Interval(one.low[wide], one.high[wide])
        here = (slice(None), *(slice(k, k + n) for k, n in zip(index, g.low.shape[1:], strict=True)))
        low[here], high[here] = _down(low[here] + part.low), _up(high[here] + part.high)
    return Interval(low, high)


def _inner(m: list[Interval], n: list[Interval]) -> Interval:
    return _times(m[0], n[0]) + _times(m[1], n[1]) + _times(m[2], n[2])
