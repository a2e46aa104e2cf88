"""Facets that stay although they are much larger than the wanted size, and the size near them.

A cell on such a facet has its edges: with a point at a wanted, small distance it would be flat. So the size
near a coarse facet is about that of the facet, and falls from there to the wanted one. See the book, 2.8c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, kernel
from ...domain.space.cutting import Shell
from ...geometry.boxes import BoxTree, bounding_boxes
from ...geometry.edge_vectors import cross, lengths
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField

__all__ = ["COARSE_FALL", "CoarseFacets", "coarse_facets", "square_from_triangle"]

Array = NDArray[np.float64]
MUCH_COARSER = 4.0  # edges of a facet over the size, from which the size near it is changed
AS_LARGE = 0.25  # the size at a coarse facet; unit: the root of twice its area
COARSE_FALL = 1.0  # of the size from a coarse facet, per length
COARSE_REACH = (
    1.0  # how near to a coarse facet points come only after it is recovered; unit: its longest edge
)
ASKED_OF_FACETS = 1 << 15  # points, to bound the memory


@apart
def square_from_triangle(p, corner):
    """The squared distance of a point from a triangle, which may be a segment or a point."""
    least = np.inf
    nx = ny = nz = 0.0
    within = True
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    for k in range(3):
        a, b = corner[k], corner[(k + 1) % 3]
        ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        px, py, pz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
        length = ex * ex + ey * ey + ez * ez
        t = 0.0 if length <= 0.0 else min(max((px * ex + py * ey + pz * ez) / length, 0.0), 1.0)
        qx, qy, qz = px - t * ex, py - t * ey, pz - t * ez
        least = min(least, qx * qx + qy * qy + qz * qz)
        within = (
            within and nx * (ey * pz - ez * py) + ny * (ez * px - ex * pz) + nz * (ex * py - ey * px) > 0.0
        )
    square = nx * nx + ny * ny + nz * nz
    if within and square > 0.0:
        height = nx * (p[0] - corner[0, 0]) + ny * (p[1] - corner[0, 1]) + nz * (p[2] - corner[0, 2])
        least = min(least, height * height / square)
    return least


@kernel
def _raise(x, corners, weight, query, hit, fall, largest):
    """The most of weight - fall * distance over its triangles at each point, if more than what is known."""
    for i in range(query.shape[0]):
        q, f = query[i], hit[i]
        if weight[f] > largest[q]:
            value = weight[f] - fall * np.sqrt(square_from_triangle(x[q], corners[f]))
            largest[q] = max(largest[q], value)


class CoarseFacets:
    """Facets that stay and are much larger than the size.

    Parameters
    ----------
    corners : (m, 3, 3) float64
    """

    def __init__(self, corners: Array):
        self._factor = power_of_two(corners)  # fourth powers of very small or large lengths are no doubles
        self._corners = np.ascontiguousarray(corners * self._factor)
        side = corners - np.roll(corners, -1, axis=1)
        longest = lengths(side).max(axis=1)
        exponent = np.frexp(longest)[1]
        unit = np.ldexp(side, -exponent[:, None, None])  # products of lengths may be no doubles
        area = lengths(cross(unit[:, 0], unit[:, 1]))  # twice that
        self.weight, self.longest = AS_LARGE * np.ldexp(np.sqrt(area), exponent), longest
        low, high = bounding_boxes(np.ascontiguousarray(corners))
        reach, far = (self.weight / COARSE_FALL)[:, None], COARSE_REACH * self.longest[:, None]
        self._tree, self._wide = BoxTree(low - reach, high + reach), BoxTree(low - far, high + far)

    def least(self, x: Array, size: Array) -> Array:
        """The sizes at some points, or more where the facets ask for it."""
        return self._most(self._tree, self.weight, COARSE_FALL, x, size)

    def beside(self, x: Array) -> NDArray[np.bool_]:
        """Whether points are so near to a facet that they would be in the way of its recovery."""
        return self._most(self._wide, COARSE_REACH * self.longest, 1.0, x, np.zeros(len(x))) > 0.0

    def _most(self, tree: BoxTree, weight: Array, fall: float, x: Array, least: Array) -> Array:
        factor = self._factor
        found, weight = least * factor, weight * factor
        for i in range(0, len(x), ASKED_OF_FACETS):
            rows = x[i : i + ASKED_OF_FACETS]
            query, hit = tree.pairs(rows, rows)
            _raise(rows * factor, self._corners, weight, query, hit, fall, found[i : i + ASKED_OF_FACETS])
        return found / factor


def coarse_facets(shell: Shell, field: SizeField) -> CoarseFacets | None:
    """The triangles of a body that are much larger than the size; None if there is none.

    Parameters
    ----------
    shell : Shell
        The triangles that stay, inner ones included.
    field : SizeField
        The wanted length of edges.

    Notes
    -----
    A triangle is coarse if an edge is four times as long as wanted in its middle. O(n).
    """
    corners = shell.points[shell.triangles]
    large = np.zeros(len(corners), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        along = corners[:, i] - corners[:, j]
        large |= lengths(along) > MUCH_COARSER * field(corners[:, i] / 2 + corners[:, j] / 2)
    return CoarseFacets(corners[large]) if large.any() else None
