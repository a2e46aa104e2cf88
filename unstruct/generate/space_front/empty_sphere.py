"""The apex of a face of the front by the empty sphere, without a triangulation; and cells made of nothing
else, compiled.

The apex of the face abc is, of all vertices at the front that are *visible* from abc, the one whose sphere
with a, b and c has no other of them inside. d is visible if the solid tetrahedron abcd may be made, in the
sense of `classical_signs`. Only what is ahead of abc counts, where nothing is meshed. There spheres through
a, b and c grow steadily as their centers move ahead, so that one comparison orders all candidates: d is
before e if it is inside the sphere of abce. The apex is the first visible one.

**Ties.** Candidates on one sphere must not be chosen face by face as one likes: their cells would not fit
together. They are ordered as if the height |x|^2 to which each vertex x is lifted were a little larger, much
less for each vertex than for the next one. Nothing is lifted: the sign is that of the vertex with the largest
number whose barycentric coordinate in the equation is not 0 (`given_points` numbers those of the body first,
then the points along a Hilbert curve, so that neighbors are near in memory). Given triangles may have decided
otherwise: then the numbers are changed (`tie_order`). O. Devillers, M. Teillaud,
Perturbations for Delaunay and weighted Delaunay 3D triangulations, Computational Geometry 44 (2011) 160-168.

**When the result is constrained Delaunay.** *Theorem.* If what is not meshed has a constrained Delaunay
tetrahedralization (of these heights), the rule finds it. *Proof.* Let abcd be its cell on abc. Its interior
is not crossed by the front, so d is visible. If e came before d and were visible, abce and abcd would have
points in common near abc, from which e is seen inside the sphere of abcd: this contradicts the definition.
So the rule takes d, and the rest is constrained Delaunay again. In the plane there always is one. In space
there need not be: then cells may have a vertex in their sphere that their neighbors see, and faces may have
no apex at all. Both are counted. Source: the source chapter, 12.3.4; J. R. Shewchuk, Symposium on
Computational Geometry (1998) 76-85. Book: 3.5.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from ...base.codes import DONE, MORE, ROOM
from ...base.jit import apart, inline, lean
from ...geometry.triangle_pairs import side
from ...predicates.kernels import insphere
from ..advancing.digital_tree import gather
from ..advancing.rows import ALIVE, CELLS_MADE, in_turn, next_in_turn
from .classical_open import close_cell, has_space
from .classical_signs import CELL_FREE, cell_fault, set_cell
from .classical_steps import NO_CELL

__all__ = ["APEX_COUNTS", "HIDDEN_APEXES", "OTHERS_ON_SPHERE", "start_in_age", "wrap_in_space"]

OTHERS_ON_SPHERE, HIDDEN_APEXES, APEX_COUNTS = range(3)
FIRST_CENTER, CENTER_GROWTH, FARTHEST_CENTER = (
    0.4,
    3.0,
    4000.0,
)  # of spheres that are searched; in circumradii


@apart
def sphere_side(xyz, a, b, c, d, p):
    """1 if p is inside the sphere of the positive cell abcd, 0 if it is on it, -1 outside."""
    return insphere(
        xyz[a, 0], xyz[a, 1], xyz[a, 2], xyz[b, 0], xyz[b, 1], xyz[b, 2], xyz[c, 0], xyz[c, 1], xyz[c, 2],
        xyz[d, 0], xyz[d, 1], xyz[d, 2], xyz[p, 0], xyz[p, 1], xyz[p, 2],
    )  # fmt: skip


@apart
def tie_broken(xyz, a, b, c, d, p):
    """Whether p on the sphere of the positive cell abcd is inside of it if heights are a little larger.

    With barycentric coordinates l of p, p is inside if its height is less than the sum of those of a, b, c, d
    times l. The vertex with the largest number decides, unless its l is 0; d and p, both ahead of abc, have
    signs.
    """
    low = np.int64(9223372036854775807)
    while True:
        top = np.int64(-1)
        for v in (a, b, c, d, p):
            if top < v < low:
                top = v
        low = top
        sign = 0
        if top == p:
            return False
        if top == d:
            return True
        if top == a:
            sign = side(xyz, p, b, c, d)
        elif top == b:
            sign = side(xyz, a, p, c, d)
        else:
            sign = side(xyz, a, b, p, d)
        if sign != 0:
            return sign > 0


@lean
def comes_before(xyz, cell, d, p):
    """Whether p comes before d ahead of the face of the cell that is looked at."""
    sign = sphere_side(xyz, cell[0], cell[1], cell[2], d, p)
    return tie_broken(xyz, cell[0], cell[1], cell[2], d, p) if sign == 0 else sign > 0


@inline
def circle_of(xyz, cell, place):
    """Write circumcenter and unit normal of the face to two rows; return the radius, inf if it is flat."""
    a, b, c = cell[0], cell[1], cell[2]
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square, uu, vv = nx * nx + ny * ny + nz * nz, ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    if not square > 1e-8 * uu * vv:  # else rounding may exceed the room below
        return inf
    wx, wy, wz = uu * vx - vv * ux, uu * vy - vv * uy, uu * vz - vv * uz
    ox = 0.5 * (wy * nz - wz * ny) / square
    oy = 0.5 * (wz * nx - wx * nz) / square
    oz = 0.5 * (wx * ny - wy * nx) / square
    length = sqrt(square)
    place[0, 0], place[0, 1], place[0, 2] = xyz[a, 0] + ox, xyz[a, 1] + oy, xyz[a, 2] + oz
    place[1, 0], place[1, 1], place[1, 2] = nx / length, ny / length, nz / length
    return sqrt(ox * ox + oy * oy + oz * oz)


@lean
def gather_ahead(front, radius, k, candidates):
    """The vertices ahead of the face in the sphere with its center ``k`` radii ahead; return how many.

    Others just outside may be among them. From `FARTHEST_CENTER` on, all that are ahead.
    """
    xyz, cell, found, place = front.xyz, front.cell, front.vertices.found, front.corners
    everything = not k < FARTHEST_CENTER
    x = y = z = 0.0
    r = 1.0
    if not everything:
        x, y, z = place[0, 0] + k * radius * place[1, 0], place[0, 1] + k * radius * place[1, 1], 0.0
        z = place[0, 2] + k * radius * place[1, 2]
        r = radius * sqrt(1.0 + k * k) * (1.0 + 1e-9) + 1e-14
    count = 0
    for i in range(gather(front.vertices, (x - r, y - r, z - r, x + r, y + r, z + r))):
        v = np.int64(found[i])
        dx, dy, dz = xyz[v, 0] - x, xyz[v, 1] - y, xyz[v, 2] - z
        if (everything or dx * dx + dy * dy + dz * dz <= r * r) and (
            v != cell[0] and v != cell[1] and v != cell[2] and side(xyz, cell[0], cell[1], cell[2], v) > 0
        ):
            candidates[count] = v
            count += 1
    return count


@inline
def is_within(front, radius, k, v):
    """Whether v is for certain inside the sphere with its center ``k`` radii ahead."""
    place, xyz = front.corners, front.xyz
    dx = xyz[v, 0] - place[0, 0] - k * radius * place[1, 0]
    dy = xyz[v, 1] - place[0, 1] - k * radius * place[1, 1]
    dz = xyz[v, 2] - place[0, 2] - k * radius * place[1, 2]
    return sqrt(dx * dx + dy * dy + dz * dz) < radius * sqrt(1.0 + k * k) * (1.0 - 1e-9) - 1e-14


@lean
def first_visible(front, row, candidates, count, counts):
    """The first candidate in the order of spheres that is visible, -1 for none; hidden ones are dropped."""
    xyz, cell = front.xyz, front.cell
    while count > 0:
        best = 0
        for i in range(1, count):
            if comes_before(xyz, cell, candidates[best], candidates[i]):
                best = i
        v = candidates[best]
        count -= 1
        candidates[best] = candidates[count]
        cell[3] = v
        if cell_fault(front) == CELL_FREE:
            return v, count
        counts[HIDDEN_APEXES] += 1
    return np.int64(-1), 0


@lean
def has_tie(front, v, candidates, count):
    """Whether another visible candidate is on the sphere of the apex v."""
    xyz, cell = front.xyz, front.cell
    for i in range(count):
        if sphere_side(xyz, cell[0], cell[1], cell[2], v, candidates[i]) == 0:
            cell[3] = candidates[i]
            if cell_fault(front) == CELL_FREE:
                return True
    return False


@inline
def next_center(front, radius, k, v):
    """The center, in radii ahead, of the next sphere to be searched: that of the apex so far, and some more.

    Without an apex so far, and if the sphere is lost to rounding, the centers grow.
    """
    wider = k * CENTER_GROWTH
    if v < 0:
        return wider
    place, xyz = front.corners, front.xyz
    dx, dy, dz = xyz[v, 0] - place[0, 0], xyz[v, 1] - place[0, 1], xyz[v, 2] - place[0, 2]
    high = dx * place[1, 0] + dy * place[1, 1] + dz * place[1, 2]
    own = (dx * dx + dy * dy + dz * dz - radius * radius) / (2.0 * radius * high) if high > 0.0 else inf
    return 1.05 * own + 0.05 if k < own < FARTHEST_CENTER else wider


@apart
def apex_by_sphere(front, row, candidates, counts):
    """The apex of a face, -1 for none, and whether another one would do; small spheres are searched first."""
    set_cell(front, row, front.corner[row, 0])
    radius, k = circle_of(front.xyz, front.cell, front.corners), FIRST_CENTER
    if radius == inf:
        k = FARTHEST_CENTER
    while True:
        hidden = counts[HIDDEN_APEXES]
        count = gather_ahead(front, radius, k, candidates)
        v, count = first_visible(front, row, candidates, count, counts)
        if not k < FARTHEST_CENTER or (v >= 0 and is_within(front, radius, k, v)):
            return v, v >= 0 and has_tie(front, v, candidates, count)
        counts[HIDDEN_APEXES] = hidden  # each is counted once
        k = next_center(front, radius, k, v)


@inline
def wait_in_age(front, waiting, row):
    """Put a face into the queue, the oldest first."""
    in_turn(waiting, front.stamp, row, float(front.stamp[row]))


@lean
def start_in_age(front, waiting):
    """Put all faces into the queue, the oldest first."""
    for row in range(len(front.corner)):
        if front.corner[row, 0] >= 0:
            wait_in_age(front, waiting, np.int64(row))


@lean
def wrap_in_space(front, waiting, ties, counts, limit):
    """Make up to ``limit`` cells by the empty sphere; return DONE, MORE, ROOM, or NO_CELL.

    ``ties`` gets 1 for cells whose sphere has another visible vertex on it. A face without an apex stays.
    """
    for _ in range(limit):
        if not has_space(front) or waiting.many[0] + 8 > len(waiting.keys):
            return ROOM
        if front.state[CELLS_MADE] >= len(ties):
            return ROOM
        row, _ = next_in_turn(waiting, front.stamp)
        if row < 0:
            return DONE if front.state[ALIVE] == 0 else NO_CELL
        v, tied = apex_by_sphere(front, row, waiting.candidates, counts)
        if v < 0:
            continue
        ties[front.state[CELLS_MADE]] = tied
        counts[OTHERS_ON_SPHERE] += tied
        for new in close_cell(front, row, v):
            if new >= 0:
                wait_in_age(front, waiting, new)
    return MORE
