"""An order of the vertices by which ties are decided as the given triangles decide them.

Two given triangles in a plane, with four corners on a circle, have chosen one diagonal of the quadrilateral
already. `empty_sphere` decides ties as if the height of each vertex were a little larger, much less for each
vertex than for the next one: of four vertices on a circle the last one is cut off by the diagonal of its two
neighbors. So for each such pair the last of the four must be one of the two that are not on the diagonal.

Such an order is found from its end: take any vertex that is on no diagonal of a pair none of whose vertices
is taken. Then the pairs with this vertex are settled. Taking one never spoils another, so if this gets stuck,
no order fits to all pairs; then the vertices that remain keep their order. A convex polygon of the body never
sticks: however it is cut, some triangle has two sides of the polygon, and the corner between can be taken.
"""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from ...geometry.support_features import side_groups
from ...predicates.batch import in_sphere, orient, scaled

__all__ = ["order_that_fits"]


def order_that_fits(
    points: NDArray[np.float64], faces: NDArray[np.int64], order: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The vertices in an order that fits to the diagonals of given triangles, near to the given order.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int64
        None is flat.
    order : (n,) int64
        Kept as it is where it fits already.
    """
    pairs = _cut_quadrilaterals(points, faces)
    many = np.bincount(pairs[:, :2].ravel(), minlength=len(order))  # pairs that forbid a vertex
    at: dict[int, list[int]] = {}
    for i, row in enumerate(pairs.tolist()):
        for v in row:
            at.setdefault(v, []).append(i)
    place = np.argsort(order)
    open_pair = np.ones(len(pairs), dtype=bool)
    ready: list[int] = []  # minus the place of each vertex that can be taken, the last one first
    for v in np.flatnonzero(many == 0).tolist():
        heappush(ready, -int(place[v]))
    taken: list[int] = []
    while ready:
        v = int(order[-heappop(ready)])
        taken.append(v)
        for i in at.get(v, []):
            if open_pair[i]:
                open_pair[i] = False
                for w in pairs[i, :2].tolist():
                    many[w] -= 1
                    if many[w] == 0:
                        heappush(ready, -int(place[w]))
    rest = order[~np.isin(order, taken)]
    return np.concatenate([rest, np.array(taken[::-1], dtype=np.int64)])


def _cut_quadrilaterals(points: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Pairs of triangles in a plane with their corners on a circle: the two of the diagonal, the others."""
    place, group, size = side_groups(faces)
    start = np.cumsum(size) - size
    rows = []
    for step in range(1, int(size.max(initial=1))):
        first = np.flatnonzero(np.arange(len(place)) - start[group] + step < size[group])
        one, two = place[first], place[first + step]
        t, j = one // 3, one % 3
        other = faces[two // 3, (two % 3 + 2) % 3]
        rows.append(np.stack([faces[t, j], faces[t, (j + 1) % 3], faces[t, (j + 2) % 3], other], axis=1))
    found = np.unique(np.concatenate(rows), axis=0) if rows else np.empty((0, 4), dtype=np.int64)
    found = found[found[:, 2] != found[:, 3]]
    x, _ = scaled(points)
    flat = np.asarray(orient(x[found])) == 0
    found = found[flat]
    corners = x[found[:, :3]]
    # The sphere through the corners and any point off their plane meets the plane in the circle. A step
    # along one of the axes leaves the plane; which one is decided exactly, since products may underflow.
    cells = np.concatenate([corners, corners[:, :1]], axis=1)
    todo = np.arange(len(found))
    for axis in range(3):
        cells[todo, 3] = corners[todo, 0]
        cells[todo, 3, axis] += 1.0
        todo = todo[np.asarray(orient(cells[todo])) == 0]
    assert not len(todo), "a given triangle is flat"
    return found[np.asarray(in_sphere(cells, x[found[:, 3]])) == 0]
