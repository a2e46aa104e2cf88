"""Edges of a mesh that match: cut in the same way before a refinement, which then keeps them.

A split during the refinement would have to succeed on both sides or on none. So the edges are cut before it,
as far as the wanted size or area asks for on either side, and the points on the second side are computed from
those on the first by the motion of the mesh. What the angle alone would ask for is refused: the triangles
concerned say "kept".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_number
from ...base.arrays import frozen
from ...domain.plane.by_region import per_region
from ...mesh.mesh import Mesh
from ...mesh.periodic import Periodic, facet_images
from ...sizing import as_size

__all__ = ["NO_PARTS", "Cut", "Longest", "Matched", "Parts", "cut", "longest_edges", "matched_edges"]

SQUARE_OF_AREA = 1.5  # squared edges of so many areas: few triangles beside them are larger then
LONG_EDGES = 4.0  # edges that are more times as long as the size at their middle are halved
SAMPLES_OF_EDGES = 9  # places on other edges where the size is asked for
OFF_THE_MOTION = 1e-9  # of the edge: how far vertices of a file may be from the images of others
MOST_HALVINGS = 40

Longest = Callable[[NDArray[np.float64], NDArray[np.int64]], NDArray[np.float64]]


class Parts(NamedTuple):
    """Parts of edges: their ends, where they lie on their edge, and which one that is."""

    ends: NDArray[np.int64]
    span: NDArray[np.float64]
    edge: NDArray[np.int64]


NO_PARTS = Parts(np.empty((0, 2), dtype=np.int64), np.empty((0, 2)), np.empty(0, dtype=np.int64))


class Matched(NamedTuple):
    """Edges that match.

    Attributes
    ----------
    first, second, motion : ndarray of int64, shape (l,)
        Edges, their images, and the number of the motion in ``mesh.periodic``.
    label : ndarray of int64, shape (e,)
        For each edge a number: 0 if nothing matches it, and different for the sides of different motions.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    motion: NDArray[np.int64]
    label: NDArray[np.int64]

    def without(self, edges: NDArray[np.bool_]) -> Matched:
        """The same without the links to some edges, which are not cut then."""
        keep = ~(edges[self.first] | edges[self.second])
        return self._replace(first=self.first[keep], second=self.second[keep], motion=self.motion[keep])


def matched_edges(mesh: Mesh, edges: NDArray[np.int32]) -> Matched:
    """The pairs of ``edges`` (e, 2) whose ends are pairs of the mesh."""
    found = [facet_images(pairs, edges, len(mesh.points)) for _, pairs in mesh.periodic]
    label = np.zeros(len(edges), dtype=np.int64)
    for i, (one, two) in enumerate(found):
        label[one] = label[one] * (2 * len(found) + 1) + 2 * i + 1
        label[two] = label[two] * (2 * len(found) + 1) + 2 * i + 2
    first, second = (np.concatenate([f[k] for f in found] or [np.empty(0, dtype=np.int64)]) for k in (0, 1))
    motion = np.repeat(np.arange(len(found)), [len(one) for one, _ in found])
    return Matched(first.astype(np.int64), second.astype(np.int64), motion, label)


def longest_edges(names: list[str], size: Any, max_area: Any) -> Longest | None:
    """The wanted length of an edge beside a region at a place; None if nothing is wanted."""
    if size is None and max_area is None:
        return None
    sizes = [None if one is None else as_size(one) for one in per_region(size, names, "size")]
    areas = per_region(max_area, names, "max_area")

    def longest(x: NDArray[np.float64], region: NDArray[np.int64]) -> NDArray[np.float64]:
        found = np.full(len(x), np.inf)
        for r in np.unique(region[region >= 0]).tolist():
            rows = np.flatnonzero(region == r)
            field, area = sizes[r], areas[r]
            if field is not None:
                found[rows] = field(x[rows])
            if area is not None and as_number(area, "max_area") > 0.0:  # others are refused by `make_limits`
                found[rows] = np.minimum(found[rows], np.sqrt(SQUARE_OF_AREA * float(area)))
        return found

    return longest


class Cut(NamedTuple):
    """What `cut` makes: new points, the parts that replace edges, and all pairs, the new ones too."""

    points: NDArray[np.float64]
    parts: Parts
    periodic: tuple[Periodic, ...]


class _Twins(NamedTuple):
    """Parts of edges u-v and their images p-q; the link that they belong to, and their place on its edge."""

    u: NDArray[np.int64]
    v: NDArray[np.int64]
    p: NDArray[np.int64]
    q: NDArray[np.int64]
    link: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def at(self, rows: Any) -> _Twins:
        return _Twins(*(column[rows] for column in self))


def _joined(parts: list[_Twins]) -> _Twins:
    columns: Any = [np.concatenate(column) for column in zip(*parts)]
    return _Twins(*columns)


class _Sides:
    """The sizes on the four sides of edges that match, and the points on them while they are cut."""

    def __init__(self, mesh: Mesh, sides: NDArray[np.int64], links: Matched, longest: Longest):
        self.sides, self.links, self.longest = sides, links, longest
        self.motions = [motion for motion, _ in mesh.periodic]
        self.points, self.pairs = np.asarray(mesh.points), []  # type: ignore[var-annotated]

    def images(self, x: NDArray[np.float64], link: NDArray[np.int64]) -> NDArray[np.float64]:
        image, which = np.empty_like(x), self.links.motion[link]
        for i in np.unique(which).tolist():
            image[which == i] = self.motions[i](x[which == i])
        return image

    def wanted(self, x: NDArray[np.float64], link: NDArray[np.int64]) -> NDArray[np.float64]:
        """The smallest wanted length at places on first edges and at their images."""
        found = np.full(len(link), np.inf)
        for places, edges in ((x, self.links.first), (self.images(x, link), self.links.second)):
            for k in (0, 1):
                found = np.minimum(found, self.longest(places, self.sides[edges[link], k]))
        return found

    def place(self, w: _Twins, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """The points at shares t of first edges."""
        a, b = self.points[w.u], self.points[w.v]
        return a + t[:, None] * (b - a)

    def put(self, x: NDArray[np.float64], link: NDArray[np.int64]) -> tuple[NDArray, NDArray]:
        """Add points and their images; return the numbers of both."""
        new = len(self.points) + np.arange(len(x))
        self.points = np.concatenate([self.points, x, self.images(x, link)])
        self.pairs.append((self.links.motion[link], np.column_stack([new, new + len(x)])))
        return new, new + len(x)


def cut(
    mesh: Mesh, ends: NDArray[np.int32], sides: NDArray[np.int64], links: Matched, longest: Longest, most: int
) -> Cut:
    """Cut edges that match, both in the same way, by the smallest size on their four sides.

    Parameters
    ----------
    mesh : Mesh
    ends : ndarray, shape (e, 2)
        The ends of edges.
    sides : ndarray, shape (e, 2)
        The regions on both sides of each edge, -1 for none.
    links : Matched
    longest : function
        What `longest_edges` returns.
    most : int
        How many new points there may be, about.

    Returns
    -------
    Cut
        New points are numbered after those of the mesh. Edges of a motion that is not known or that does not
        fit their ends stay whole, as do those that match several others.

    Notes
    -----
    As in `Domain.sampled`, the number of parts is the integral of ds over the size, rounded, and they have
    equal shares of it. Edges much longer than the size are halved first, so that no detail of it is missed.
    """
    links, same = _to_be_cut(mesh, ends, links)
    one, two = ends[links.first].astype(np.int64), ends[links.second].astype(np.int64)
    two = np.where(same[:, None], two, two[:, ::-1])  # images of the ends, in their order
    s, m = _Sides(mesh, sides, links, longest), len(one)
    w = _Twins(one[:, 0], one[:, 1], two[:, 0], two[:, 1], np.arange(m), np.zeros(m), np.ones(m))
    done = []
    for _ in range(MOST_HALVINGS):
        middle = s.place(w, np.full(len(w.u), 0.5))
        length = np.hypot(*(s.points[w.v] - s.points[w.u]).T)
        long = length > LONG_EDGES * s.wanted(middle, w.link)
        if len(s.points) - len(mesh.points) + 2 * int(long.sum()) > most:
            long[:] = False
        done.append(w.at(~long))
        if not long.any():
            break
        w = w.at(long)
        x, y = s.put(middle[long], w.link)
        at = 0.5 * (w.low + w.high)
        front = w._replace(v=x, q=y, high=at)
        w = _joined([front, w._replace(u=x, p=y, low=at)])
    else:
        done.append(w)
    w = _divided(s, _joined(done), most - len(s.points) + len(mesh.points))
    turned = ~same[w.link]
    image, span = np.column_stack([w.p, w.q]), np.column_stack([w.low, w.high])
    image[turned], back = image[turned, ::-1], span.copy()
    back[turned] = 1.0 - span[turned, ::-1]
    parts = Parts(
        np.concatenate([np.column_stack([w.u, w.v]), image]),
        np.concatenate([span, back]),
        np.concatenate([links.first[w.link], links.second[w.link]]),
    )
    return Cut(s.points[len(mesh.points) :], parts, _with_new(mesh.periodic, s.pairs))


def _divided(s: _Sides, w: _Twins, most: int) -> _Twins:
    """Each part divided into as many as the size asks for, with equal shares of the integral of ds / size."""
    shares = np.linspace(0.0, 1.0, SAMPLES_OF_EDGES)
    length = np.hypot(*(s.points[w.v] - s.points[w.u]).T)
    rate = np.empty((len(length), len(shares)))
    for j, share in enumerate(shares.tolist()):
        rate[:, j] = length / s.wanted(s.place(w, np.full(len(length), share)), w.link)
    total = np.cumsum(0.5 * (rate[:, 1:] + rate[:, :-1]) * np.diff(shares), axis=1)
    total = np.column_stack([np.zeros(len(length)), total])
    count = np.maximum(np.rint(total[:, -1]), 1).astype(np.int64)
    if 2 * int((count - 1).sum()) > most:
        count[:] = 1
    row = np.repeat(np.arange(len(count)), count)  # all parts; the first of each keeps the end u
    number = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    new = np.flatnonzero(number > 0)
    goal = number[new] / count[row[new]] * total[row[new], -1]
    below = np.clip((total[row[new]] <= goal[:, None]).sum(axis=1) - 1, 0, len(shares) - 2)
    start, stop = total[row[new], below], total[row[new], below + 1]
    t = shares[below] + (goal - start) / (stop - start) * (shares[1] - shares[0])
    x, y = s.put(s.place(w.at(row[new]), t), w.link[row[new]])
    at = w.low[row[new]] + t * (w.high - w.low)[row[new]]
    columns: Any = [np.array(column) for column in w.at(row)]
    parts = _Twins(*columns)
    parts.u[new], parts.p[new], parts.low[new] = x, y, at
    parts.v[new - 1], parts.q[new - 1], parts.high[new - 1] = x, y, at
    return parts


def _to_be_cut(mesh: Mesh, ends: NDArray, links: Matched) -> tuple[Matched, NDArray[np.bool_]]:
    """Links that can be cut, and whether the image of each runs in the direction of its edge."""
    times = np.bincount(np.concatenate([links.first, links.second]), minlength=len(ends))
    links = links.without(times > 1)
    same = np.zeros(len(links.first), dtype=bool)
    fit = np.zeros(len(links.first), dtype=bool)
    x, y = mesh.points[ends[links.first]], mesh.points[ends[links.second]]
    for i, (motion, pairs) in enumerate(mesh.periodic):
        rows = np.flatnonzero(links.motion == i)
        if motion is None or len(rows) == 0:
            continue
        image = np.full(len(mesh.points), -1)
        image[pairs[:, 0]] = pairs[:, 1]
        same[rows] = image[ends[links.first[rows], 0]] == ends[links.second[rows], 0]
        there = np.where(same[rows, None, None], y[rows], y[rows][:, ::-1])
        away = np.abs(motion(x[rows]) - there).max(axis=(1, 2))
        fit[rows] = away <= OFF_THE_MOTION * np.abs(x[rows, 1] - x[rows, 0]).max(axis=1)
    keep = np.flatnonzero(fit)
    return Matched(links.first[keep], links.second[keep], links.motion[keep], links.label), same[keep]


def _with_new(periodic: tuple[Periodic, ...], pairs: list[tuple[NDArray, NDArray]]) -> tuple[Periodic, ...]:
    found = []
    for i, (motion, old) in enumerate(periodic):
        rows = [old, *(new[which == i] for which, new in pairs)]
        found.append(Periodic(motion, frozen(np.concatenate(rows).astype(np.int32))))
    return tuple(found)
