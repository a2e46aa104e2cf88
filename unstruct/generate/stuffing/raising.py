"""Cells with small or large angles where levels meet at the surface: their vertices move to better places.

The theorem speaks of leaves of one size. Where sizes meet at the surface, vertices move less before they are
cut, so that cut points may be near a vertex inside. What is done about it keeps the surface: a vertex on it
goes to another cut point of its edges, a vertex inside anywhere. If that is not enough, a vertex joins the
surface, or leaves it, where the surface is a disc around it, so that nothing is connected in another way. A
change is made only if the worst cell at the vertex becomes better, and, by exact signs, no piece and no
tetrahedron of the background turns over. So pieces cannot overlap: before vertices inside move, they lie in
tetrahedra of the background that do not; and those moves keep the boundary. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.jit import apart, kernel, lean
from ...geometry.triangle_pairs import side
from .stencils import Cuts, pieces_of

__all__ = [
    "LARGEST_COSINE",
    "SMALLEST_COSINE",
    "Stars",
    "State",
    "is_disc",
    "raise_stars",
    "room_of",
    "survey_pieces",
]

LARGEST_COSINE, SMALLEST_COSINE = 0.984807753012208, -0.965925826289068  # of 10 and of 165 degrees
BOTH_COSINES = LARGEST_COSINE + SMALLEST_COSINE  # so much better are large angles than small ones, as cosines
NOT_POSITIVE = 9.0  # the badness of cells that are not positive
LEAST_PROGRESS = 1e-4
LARGEST_STEP, SMALLEST_STEP = 0.25, 0.01  # of vertices inside, as shares of the shortest edge there
MOST_STEPS_WITHIN = 24


class State(NamedTuple):
    """What is filled now.

    Attributes
    ----------
    xyz : (n + e, 3) float64
        The places of the background's vertices, then the cut points of crossed edges.
    image : (n, 3) float64
        The places of vertices if none inside had moved.
    lattice : (n, 3) float64
        Their places in the lattice.
    place : (n, 3) int64
    sign, original : (n,) int8
        Of vertices, now and before any moved.
    keys : (e,) int64
        See `Cuts`.
    least : (n,) float64
        The length of the shortest edge at each vertex.
    """

    xyz: NDArray[np.float64]
    image: NDArray[np.float64]
    lattice: NDArray[np.float64]
    place: NDArray[np.int64]
    sign: NDArray[np.int8]
    original: NDArray[np.int8]
    keys: NDArray[np.int64]
    least: NDArray[np.float64]


class Stars(NamedTuple):
    """All tetrahedra of the background at some vertices: ``rows[start[v]:start[v + 1]]`` are those at v."""

    cells: NDArray[np.int32]
    start: NDArray[np.int64]
    rows: NDArray[np.int64]


class Room(NamedTuple):
    """Room for pieces, for the corners of a tetrahedron, for the edges around a vertex, for pieces at it."""

    out: NDArray[np.int64]
    t: NDArray[np.int64]
    rim: NDArray[np.int64]
    at: NDArray[np.int64]


@apart
def _badness(xyz, a, b, c, d):
    """The largest cosine of a dihedral angle, or what counts as much of a large one; or `NOT_POSITIVE`."""
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = xyz[c, 0] - xyz[a, 0], xyz[c, 1] - xyz[a, 1], xyz[c, 2] - xyz[a, 2]
    wx, wy, wz = xyz[d, 0] - xyz[a, 0], xyz[d, 1] - xyz[a, 1], xyz[d, 2] - xyz[a, 2]
    # inward normals of the faces opposite b, c, d and a, up to a common factor
    px, py, pz = vy * wz - vz * wy, vz * wx - vx * wz, vx * wy - vy * wx
    qx, qy, qz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
    rx, ry, rz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sx, sy, sz = -(px + qx + rx), -(py + qy + ry), -(pz + qz + rz)
    p, q, r, s = (
        px * px + py * py + pz * pz, qx * qx + qy * qy + qz * qz,
        rx * rx + ry * ry + rz * rz, sx * sx + sy * sy + sz * sz,
    )  # fmt: skip
    if not (p > 0.0 and q > 0.0 and r > 0.0 and s > 0.0) or ux * px + uy * py + uz * pz <= 0.0:
        return NOT_POSITIVE
    worst = -1.0
    for k in range(6):
        if k == 0:
            cos = -(px * qx + py * qy + pz * qz) / np.sqrt(p * q)
        elif k == 1:
            cos = -(px * rx + py * ry + pz * rz) / np.sqrt(p * r)
        elif k == 2:
            cos = -(qx * rx + qy * ry + qz * rz) / np.sqrt(q * r)
        elif k == 3:
            cos = -(px * sx + py * sy + pz * sz) / np.sqrt(p * s)
        elif k == 4:
            cos = -(qx * sx + qy * sy + qz * sz) / np.sqrt(q * s)
        else:
            cos = -(rx * sx + ry * sy + rz * sz) / np.sqrt(r * s)
        worst = max(worst, cos, BOTH_COSINES - cos)
    return worst


@lean
def _load(state, stars, i, room):
    """The pieces of a tetrahedron at a vertex; returns their number."""
    for k in range(4):
        room.t[k] = stars.cells[stars.rows[i], k]
    n = np.int64(len(state.sign))
    return pieces_of(room.t, state.sign, state.place, Cuts(state.keys, n), n, room.out, 0)


@apart
def _star_badness(state, stars, v, limit, room):
    """The worst badness of pieces in the star of v; as soon as it reaches the limit, that."""
    worst, out = -1.0, room.out
    for i in range(stars.start[v], stars.start[v + 1]):
        for j in range(_load(state, stars, i, room)):
            worst = max(worst, _badness(state.xyz, out[j, 0], out[j, 1], out[j, 2], out[j, 3]))
            if worst >= limit:
                return worst
    return worst


@apart
def _star_positive(state, stars, v, images, room):
    """Whether all pieces in the star of v are positive, exactly; with `images`, also its tetrahedra."""
    out = room.out
    for i in range(stars.start[v], stars.start[v + 1]):
        c = stars.cells[stars.rows[i]]
        if images and side(state.image, c[0], c[1], c[2], c[3]) <= 0:
            return False
        for j in range(_load(state, stars, i, room)):
            if side(state.xyz, out[j, 0], out[j, 1], out[j, 2], out[j, 3]) <= 0:
                return False
    return True


@apart
def _gather(state, stars, v, room):
    """List the pieces at v; returns their number, and the worst badness of the others in its star.

    The others do not change when v moves.
    """
    count, worst, out, at = 0, -1.0, room.out, room.at
    for i in range(stars.start[v], stars.start[v + 1]):
        for j in range(_load(state, stars, i, room)):
            if out[j, 0] == v or out[j, 1] == v or out[j, 2] == v or out[j, 3] == v:
                for k in range(4):
                    at[count, k] = out[j, k]
                count += 1
            else:
                worst = max(worst, _badness(state.xyz, out[j, 0], out[j, 1], out[j, 2], out[j, 3]))
    return count, worst


@apart
def _badness_at(xyz, at, count, worst, limit):
    """The worst of `worst` and of the badness of pieces; as soon as it reaches the limit, that."""
    for i in range(count):
        if worst >= limit:
            return worst
        worst = max(worst, _badness(xyz, at[i, 0], at[i, 1], at[i, 2], at[i, 3]))
    return worst


@lean
def _put(xyz, v, x, y, z):
    xyz[v, 0], xyz[v, 1], xyz[v, 2] = x, y, z


@lean
def _put_both(state, v, x, y, z):
    _put(state.xyz, v, x, y, z)
    _put(state.image, v, x, y, z)


@apart
def _to_cut(state, stars, v, best, room):
    """Move v, which is on the surface, to the best other cut point of its edges; returns the badness then."""
    n, xyz, image = np.int64(len(state.sign)), state.xyz, state.image
    x, y, z = xyz[v, 0], xyz[v, 1], xyz[v, 2]
    a, b, c = image[v, 0], image[v, 1], image[v, 2]
    count, others = _gather(state, stars, v, room)
    for i in range(stars.start[v], stars.start[v + 1]):
        for k in range(4):
            w = stars.cells[stars.rows[i], k]
            if state.original[w] * state.original[v] >= 0:
                continue
            at = n + np.searchsorted(state.keys, np.int64(min(v, w)) * n + max(v, w))
            _put_both(state, v, xyz[at, 0], xyz[at, 1], xyz[at, 2])
            now = _badness_at(xyz, room.at, count, others, best)
            if now < best - LEAST_PROGRESS and _star_positive(state, stars, v, True, room):
                best, x, y, z = now, xyz[v, 0], xyz[v, 1], xyz[v, 2]
                a, b, c = x, y, z
    _put(xyz, v, x, y, z)
    _put(image, v, a, b, c)
    return best


@apart
def _within(state, stars, v, best, room):
    """Move v, which is inside, to a better place by a pattern search; returns the badness then."""
    xyz, step = state.xyz, LARGEST_STEP * state.least[v]
    x, y, z = xyz[v, 0], xyz[v, 1], xyz[v, 2]
    count, others = _gather(state, stars, v, room)
    for _ in range(MOST_STEPS_WITHIN):
        u, v0, w, found = x, y, z, False
        for k in range(27):
            _put(xyz, v, x + step * (k % 3 - 1), y + step * (k // 3 % 3 - 1), z + step * (k // 9 - 1))
            now = _badness_at(xyz, room.at, count, others, best)
            if now < best - LEAST_PROGRESS and _star_positive(state, stars, v, False, room):
                best, found = now, True
                u, v0, w = xyz[v, 0], xyz[v, 1], xyz[v, 2]
        x, y, z = u, v0, w
        if not found:
            step *= 0.5
        if best < LARGEST_COSINE or step < SMALLEST_STEP * state.least[v]:
            break
    _put(xyz, v, x, y, z)
    return best


@apart
def _rim(state, stars, v, room):
    """Write the edges across from v that bound the pieces at v; returns their number."""
    count, out, rim = 0, room.out, room.rim
    for i in range(stars.start[v], stars.start[v + 1]):
        for j in range(_load(state, stars, i, room)):
            at = -1
            for k in range(4):
                if out[j, k] == v:
                    at = k
            if at < 0:
                continue
            x, y, z = out[j, (at + 1) & 3], out[j, (at + 2) & 3], out[j, (at + 3) & 3]
            if at & 1:
                x, y = y, x
            for k in range(3):
                a, b = (x, y) if k == 0 else (y, z) if k == 1 else (z, x)
                twin = -1
                for h in range(count):
                    if rim[h, 0] == b and rim[h, 1] == a:
                        twin = h
                if twin >= 0:
                    count -= 1
                    rim[twin, 0], rim[twin, 1] = rim[count, 0], rim[count, 1]
                else:
                    rim[count, 0], rim[count, 1] = a, b
                    count += 1
    return count


@lean
def _beginning(rim, count, a):
    """The only edge that begins at a, or -1."""
    at = -1
    for h in range(count):
        if rim[h, 0] == a:
            if at >= 0:
                return -1
            at = h
    return at


@apart
def is_disc(state, stars, v, room):
    """Whether the surface is a disc around v if v is on it, with all its neighbors there in the rim.

    Then the body and what is outside are connected in the same way whether v is inside, outside or on the
    surface, and neither touches itself at v.
    """
    old, rim = state.sign[v], room.rim
    state.sign[v] = 0
    count = _rim(state, stars, v, room)
    state.sign[v] = old
    at, steps = 0, 0
    while steps < count and at >= 0:
        at = _beginning(rim, count, rim[at, 1])
        steps += 1
        if at == 0:
            break
    if count < 3 or at != 0 or steps != count:
        return False
    for i in range(stars.start[v], stars.start[v + 1]):
        c, zeros = stars.cells[stars.rows[i]], 0
        for k in range(4):
            if c[k] == v or state.sign[c[k]] != 0:
                continue
            zeros += 1
            at = _beginning(rim, count, c[k])
            if at < 0:
                return False
            for j in range(k):
                if c[j] != v and state.sign[c[j]] == 0 and rim[at, 1] != c[j]:
                    if rim[_beginning(rim, count, c[j]), 1] != c[k]:
                        return False
        if zeros == 3:
            return False
    return True


@apart
def _switch(state, stars, v, best, room):
    """Let v join the surface, or leave it, if that is better; returns the badness then."""
    xyz, image, sign, lattice = state.xyz, state.image, state.sign[v], state.lattice
    x, y, z = xyz[v, 0], xyz[v, 1], xyz[v, 2]
    a, b, c = image[v, 0], image[v, 1], image[v, 2]
    if sign != 0:
        state.sign[v] = 0
        now = _to_cut(state, stars, v, best, room)
    else:
        state.sign[v] = state.original[v]
        _put_both(state, v, lattice[v, 0], lattice[v, 1], lattice[v, 2])
        now = _star_badness(state, stars, v, best, room)
        if now >= best - LEAST_PROGRESS or not _star_positive(state, stars, v, True, room):
            now = best
    if now >= best:
        state.sign[v] = sign
        _put(xyz, v, x, y, z)
        _put(image, v, a, b, c)
        return best
    return now


def room_of(stars: Stars) -> Room:
    """Enough for the star with most tetrahedra."""
    most = int((stars.start[1:] - stars.start[:-1]).max(initial=0))
    return Room(*(np.empty(shape, dtype=np.int64) for shape in ((3, 4), 4, (9 * most, 2), (3 * most, 4))))


@kernel
def raise_stars(state, stars, vertices, switching, room):
    """Visit these vertices in their order; returns how many changes there were."""
    changes = 0
    for v in vertices:
        before = best = _star_badness(state, stars, v, NOT_POSITIVE, room)
        if best < LARGEST_COSINE or best >= NOT_POSITIVE:
            continue
        if state.sign[v] > 0:
            best = _within(state, stars, v, best, room)
        elif state.sign[v] == 0 and state.original[v] != 0:
            best = _to_cut(state, stars, v, best, room)
        if best >= LARGEST_COSINE and switching and state.original[v] != 0:
            if is_disc(state, stars, v, room):
                best = _switch(state, stars, v, best, room)
        changes += best < before
    return changes


@kernel
def survey_stars(state, stars, room, bad):
    """Write the worst badness of pieces for each of the rows."""
    out = room.out
    for i in range(len(stars.rows)):
        bad[i] = -1.0
        for j in range(_load(state, stars, i, room)):
            bad[i] = max(bad[i], _badness(state.xyz, out[j, 0], out[j, 1], out[j, 2], out[j, 3]))


@kernel
def survey_pieces(xyz, cells, bad):
    """Write the badness of cells: below `LARGEST_COSINE` if all angles are from 10 to 165 degrees."""
    for i in range(len(cells)):
        bad[i] = _badness(xyz, cells[i, 0], cells[i, 1], cells[i, 2], cells[i, 3])
