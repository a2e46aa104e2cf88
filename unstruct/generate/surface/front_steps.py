"""The steps of the front on a surface: the classical one, with its ideal points in tangent planes.

A step takes the edge of the front at which the wanted length is least, the oldest of these. In the tangent
plane of the edge, to its left, lies the ideal point, which makes sides of the wanted length; it is moved to
the nearest point of the surface that faces the same way. Vertices of the front around it are tried by their
distance from it, then itself, if it is clear of the front; if all fail, vertices in wider balls by the
circumradius of their triangles. What fails even so waits, and is tried again after the others.

Sources: J. Peraire, J. Peiró, L. Formaggia, K. Morgan, O. C. Zienkiewicz, *Finite element Euler computations
in three dimensions*, Int. J. Numer. Meth. Engng 26 (1988) 2135-2159; R. Löhner, P. Parikh, *Generation of
three-dimensional unstructured grids by the advancing-front method*, Int. J. Numer. Meth. Fluids 8 (1988)
1135-1149. Book: 2.7.
"""

from __future__ import annotations

from math import frexp, inf, sqrt

import numpy as np

from ...base.heap import pop, push
from ...base.jit import kernel, lean
from ...geometry.support_walk import nearest_from
from .front_near import fault_of, gather_near, matching_edge, project
from .front_records import (
    FRONT_EDGES,
    FRONT_TRIANGLES,
    FRONT_VERTICES,
    close_edge,
    enter_front_vertex,
    open_edge,
)
from .front_work import (
    BY_CANDIDATE,
    BY_POINT,
    BY_SEARCH,
    FRONT_CLOSED,
    FRONT_FULL,
    FRONT_PAUSED,
    FRONT_STUCK,
    LATER_AGAIN,
    between,
    roundness,
    wanted_at,
)

__all__ = ["advance", "first_triangle", "open_curves"]

LEAST_SIDE, MOST_SIDE = 0.55, 2.0  # of the sides of a new triangle, in lengths of the edge
AROUND_IDEAL = 0.75  # radius of the search for candidates, in sides
CLEAR_OF_FRONT = 0.5  # the least distance of a new point from the front, in sides
LEAST_ROUND = 0.3  # 2 r / R of triangles with a candidate
LEAST_FACING = 0.3  # product of the normals of a new triangle and of its edge
SEEN_REACH = (2.5, 5.0)  # radii of the balls that are searched, in sides
LATER_ROUNDS = 4  # how often edges that had to wait are tried again
SMALL_STEPS = 16.0  # parts of an octave that count as one length in the queue


@lean
def _wait(run, e):
    """Put an edge of the front into the queue."""
    front, x = run.front, run.x[3]
    u, v = front.ends[e, 0], front.ends[e, 1]
    for m in range(3):
        x[m] = 0.5 * (front.xyz[u, m] + front.xyz[v, m])
    h = wanted_at(run, x, front.seat[e])
    part, exponent = frexp(h)
    steps = SMALL_STEPS * exponent + np.floor(2.0 * SMALL_STEPS * part)
    run.many[0] = push(run.keys, run.waiting, run.many[0], steps * 4294967296.0 + front.stamp[e], e)


@lean
def _open(run, u, v, n, seat):
    """Put a new edge into the front and into the queue; its normal is that of the surface at its middle."""
    front, x, held = run.front, run.x, run.held
    for m in range(3):
        x[3, m] = 0.5 * (front.xyz[u, m] + front.xyz[v, m])
    t = nearest_from(held, x, 3, n, seat, run.place, run.stack)
    product = 0.0
    for m in range(3):
        product += held.normals[t, m] * n[m]
    _wait(run, open_edge(front, u, v, held.normals[t] if product > LEAST_FACING else n, t))


@lean
def _facing(front, nearby, a, b, p):
    """Write the normal of the triangle a, b, p to the last row of the frame; its product with the frame's."""
    xyz, f = front.xyz, nearby.frame
    ux, uy, uz = xyz[b, 0] - xyz[a, 0], xyz[b, 1] - xyz[a, 1], xyz[b, 2] - xyz[a, 2]
    vx, vy, vz = p[0] - xyz[a, 0], p[1] - xyz[a, 1], p[2] - xyz[a, 2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return -1.0
    f[4, 0], f[4, 1], f[4, 2] = x / length, y / length, z / length
    return (x * f[3, 0] + y * f[3, 1] + z * f[3, 2]) / length


@lean
def _accept(run, e, c):
    """Make the triangle on an edge of the front with this third corner."""
    front, n = run.front, run.nearby.frame[4]
    a, b, seat = front.ends[e, 0], front.ends[e, 1], front.seat[e]
    t = front.state[FRONT_TRIANGLES]
    front.triangles[t, 0], front.triangles[t, 1], front.triangles[t, 2] = a, b, c
    front.home[t] = seat
    front.state[FRONT_TRIANGLES] = t + 1
    one, two = matching_edge(front, c, a, n), matching_edge(front, b, c, n)
    if one < 0:
        _open(run, a, c, n, seat)
    if two < 0:
        _open(run, c, b, n, seat)
    if one >= 0:
        close_edge(front, one)
    if two >= 0:
        close_edge(front, two)
    close_edge(front, e)


@lean
def _set_frame(run, e):
    """The frame of an edge; returns its length, 0 if it has none, or no direction of the surface."""
    front, f = run.front, run.nearby.frame
    a, b, n = front.ends[e, 0], front.ends[e, 1], front.normal[e]
    length = between(front.xyz[a], front.xyz[b])
    if length == 0.0:
        return 0.0
    along = 0.0
    for m in range(3):
        f[0, m] = 0.5 * (front.xyz[a, m] + front.xyz[b, m])
        f[1, m] = (front.xyz[b, m] - front.xyz[a, m]) / length
        along += n[m] * f[1, m]
    for m in range(3):
        f[3, m] = n[m] - along * f[1, m]
    square = sqrt(f[3, 0] * f[3, 0] + f[3, 1] * f[3, 1] + f[3, 2] * f[3, 2])
    if square == 0.0:
        return 0.0
    for m in range(3):
        f[3, m] /= square
    f[2, 0] = f[3, 1] * f[1, 2] - f[3, 2] * f[1, 1]
    f[2, 1] = f[3, 2] * f[1, 0] - f[3, 0] * f[1, 2]
    f[2, 2] = f[3, 0] * f[1, 1] - f[3, 1] * f[1, 0]
    return length


@lean
def _ideal(run, e, height):
    """Write the ideal point on the surface to ``x[0]``; returns its triangle."""
    f, x, seat = run.nearby.frame, run.x, run.front.seat[e]
    for m in range(3):
        x[0, m] = f[0, m] + height * f[2, m]
    for again in range(2):
        seat = nearest_from(run.held, x, 0, f[3], seat, run.place, run.stack)
        for m in range(3):
            x[0, m] = 0.0
            for k in range(3):
                x[0, m] += run.place[k] * run.held.corners[seat, k, m]
        if again == 0:  # once more, at the wanted distance from the middle of the edge
            away = between(x[0], f[0])
            if away > 0.1 * height:
                for m in range(3):
                    x[0, m] = f[0, m] + (x[0, m] - f[0, m]) * height / away
    return seat


@lean
def _candidates(run, e, radius):
    """Sort the vertices in a ball around ``x[0]`` by distance, or all, by circumradius, if it is infinite."""
    front, nearby = run.front, run.nearby
    a, b, count = front.ends[e, 0], front.ends[e, 1], 0
    for i in range(nearby.many[0]):
        v = nearby.vertex[i]
        if v == a or v == b:
            continue
        if radius < inf:
            key = between(front.xyz[v], run.x[0])
        else:
            key = roundness(front.xyz[a], front.xyz[b], front.xyz[v])[1]
        if key > radius or key == inf:
            continue
        k = count
        while k > 0 and (
            run.measure[k - 1] > key or (run.measure[k - 1] == key and run.candidate[k - 1] > v)
        ):
            run.measure[k], run.candidate[k] = run.measure[k - 1], run.candidate[k - 1]
            k -= 1
        run.measure[k], run.candidate[k] = key, v
        count += 1
    return count


@lean
def _is_clear(run, e, p, least):
    """Whether a point of the plane is so far from all edges of the front but the one."""
    front, nearby = run.front, run.nearby
    for i in range(nearby.many[1]):
        other = nearby.edge[i]
        if other == e:
            continue
        u, v = nearby.place[front.ends[other, 0]], nearby.place[front.ends[other, 1]]
        sx, sy, px, py = v[0] - u[0], v[1] - u[1], p[0] - u[0], p[1] - u[1]
        square = sx * sx + sy * sy
        t = min(max((sx * px + sy * py) / square, 0.0), 1.0) if square > 0.0 else 0.0
        if (px - t * sx) ** 2 + (py - t * sy) ** 2 < least * least:
            return False
    for i in range(nearby.many[0]):
        v = nearby.vertex[i]
        if front.loose[v] == 1:
            q = nearby.place[v]
            if (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 < least * least:
                return False
    for i in range(nearby.many[3]):  # of what is meshed: the point would lie in it
        if between(front.xyz[nearby.inner[i]], run.x[0]) < least:
            return False
    return True


@lean
def _step(run, e):
    """Make a triangle on an edge of the front; False if none is found."""
    front, nearby = run.front, run.nearby
    a, b, part = front.ends[e, 0], front.ends[e, 1], front.part[front.ends[e, 0]]
    length = _set_frame(run, e)
    if length == 0.0:  # beside triangles that are flat, as are all behind them
        return False
    side = min(max(wanted_at(run, nearby.frame[0], front.seat[e]), LEAST_SIDE * length), MOST_SIDE * length)
    seat = _ideal(run, e, sqrt(side * side - 0.25 * length * length))
    gather_near(front, nearby, part, SEEN_REACH[0] * max(side, length))
    count = _candidates(run, e, AROUND_IDEAL * side)
    for i in range(count):
        c = run.candidate[i]
        if _facing(front, nearby, a, b, front.xyz[c]) < LEAST_FACING:
            continue
        if roundness(front.xyz[a], front.xyz[b], front.xyz[c])[0] < LEAST_ROUND:
            continue
        if fault_of(front, nearby, a, b, c, nearby.place[c]) == 0:
            _accept(run, e, c)
            run.counts[BY_CANDIDATE] += 1
            return True
    p = run.place
    p[4], p[5] = project(nearby, run.x[0], 0), project(nearby, run.x[0], 1)
    if (
        _facing(front, nearby, a, b, run.x[0]) >= LEAST_FACING
        and _is_clear(run, e, p[4:], CLEAR_OF_FRONT * side)
        and fault_of(front, nearby, a, b, -1, p[4:]) == 0
    ):
        c = enter_front_vertex(front, run.x[0], wanted_at(run, run.x[0], seat), seat, part)
        _accept(run, e, c)
        run.counts[BY_POINT] += 1
        return True
    for k in range(2):
        if k > 0:
            gather_near(front, nearby, part, SEEN_REACH[k] * max(side, length))
        count = _candidates(run, e, inf)
        for i in range(count):
            c = run.candidate[i]
            if _facing(front, nearby, a, b, front.xyz[c]) > 0.0:
                if fault_of(front, nearby, a, b, c, nearby.place[c]) == 0:
                    _accept(run, e, c)
                    run.counts[BY_SEARCH] += 1
                    return True
    return False


@kernel
def advance(run, later, march, steps):
    """Advance the front until it is empty, or stuck, or there is no room, or after so many steps.

    ``later`` is scratch for edges. ``march`` (3,) is kept from call to call, and zero before the first: how
    many edges wait in ``later``, what was made since they began to wait, and how often they were tried again.
    """
    front, waits, made, rounds = run.front, march[0], march[1], march[2]
    for _ in range(steps):
        if run.many[0] == 0:
            if waits == 0:
                return FRONT_CLOSED
            if made == 0 or rounds == LATER_ROUNDS:
                return FRONT_STUCK
            rounds += 1
            for i in range(waits):
                if front.stamp[later[i]] >= 0:
                    _wait(run, later[i])
            run.counts[LATER_AGAIN] += waits
            waits = made = 0
            continue
        if (
            front.state[FRONT_VERTICES] + 4 > run.choices.most
            or front.state[FRONT_EDGES] + 8 > front.stamp.shape[0]
            or front.state[FRONT_TRIANGLES] + 4 > front.home.shape[0]
            or run.many[0] + waits + 8 > run.keys.shape[0]
        ):
            return FRONT_FULL
        e = run.waiting[0]
        run.many[0] = pop(run.keys, run.waiting, run.many[0])
        if front.stamp[e] < 0:
            continue
        if _step(run, e):
            made += 1
        else:
            later[waits] = e
            waits += 1
    march[0], march[1], march[2] = waits, made, rounds
    return FRONT_PAUSED


@kernel
def open_curves(run, rows, normals, seats):
    """Put the edges of curves into the front, and let them wait."""
    for i in range(rows.shape[0]):
        _wait(run, open_edge(run.front, rows[i, 0], rows[i, 1], normals[i], seats[i]))


@kernel
def first_triangle(run, v):
    """Make a triangle at a vertex of a component that has no front; whether it could be done."""
    front, f = run.front, run.nearby.frame
    n, part, seat = run.held.normals[front.near[v]], front.part[v], front.near[v]
    side = wanted_at(run, front.xyz[v], seat)
    axis = 0 if abs(n[0]) <= min(abs(n[1]), abs(n[2])) else (1 if abs(n[1]) <= abs(n[2]) else 2)
    along = n[axis]
    square = 1.0 / sqrt(1.0 - along * along)
    for m in range(3):
        run.x[0, m] = front.xyz[v, m] + side * square * ((1.0 if m == axis else 0.0) - along * n[m])
    t = nearest_from(run.held, run.x, 0, n, seat, run.place, run.stack)
    for m in range(3):
        run.x[1, m] = 0.0
        for k in range(3):
            run.x[1, m] += run.place[k] * run.held.corners[t, k, m]
    if between(run.x[1], front.xyz[v]) < 0.5 * side:
        return False
    w = enter_front_vertex(front, run.x[1], side, t, part)
    for m in range(3):
        f[4, m] = n[m]
    one = open_edge(front, v, w, n, seat)
    two = open_edge(front, w, v, n, seat)
    _wait(run, two)
    if not _step(run, one):
        close_edge(front, one)
        close_edge(front, two)
        return False
    return True
