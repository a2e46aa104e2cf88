"""Sizes from the boundary of a region: its local feature size, and its curvature.

See the book, chapter 2.3.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_number, finite
from ..base.arrays import as_points
from ..base.elementary import turns
from ..base.errors import InputError
from ..base.heap import pop, push
from ..base.jit import inline, kernel
from ..geometry.edge_vectors import exponents, lengths
from ..geometry.outline import Outline
from ..geometry.segment_search import depth_of, first_in
from ..geometry.segment_tree import SegmentTree, to_box, to_segment
from .field import SizeField, as_size
from .source_sizes import sources
from .space_features import SpaceFeatures
from .surface import bends_of

__all__ = ["FeatureSize", "from_curvature", "from_features", "local_feature_size"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
TURN_STEP = np.radians(6.0)  # curves are cut into segments that turn by no more than this, if possible
KINK_HALVINGS = 12  # the largest number of times that segments are halved; at a kink halving would never end
AROUND = np.pi / 2  # parts of a curve with a turn of more than this between them count as different features


class Chain(NamedTuple):
    """A curve, cut into short segments."""

    points: Array  # (k + 1, 2)
    turn: Array  # (k,) the total turn of the piece from its start to the middle of each segment
    total: float  # the total turn of the whole piece


def _chain(domain: Outline, piece: int, fine: float = TURN_STEP) -> Chain:
    """The curve of a piece, cut into segments that turn by at most ``fine``, if possible."""
    t = np.linspace(0.0, 1.0, 17)
    for _ in range(KINK_HALVINGS):
        joint = _joints(domain.at(piece, t))
        steep = np.maximum(np.append(joint, 0.0), np.insert(joint, 0, 0.0)) > fine
        if not steep.any():
            break
        t = np.sort(np.append(t, (t[:-1] + t[1:])[steep] / 2))
    points = domain.at(piece, t)
    joint = _joints(points)
    # The turn at each joint is added when passing it. Only the turn of half a segment is missing at each end.
    turn = np.append(0.0, np.cumsum(joint))
    return Chain(points, turn, float(turn[-1]))


def _joints(points: Array) -> Array:
    """The absolute angle by which a chain of points turns at each of its inner points, in radians."""
    d = np.diff(points, axis=0)
    d = np.ldexp(d, -exponents(d))  # products of lengths may be beyond the doubles
    cross = d[:-1, 0] * d[1:, 1] - d[:-1, 1] * d[1:, 0]
    return np.abs(turns(cross, (d[:-1] * d[1:]).sum(axis=1)))


@inline
def _near(v, i, ends, turn):
    """Whether feature i is adjacent to vertex v: its piece ends there and turns by at most AROUND up to i."""
    return (ends[i, 0] == v and turn[i, 0] <= AROUND) or (ends[i, 1] == v and turn[i, 1] <= AROUND)


class Features(NamedTuple):
    """What is known of each feature: its piece, the ends of that, the turn before it and after it."""

    piece: Integers
    ends: Integers
    turn: Array


@inline
def _apart(j, group, b, found, least, most, features):
    """Whether feature j is apart from one of a group, which consists of the nearer features of one piece.

    One feature of the group is known, and the smallest and the largest turn of all. The other features are
    examined only if the piece shares both its ends with feature j and turns far.
    """
    piece, ends, turn = features
    i = group
    if piece[i] == piece[j]:
        return turn[j, 0] - least > AROUND or most - turn[j, 0] > AROUND
    start, stop = _near(ends[i, 0], j, ends, turn), _near(ends[i, 1], j, ends, turn)
    total = turn[i, 0] + turn[i, 1]
    if not (start or stop):
        return True
    far = (not start or most > AROUND) and (not stop or total - least > AROUND)
    if far and start and stop:
        far = False
        for a in range(b):
            k = found[a]
            far = far or (piece[k] == piece[i] and turn[k, 0] > AROUND and turn[k, 1] > AROUND)
    return far


@inline
def _stands_apart(b, found, many, groups, least, most, features):
    """Whether the feature at place b in the order of distance is apart from a nearer one.

    If it is not, it is added to the group of its piece. The second result is the number of groups.
    """
    piece, turn = features.piece, features.turn
    j = found[b]
    own = -1
    for g in range(many):
        if piece[groups[g]] == piece[j]:
            own = g
        if _apart(j, groups[g], b, found, least[g], most[g], features):
            return True, many
    if own < 0:
        own = many
        groups[own], least[own], most[own] = j, turn[j, 0], turn[j, 0]
        many += 1
    least[own] = min(least[own], turn[j, 0])
    most[own] = max(most[own], turn[j, 0])
    return False, many


@kernel
def _feature_sizes(x, tree, features, far, result):
    """The smallest radius of a disk around x[q] that touches two features which are apart.

    It is infinite if there is no such disk, or if its radius would be larger than ``far``. A heap of boxes
    and features (feature i is stored as -1 - i) gives the features one by one, the nearest first.
    """
    low, high, order, segments = tree.low, tree.high, tree.order, tree.segments
    leaves, many_features = low.shape[0] // 2, segments.shape[0]
    depth = depth_of(leaves)
    heap = np.empty(low.shape[0] + many_features + 2)
    what = np.empty(low.shape[0] + many_features + 2, dtype=np.int64)
    found = np.empty(many_features, dtype=np.int64)
    groups, least, most = np.empty_like(found), np.empty(many_features), np.empty(many_features)
    for q in range(x.shape[0]):
        bound = far
        if q > 0:  # the radius is at most that at the previous point plus the distance from it
            way = np.hypot(x[q, 0] - x[q - 1, 0], x[q, 1] - x[q - 1, 1])
            bound = min(far, (result[q - 1] + way) * (1.0 + 1e-12))
        result[q] = np.inf
        size = push(heap, what, 0, to_box(x, q, low, high, 1), np.int64(1))
        count = many = 0
        while size > 0:
            d, w = heap[0], what[0]
            size = pop(heap, what, size)
            if d > bound:
                break
            if w < 0:
                found[count] = -1 - w
                apart, many = _stands_apart(count, found, many, groups, least, most, features)
                if apart:
                    result[q] = d
                    break
                count += 1
            elif w < leaves:
                for child in (2 * w, 2 * w + 1):
                    d = to_box(x, q, low, high, child)
                    if d <= bound:
                        size = push(heap, what, size, d, child)
            else:
                leaf, m = w - leaves, order.shape[0]
                for k in range(first_in(leaf, m, depth), first_in(leaf + 1, m, depth)):
                    d = to_segment(x, q, segments, order[k])
                    if d <= bound:
                        size = push(heap, what, size, d, -1 - np.int64(order[k]))


def _region(domain: Any) -> None:
    if not isinstance(domain, Outline):
        raise InputError(f"domain must be a Domain, not {type(domain).__name__}")


class FeatureSize:
    """Ruppert's local feature size of a region or body, as a callable object; see `local_feature_size`.

    Parameters
    ----------
    domain : Domain

    Attributes
    ----------
    places : ndarray, shape (k, d)
        The vertices of the features: places where the size may be small.
    """

    def __init__(self, domain: Outline):
        _region(domain)
        self.places: Array = domain.points
        self._space = SpaceFeatures(domain) if domain.points.shape[1] == 3 else None
        if self._space is not None:
            self.places = self._space.places
            return
        vertices = np.unique(np.concatenate([domain.pieces.ravel(), domain.loose])).astype(np.int64)
        straight = np.setdiff1d(np.arange(len(domain.pieces)), list(domain.curves))
        chains = [_chain(domain, piece) for piece in domain.curves]
        blocks = [np.repeat(domain.points[vertices][:, None], 2, axis=1)]
        blocks += [domain.points[domain.pieces[straight]]]
        blocks += [np.stack([c.points[:-1], c.points[1:]], axis=1) for c in chains]
        number = np.concatenate([straight, np.repeat(list(domain.curves), [len(c.turn) for c in chains])])
        number = number.astype(np.int64)
        piece = np.concatenate([-1 - vertices, number])  # a vertex is a piece of its own
        ends = np.concatenate([np.stack([vertices] * 2, axis=1), domain.pieces[number]], dtype=np.int64)
        flat = np.zeros(len(vertices) + len(straight))
        turn = np.concatenate([flat, *[c.turn for c in chains]])
        rest = np.concatenate([flat, *[c.total - c.turn for c in chains]])
        self._features = Features(piece, ends, np.stack([turn, rest], axis=1))
        self._tree = SegmentTree(np.concatenate(blocks))

    def __call__(self, x: ArrayLike, far: float = np.inf) -> Array:
        """The local feature size at points (k, d).

        Infinite where no disk touches two features that are not adjacent, and where the size would be larger
        than ``far`` (a small value of ``far`` saves time).
        """
        points = as_points(x, "x")
        d = self.places.shape[1]
        if points.shape[1] != d:
            raise InputError(f"x must have shape (k, {d}), not {points.shape}")
        if self._space is not None:
            return self._space(points, far)
        tree = self._tree
        result = np.empty(len(points))
        scaled = np.ascontiguousarray(points * tree.factor)
        _feature_sizes(scaled, tree.nodes, self._features, far * tree.factor, result)
        return result / tree.factor


def local_feature_size(domain: Outline, x: ArrayLike) -> Array:
    """How far apart the features of a region or a body are near a point: Ruppert's local feature size.

    Parameters
    ----------
    domain : Domain
        Planar, or a body.
    x : array_like, shape (k, d)

    Returns
    -------
    ndarray, shape (k,)
        The smallest radius of a closed disk or ball around the point that touches two features that are not
        adjacent. Infinite if there is no such pair (a region of one loose point).

    Notes
    -----
    Features are the vertices, the straight pieces, and the curves. Two vertices are never adjacent. A vertex
    is adjacent to the pieces that end in it, and two pieces are adjacent if they share an end, so that a
    sharp corner between two pieces does not make the size zero. A curve is cut into steps of at most 6
    degrees of turn, which limits the accuracy. Steps of a curve are adjacent to one another while the curve
    turns by at most 90 degrees between them; beyond that they count as different features. In the same way a
    curve is adjacent to the features at its ends only for its 90 degrees of turn next to that end. The local
    feature size is a minimum, over fixed pairs, of the larger of two distances. It is therefore Lipschitz
    with the constant 1, and no medial axis is needed.

    The time per point is about O(log s), plus the number of features that are nearer than the second of the
    two features. `FeatureSize` keeps the tree for further calls, which are faster if consecutive points are
    close. Source: Ruppert, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation*
    (1995), section 3; the treatment of curves is ours. See the book, chapter 2.3.

    *In space* features are faces, the edges where they end or bend by 40 degrees or more, inner segments, and
    the corners where edges end. Triangles that meet smoothly, and have the same names, are one face; edges
    that go on smoothly are one curve. Features with a common vertex are adjacent, all others are not: so two
    walls, and two parts of a body across a gap, count with the distance between them. Parts of one face or
    curve count as different features where they face each other, that is where their normals or directions
    differ by more than 90 to 126 degrees (directions are rounded) and they have no common vertex: so the tube
    of a torus has about its radius. Where all facets meet at edges of 40 degrees or more, and two opposite
    parts of none face each other, this is the definition for piecewise linear complexes (J. R. Shewchuk,
    Symposium on Computational Geometry, 1998). The time per point also grows with the number of triangles
    that are nearer than the second feature; a cut-off ``far`` bounds it.
    """
    return FeatureSize(domain)(x)


def from_features(domain: Outline, fraction: float = 0.5, *, far: float | None = None) -> SizeField:
    """A size that is a fraction of the local feature size: narrow parts and gaps get small cells.

    Parameters
    ----------
    domain : Domain
        Planar, or a body: then thin walls and narrow gaps get them.
    fraction : float
        1 gives about one cell across a gap between two features, 1/2 gives two. It is also the growth of the
        size per unit of distance; use `limited` for a smaller growth.
    far : float, optional
        The cut-off, an upper bound of the size.

    Returns
    -------
    SizeField
        It is evaluated at each given point itself, not interpolated. The vertices of a domain are features,
        so a polygon with many short sides gets cells of their length.

    Raises
    ------
    InputError
        For a fraction or cut-off that is not positive. The field itself raises it at a point where no two
        features are apart, if there is no cut-off.
    """
    for name, value in (("fraction", fraction), ("far", np.inf if far is None else far)):
        if not (as_number(value, name) > 0 and (name == "far" or np.isfinite(value))):
            raise InputError(f"{name} must be positive, not {value!r}")
    feature = FeatureSize(domain)
    return _OfFeatures(feature, fraction, np.inf if far is None else far)


class _OfFeatures(SizeField):
    """The result of `from_features`."""

    def __init__(self, feature: FeatureSize, fraction: float, cap: float):
        super().__init__(
            partial(_part, feature, fraction, cap),
            landmarks=feature.places,
            name=f"{fraction:g} of the local feature size",
            growth=fraction,  # the local feature size changes by at most 1
        )
        self.feature, self.fraction, self.cap = feature, fraction, cap

    def below(self, x: Array, bound: Array) -> Array:
        """As `SizeField.below`: what is farther than the largest bound is not looked for."""
        cap = min(self.cap, float(bound.max(initial=0.0)))
        return np.minimum(_part(self.feature, self.fraction, cap, x), bound)


def _part(feature: FeatureSize, fraction: float, cap: float, x: Array) -> Array:
    return np.minimum(fraction * feature(x, cap / fraction * (1 + 1e-12)), cap)


def from_curvature(
    domain: Outline, per_turn: float = 24.0, *, far: float, lower: float | None = None, growth: float = 0.2
) -> SizeField:
    """A size that resolves curved boundaries by a wanted number of edges per full turn.

    Parameters
    ----------
    domain : Domain
        Planar, or a body: the curvature is then that of the surface which its facets approximate, along their
        edges. Where facets turn by more than 40 degrees is an edge of the body, which has no curvature.
    per_turn : float
        How many edges a full circle gets; the angle between neighboring edges is 360 degrees / per_turn.
    far : float
        The cut-off, and the size at straight pieces. (Corners have no curvature.)
    lower : float, optional
        A lower bound of the size, however sharply a curve turns.
    growth : float
        The growth of the size per unit of distance from the boundary, as for `sources`.

    Returns
    -------
    SizeField
        On a circle or sphere of radius R, and around a cylinder, it is 2 pi R / per_turn.

    Raises
    ------
    InputError
        For numbers that are not positive.
    """
    for name, value in (("per_turn", per_turn), ("far", far), ("lower", far if lower is None else lower)):
        if not (as_number(value, name) > 0 and np.isfinite(value)):
            raise InputError(f"{name} must be positive, not {value!r}")
    if finite(growth, "growth") < 0:
        raise InputError(f"growth must be at least 0, not {growth!r}")
    if isinstance(domain, Outline) and domain.points.shape[1] == 3:
        edges, bend = bends_of(domain)
        with np.errstate(divide="ignore"):
            wanted = 2 * np.pi / per_turn / bend
        near = wanted < far
        if not near.any():
            return as_size(far)
        bound = np.maximum(wanted[near], lower or 0.0)
        return sources(edges[near], np.minimum(bound, far), growth=growth, far=far, name="curved edges")
    _region(domain)
    rows, sizes = [], []
    for piece in domain.curves:
        points = _chain(domain, piece, min(TURN_STEP, np.pi / 4 / per_turn)).points  # eight steps per edge
        joint = _joints(points)
        length = lengths(np.diff(points, axis=0))
        # This is the curvature at the joints. The curvature of a step is the mean of that at its two ends,
        # where an end of the piece has the same curvature as the joint next to it.
        bend = joint / ((length[1:] + length[:-1]) / 2)
        bend = (np.append(bend, bend[-1]) + np.insert(bend, 0, bend[0])) / 2
        with np.errstate(divide="ignore"):
            wanted = 2 * np.pi / per_turn / bend
        near = wanted < far
        rows.append(np.stack([points[:-1], points[1:]], axis=1)[near])
        sizes.append(np.maximum(wanted[near], lower or 0.0))
    if not sum(map(len, rows)):
        return as_size(far)
    bound = np.minimum(np.concatenate(sizes), far)
    return sources(np.concatenate(rows), bound, growth=growth, far=far, name="steps of curves")
