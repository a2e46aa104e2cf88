"""The parts into which triangles in space divide it: which part lies on either side of each triangle.

Sides of triangles that face each other around an edge belong to one part, and so, step by step, do all sides
that can be reached: a *wall* of the part. A part may have several walls: the one around it, and one around
each body within. The wall around a part encloses a positive volume on its side; every other wall lies in the
smallest of those that hold one of its points.
"""

from __future__ import annotations

from functools import cmp_to_key
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import distinct
from ...base.jit import kernel
from ...geometry.inside_shell import even_odd_in_space, volumes_to_compare
from ...geometry.triangle_pairs import side, unit_points

__all__ = ["UNBOUNDED", "Parts", "parts_in_space"]

UNBOUNDED = -1  # the part that reaches to infinity


class Parts(NamedTuple):
    """The parts of space.

    Attributes
    ----------
    points : (n, 3) float64
    front, back : (t,) int64
        The part to which the normal of each triangle points, and the one behind; `UNBOUNDED` or a number.
    walls : list of (k, 3) int32
        For each part the triangles of the wall around it, from the smallest volume to the largest.
    body : (p,) int64
        Triangles that hang together over edges are a body; this is that of each wall.
    boxes : (p, 2, 3) float64
        The corners of the box around each wall.
    """

    points: NDArray[np.float64]
    front: NDArray[np.int64]
    back: NDArray[np.int64]
    walls: list[NDArray[np.int32]]
    body: NDArray[np.int64]
    boxes: NDArray[np.float64]

    def locate(self, x: np.ndarray, of: NDArray[np.int64] | None = None) -> NDArray[np.int64]:
        """The parts in which points (k, 3) lie that are on no triangle; exact.

        ``of`` has for each point a body, (k,), the walls of which do not count.
        """
        found = np.full(len(x), UNBOUNDED)
        if len(x) == 0:
            return found
        low, high = x.min(axis=0), x.max(axis=0)
        for part in np.flatnonzero(
            ((self.boxes[:, 0] <= high) & (self.boxes[:, 1] >= low)).all(axis=1)
        ).tolist():
            rows, (least, most) = self.walls[part], self.boxes[part]
            near = (found == UNBOUNDED) & ((x >= least) & (x <= most)).all(axis=1)
            if of is not None:
                near &= of != self.body[part]
            left = np.flatnonzero(near)
            if len(left):
                found[left[even_odd_in_space(self.points, rows, x[left])[0]]] = part
        return found


@kernel
def _joined(pairs, label):
    """Number what hangs together by pairs; ``label`` must be 0, 1, 2, ..., and gets the smallest number."""
    for i in range(pairs.shape[0]):
        a, b = pairs[i, 0], pairs[i, 1]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        if a < b:
            label[b] = a
        else:
            label[a] = b
    for i in range(label.shape[0]):
        label[i] = label[label[i]]


def _components(pairs: np.ndarray, count: int) -> NDArray[np.int64]:
    label = np.arange(count)
    _joined(np.ascontiguousarray(pairs, dtype=np.int64), label)
    first = label == np.arange(count)
    return (np.cumsum(first) - 1)[label]


def _facing(points: np.ndarray, triangles: np.ndarray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of sides that face each other around edges, and pairs of triangles with a common edge.

    Side 2 t is the front of triangle t, 2 t + 1 its back.
    """
    t = len(triangles)
    ends = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    tip = triangles[:, [2, 0, 1]].ravel()
    ahead = ends[:, 0] < ends[:, 1]  # the triangle runs along its edge from the smaller vertex to the larger
    key = (ends.min(axis=1) << 32) | ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    begin = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    count = np.diff(np.append(begin, 3 * t))
    after = order.copy()  # the next one around its edge, at the place of each in the order
    for size in (1, 2):
        for k in range(size):
            after[begin[count == size] + k] = order[begin[count == size] + (k + 1) % size]
    xyz = unit_points(points)
    for first, size in zip(begin[count > 2].tolist(), count[count > 2].tolist()):
        rows = order[first : first + size]
        turned = _around(xyz, ends[rows[0]].min(), ends[rows[0]].max(), rows, tip)
        order[first : first + size] = turned
        after[first : first + size] = np.roll(turned, -1)
    # counterclockwise, seen against the edge, the front of a triangle comes first if it runs ahead
    one, two = 2 * (order // 3) + ~ahead[order], 2 * (after // 3) + ahead[after]
    return np.column_stack([one, two]), np.column_stack([order // 3, after // 3])


def _around(xyz: np.ndarray, a: int, b: int, rows: np.ndarray, tip: np.ndarray) -> np.ndarray:
    """Triangles at the edge a b in the order in which a half plane meets them that turns about it; exact."""
    start = int(tip[rows[0]])

    def half(row: int) -> int:
        if row == rows[0]:
            return 0
        sign = side(xyz, a, b, start, int(tip[row]))
        return 2 if sign == 0 else (1 if sign > 0 else 3)

    def compare(one: int, two: int) -> int:
        if half(one) != half(two):
            return half(one) - half(two)
        return 0 if one == two else -side(xyz, a, b, int(tip[one]), int(tip[two]))

    return np.array(sorted(rows.tolist(), key=cmp_to_key(compare)))


def parts_in_space(points: np.ndarray, triangles: np.ndarray) -> Parts:
    """The parts into which triangles divide space that meet in common vertices and edges only; exact.

    Parameters
    ----------
    points : (n, 3) float64
    triangles : (t, 3) int32
        They need not be closed.

    Notes
    -----
    O(t log t), and O(t) for each part that is enclosed.
    """
    t = len(triangles)
    if t == 0:
        none = np.empty(0, dtype=np.int64)
        return Parts(points, none, none, [], none, np.empty((0, 2, 3)))
    facing, joined = _facing(points, triangles)
    wall, body = _components(facing, 2 * t), _components(joined, t)
    front, back = wall[0::2], wall[1::2]
    # a triangle of which the wall has both sides bounds nothing; normals point out of the part
    sides = np.flatnonzero(np.repeat(front != back, 2))
    sides = sides[np.argsort(wall[sides], kind="stable")]
    outward = np.where((sides % 2 == 1)[:, None], triangles[sides // 2], triangles[sides // 2][:, ::-1])
    rows = np.split(outward, np.searchsorted(wall[sides], np.arange(1, wall.max() + 1)))
    volumes = volumes_to_compare(points, rows)
    around = sorted((i for i in range(len(rows)) if volumes[i] > 0), key=volumes.__getitem__)
    owner = np.full(len(rows), UNBOUNDED)
    owner[around] = np.arange(len(around))
    of_wall = np.empty(len(rows), dtype=np.int64)  # the body of each wall
    of_wall[wall] = np.repeat(body, 2)
    walls = [rows[i] for i in around]
    boxes = [(points[r.ravel()].min(axis=0), points[r.ravel()].max(axis=0)) for r in walls]
    result = Parts(points, front, back, walls, of_wall[around], np.array(boxes).reshape(-1, 2, 3))
    # a vertex of each body that is on no other; if there is none, the middle of them
    keys = distinct((np.repeat(body, 3) << 32) | triangles.ravel())
    pairs = np.column_stack([keys >> 32, keys & (2**32 - 1)])
    many = np.bincount(pairs[:, 1], minlength=len(points))
    begin = np.searchsorted(pairs[:, 0], np.arange(body.max() + 2))
    other = np.setdiff1d(np.arange(len(rows)), around)
    x = np.empty((len(other), 3))
    for i, mine in enumerate(of_wall[other].tolist()):
        vertices = pairs[begin[mine] : begin[mine + 1], 1]
        free = vertices[many[vertices] == 1]
        x[i] = points[free[0]] if len(free) else points[vertices].mean(axis=0)
    owner[other] = result.locate(x, of_wall[other])
    return result._replace(front=owner[front], back=owner[back])
