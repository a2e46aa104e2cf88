"""A whole march of the front over a surface: from its curves, or first triangles, to triangles everywhere."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.support import Support
from ...sizing.field import SizeField
from ...sizing.space_table import SpaceNodes, space_nodes
from .front_near import nearby_arrays
from .front_records import (
    FRONT_TRIANGLES,
    FRONT_VERTICES,
    enter_front_vertex,
    in_grid,
    octave_of,
    surface_front_arrays,
)
from .front_sizes import caps_of, parts_of
from .front_start import CutCurves, cut_curves, sides_of_curves
from .front_steps import advance, first_triangle, open_curves
from .front_work import (
    BY_CANDIDATE,
    BY_POINT,
    BY_SEARCH,
    FRONT_FULL,
    FRONT_PAUSED,
    FRONT_STUCK,
    LATER_AGAIN,
    FrontChoices,
    FrontRun,
    front_run,
    wanted_lengths,
)

__all__ = ["MarchedFront", "marched", "surface_sizes"]

Array = NDArray[np.float64]
MARCH_STEPS = 10_000  # in one call: Ctrl-C has a chance between
TRIED_STARTS = 12  # vertices of a component without curves at which a first triangle is tried
SPARE_ROOM = 1.6  # times the number of vertices that areas and sizes let expect
BOX_BEYOND = 1e-3  # by how much the box of the size table is larger than the surface


class MarchedFront(NamedTuple):
    """What a march has made.

    Attributes
    ----------
    points, rows
        Scaled; (n, 3) and (m, 3).
    origin, near : (n,) int64
        The vertex of the surface that each is, or -1, and a triangle there.
    wanted : (n,)
        The largest length at each.
    edges, chain
        The edges on curves, and the curve of each.
    sides : (f, 2) int64
        The front at the beginning.
    counts : dict
    why : str
        Why it has not closed; empty if it has.
    full : bool
        Whether the budget did not suffice.
    """

    points: Array
    rows: NDArray[np.int64]
    origin: NDArray[np.int64]
    near: NDArray[np.int64]
    wanted: Array
    edges: NDArray[np.int64]
    chain: NDArray[np.int64]
    sides: NDArray[np.int64]
    counts: dict[str, int]
    why: str
    full: bool


def marched(
    support: Support, size: SizeField, nodes: SpaceNodes, tried: tuple[float, float], budget: int, bar: Any
) -> MarchedFront:
    """March over the surface.

    ``nodes`` is the table of sizes, and ``tried`` has the share of them that is wanted and the angle by which
    the surface may turn within a length.
    """
    share, turn = tried
    xyz, own = support.points * support.factor, support.held.rows
    part = parts_of(own, len(xyz))
    cap = caps_of(support, part, turn)
    choices, levels = _sizes(support, size, nodes, share, cap)
    curves = cut_curves(support, size, share, cap)
    room = min(_expected(support, size, share, cap) + 2 * len(curves.points) + 64, budget + 8)
    while True:
        run, sides, why = _begun(support, curves, part, choices._replace(most=room), levels)
        later, march, shown = np.empty(len(run.front.stamp), dtype=np.int64), np.zeros(3, dtype=np.int64), 0
        status = FRONT_PAUSED
        while status == FRONT_PAUSED:
            status = advance(run, later, march, MARCH_STEPS)
            made = int(run.front.state[FRONT_TRIANGLES])
            bar.update(made - shown)
            shown = made
        if status != FRONT_FULL or room > budget:
            break
        room = min(2 * room, budget + 8)
    if status == FRONT_FULL:
        why = "the budget was used up"
    elif status == FRONT_STUCK:
        why = "it got stuck"
    return _taken(run, curves, sides, support, why, status == FRONT_FULL)


def surface_sizes(support: Support, size: SizeField) -> SpaceNodes:
    """The table of a field over the surface: large where the field jumps, so all attempts share it."""
    low, high = support.points.min(axis=0), support.points.max(axis=0)
    if size.constant is not None:
        return SpaceNodes(np.array([-1], dtype=np.int32), np.ones((1, 8)), np.concatenate([low, high]))
    width = float((high - low).max())
    box = np.stack([low - BOX_BEYOND * width, low + (1.0 + BOX_BEYOND) * width])
    marks = size.landmarks if size.landmarks.shape[1:] == (3,) else np.empty((0, 3))
    marks = marks[((marks >= box[0]) & (marks <= box[1])).all(axis=1)]
    return space_nodes(size, box, support.factor, marks)


def _sizes(
    support: Support, size: SizeField, nodes: SpaceNodes, share: float, cap: Array
) -> tuple[FrontChoices, tuple[int, int]]:
    """The record of sizes for kernels, and the lowest and highest octave of wanted lengths."""
    if size.constant is not None:
        constant = size.constant * support.factor * share
        lengths = np.array([constant])
    else:
        constant, nodes = 0.0, nodes._replace(values=nodes.values * share)
        lengths = nodes.values
    least = min(float(lengths.min()), float(cap.min()))
    levels = octave_of(least) - 1, octave_of(float(lengths.max())) + 1
    return FrontChoices(nodes, constant, cap, 0), levels


def _expected(support: Support, size: SizeField, share: float, cap: Array) -> int:
    """About how many vertices there will be."""
    x = support.held.corners
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    area = np.sqrt(normal[:, 0] ** 2 + normal[:, 1] ** 2 + normal[:, 2] ** 2) / 2
    asked = np.atleast_1d(size(x.mean(axis=1) / support.factor)) * support.factor * share
    wanted = np.minimum(np.broadcast_to(asked, (len(x),)), cap[support.held.rows].min(axis=1))
    return int(min(SPARE_ROOM * float((area / wanted**2).sum()) * 1.1547, 2.0**40))


def _begun(
    support: Support,
    curves: CutCurves,
    part: NDArray[np.int64],
    choices: FrontChoices,
    levels: tuple[int, int],
) -> tuple[FrontRun, NDArray[np.int64], str]:
    """A front with all curves in it, and with a first triangle on each component without curves."""
    xyz, own = support.points * support.factor, support.held.rows
    room = max(choices.most, len(curves.points) + 64)
    front = surface_front_arrays(room, levels, support.held.normals)
    run = front_run(front, nearby_arrays(room), support.held, choices._replace(most=room))
    good = np.flatnonzero((support.normals != 0.0).any(axis=1))
    at = np.full(len(xyz), -1, dtype=np.int64)
    at[own[good[::-1]].ravel()] = np.repeat(good[::-1], 3)
    rows, normals, seats, _ = sides_of_curves(support, curves)
    near = at[np.maximum(curves.origin, 0)]
    home = np.where(curves.origin >= 0, part[np.maximum(curves.origin, 0)], -1)
    near[rows.ravel()] = np.repeat(seats, 2)
    home[curves.rows.ravel()] = np.repeat(part[support.features[curves.feature, 0]], 2)
    loose = np.setdiff1d(np.arange(len(curves.points)), curves.rows.ravel())
    lengths = np.empty(len(curves.points))
    wanted_lengths(run, curves.points, near, lengths)
    for i in range(len(curves.points)):
        enter_front_vertex(front, curves.points[i], lengths[i], near[i], home[i])
    open_curves(run, rows, normals, seats)
    for v in loose.tolist():
        front.loose[v] = 1
        in_grid(front, v)
    begun = home[curves.rows.ravel()]
    for p in np.setdiff1d(part[own[good].ravel()], begun).tolist():
        starts = loose[home[loose] == p].tolist()
        starts += [-1 - int(v) for v in np.flatnonzero((part == p) & (at >= 0))[:TRIED_STARTS]]
        if not any(_started(run, support, at, v, p) for v in starts):
            return run, rows, "no first triangle was found on a component"
    return run, rows, ""


def _started(run: FrontRun, support: Support, at: NDArray[np.int64], v: int, p: int) -> bool:
    """Make a first triangle, at a vertex of the front, or at the vertex -1 - v of the surface."""
    if v < 0:
        x = support.points[-1 - v] * support.factor
        v = int(enter_front_vertex(run.front, x, float(run.choices.cap[-1 - v]), at[-1 - v], p))
    return bool(first_triangle(run, v))


def _taken(
    run: FrontRun, curves: CutCurves, sides: NDArray[np.int64], support: Support, why: str, full: bool
) -> MarchedFront:
    front = run.front
    rows = front.triangles[: int(front.state[FRONT_TRIANGLES])]
    used = np.unique(rows)
    number = np.full(int(front.state[FRONT_VERTICES]), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    origin = np.full(len(number), -1, dtype=np.int64)
    origin[: len(curves.origin)] = curves.origin
    chain = support.chain[curves.feature]
    if not why and ((number[curves.rows] < 0).any() or not np.isin(support.corners, origin[used]).all()):
        why = "vertices that must be kept were passed over"
    counts = {
        "candidate": int(run.counts[BY_CANDIDATE]),
        "point": int(run.counts[BY_POINT]),
        "search": int(run.counts[BY_SEARCH]),
        "again": int(run.counts[LATER_AGAIN]),
    }
    near = front.near[used]
    wanted = run.choices.cap[support.held.rows[near]].min(axis=1)
    return MarchedFront(
        front.xyz[used], number[rows], origin[used], near, wanted, number[curves.rows], chain,
        number[sides], counts, why, full,
    )  # fmt: skip
