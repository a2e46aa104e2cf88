"""Polygons in space meshed in their planes, small ones many at once.

Voronoi-segment insertion runs once for each large polygon. Small ones, in which the size hardly changes, are
laid side by side in one plane, in units of their sizes, and meshed by one run: so a body with ten thousand
facets takes no more runs than one with ten. See the book, 2.8c.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.derived import held_by
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...sizing.field import SizeField
from ...sizing.on_faces import on_plane
from ...sizing.space_metric import SpaceMetric
from ..boundary.constrained import planar_complex
from ..boundary.kept import kept_pieces
from ..rebay.run import VoronoiSegmentRun, rule_of

__all__ = ["Filler", "Laid", "filled_by_size", "frames", "lay", "meshed", "too_many"]

Numbers = NDArray[np.int64]
Array = NDArray[np.float64]
# How a domain of the plane is meshed by a size, or a metric, with so many new points, and none on pieces.
Filler = Callable[[Domain, Any, int], DomainMesh]
FEW_EDGES = 8.0  # the extent of patches that are meshed together; unit: the size
EVEN_PATCH = 1.25  # how much larger the largest size in such a patch may be than the least
SIDE_BY_SIDE = 4096  # patches that are meshed together
PATCHES_APART = FEW_EDGES * EVEN_PATCH + 2.0  # from one such patch to the next
ACCEPTED_IN_PATCH = 1.35  # as for `voronoi_segment`
ONE_EDGE = np.array([0.0, 1.0])


class Laid(NamedTuple):
    """Patches laid into the plane: x = origin + y @ frame of a patch for each of its y in ``flat``.

    Attributes
    ----------
    vertex : (v,)
        The vertices of all patches, patch by patch, as numbers of points of the body.
    owner : (v,)
        The patch of each.
    flat : (v, 2) float64
    ends : (e, 2)
        Edges, by their places in ``vertex``.
    of : (e,)
        The patch of each edge, in order.
    within : (e,) bool
        Whether it does not bound its patch.
    origin : (k, 3) float64
    frame : (k, 2, 3) float64
    """

    vertex: Numbers
    owner: Numbers
    flat: Array
    ends: Numbers
    of: Numbers
    within: NDArray[np.bool_]
    origin: Array
    frame: Array


def lay(points: Array, normal: Array, edges: Numbers, of: Numbers, within: NDArray[np.bool_]) -> Laid:
    """Lay patches into the plane.

    Parameters
    ----------
    points : (n, 3) float64
    normal : (k, 3) float64
        Of the patches.
    edges : (e, 2)
        All of their edges, patch by patch.
    of : (e,)
        The patch of each edge.
    within : (e,) bool
        Whether it does not bound its patch.
    """
    key, place = np.unique(np.repeat(of, 2) * len(points) + edges.ravel(), return_inverse=True)
    owner, vertex = np.divmod(key, len(points))
    frame = frames(normal)
    origin = points[vertex[np.searchsorted(owner, np.arange(len(normal)))]]
    flat = (frame[owner] * (points[vertex] - origin[owner])[:, None]).sum(axis=2)
    return Laid(vertex, owner, flat, place.reshape(-1, 2), of, within, origin, frame)


def frames(normal: Array) -> Array:
    """Two orthogonal unit vectors in the plane of each normal (k, 3), counterclockwise about it: (k, 2, 3).

    In a plane of constant coordinate they are unit vectors of the axes, so that nothing is rounded there.
    """
    unit = normal / np.linalg.norm(normal, axis=1)[:, None]
    rows, axis = np.arange(len(unit)), np.abs(unit).argmax(axis=1)
    first = np.zeros_like(unit)
    first[rows, (axis + 1) % 3] = 1.0
    first -= unit * unit[rows, (axis + 1) % 3][:, None]
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(unit, first)], axis=1)


def meshed(
    laid: Laid, field: SizeField | SpaceMetric, points: Array, most: int, fill: Filler
) -> tuple[Array, Numbers, Numbers]:
    """Mesh patches with exactly the given edges.

    Parameters
    ----------
    laid : Laid
    field : SizeField or SpaceMetric
        The wanted length of edges. With a metric each patch is meshed on its own.
    points : (n, 3) float64
        The points of the body.
    most : int
        The largest number of new points.
    fill : callable
        How patches are meshed.

    Returns
    -------
    points : (n + m, 3) float64
        The same, then new ones inside of patches.
    triangles : (t, 3)
        Counterclockwise about the normals.
    patch : (t,)
        The patch of each.
    """
    many = len(laid.origin)
    small, low, high = np.zeros(many, dtype=bool), np.ones(many), np.ones(many)
    if isinstance(field, SizeField):
        start = np.searchsorted(laid.owner, np.arange(many))
        h = field(points[laid.vertex])
        low, high = np.minimum.reduceat(h, start), np.maximum.reduceat(h, start)
        extent = (np.maximum.reduceat(laid.flat, start) - np.minimum.reduceat(laid.flat, start)).max(axis=1)
        small = (extent <= FEW_EDGES * low) & (high <= EVEN_PATCH * low)
    together = np.flatnonzero(small)
    groups = [np.array([k]) for k in np.flatnonzero(~small)]
    groups += [together[i : i + SIDE_BY_SIDE] for i in range(0, len(together), SIDE_BY_SIDE)]
    every, rows, patch = [points], [np.empty((0, 3), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    have = len(points)
    for group in groups:
        unit = _mean_size(low[group], high[group]) if small[group[0]] else None
        cells, owner, new = _of_group(laid, group, unit, field, (have, most, fill))
        have, most = have + len(new), most - len(new)
        every.append(new)
        rows.append(cells)
        patch.append(group[owner])
    return np.concatenate(every), np.concatenate(rows), np.concatenate(patch)


def _mean_size(low: Array, high: Array) -> Array:
    """Geometric means of sizes, whose products may be no doubles."""
    exponent = np.frexp(low)[1]
    return np.ldexp(np.sqrt(np.ldexp(low, -exponent) * np.ldexp(high, -exponent)), exponent)


def _of_group(
    laid: Laid,
    group: Numbers,
    unit: Array | None,
    field: SizeField | SpaceMetric,
    room: tuple[int, int, Filler],
) -> tuple[Numbers, Numbers, Array]:
    """Triangles of some patches, the place of each in the group, and new points.

    With units the patches are laid side by side, each in its unit; without, there is only one. ``room`` has
    the number of the first new point, how many there may be, and how patches are meshed.
    """
    first, last = (np.searchsorted(laid.owner, group, side=side) for side in ("left", "right"))
    count = last - first
    owner = np.repeat(np.arange(len(group)), count)
    ahead = np.cumsum(count) - count
    at = first[owner] + np.arange(len(owner)) - ahead[owner]
    moved = np.full(len(laid.vertex), -1)
    moved[at] = np.arange(len(at))
    begin, end = (np.searchsorted(laid.of, group, side=side) for side in ("left", "right"))
    edge = np.concatenate([np.arange(i, j) for i, j in zip(begin.tolist(), end.tolist())])
    across = math.isqrt(len(group) - 1) + 1
    scale, shift = np.ones(len(group)), np.zeros((len(group), 2))
    wanted: Any = 1.0
    if unit is not None:
        scale = 1.0 / unit
        cell = np.stack(np.divmod(np.arange(len(group)), across), axis=1)
        shift = PATCHES_APART * cell - scale[:, None] * np.minimum.reduceat(laid.flat[at], ahead)
    else:
        wanted = on_plane(field, laid.origin[group[0]], laid.frame[group[0]])
    flat = laid.flat[at] * scale[owner, None] + shift[owner]
    ends, within = moved[laid.ends[edge]], laid.within[edge]
    planar = Domain(flat, ends[~within], inner=ends[within] if within.any() else None)
    planar = held_by(planar, dict.fromkeys(range(len(planar.pieces)), ONE_EDGE), [])
    have, most, fill = room
    mesh = fill(planar, wanted, most)
    old, cells = np.asarray(mesh.origin).astype(np.int64), np.asarray(mesh.simplices)
    new, known = np.flatnonzero(old < 0), np.flatnonzero(old >= 0)
    of = np.zeros(len(old), dtype=np.int64)
    of[known] = owner[old[known]]
    if unit is not None:
        place = np.floor((mesh.points[new] + 1.0) / PATCHES_APART).astype(np.int64)
        of[new] = place[:, 0] * across + place[:, 1]
    y = (mesh.points[new] - shift[of[new]]) / scale[of[new], None]
    x = laid.origin[group[of[new]]] + (y[:, :, None] * laid.frame[group[of[new]]]).sum(axis=1)
    number = np.empty(len(old), dtype=np.int64)
    number[known], number[new] = laid.vertex[at][old[known]], have + np.arange(len(new))
    return number[cells], of[cells[:, 0]], x


def too_many(count: float, most: int) -> str:
    """What to say of a size that asks for too many points."""
    return (
        f"the size asks for about {count:.3g} points inside facets and their edges, more than the {most} of "
        "the budget: give a larger size or budget"
    )


def filled_by_size(planar: Domain, size: Any, most: int) -> DomainMesh:
    """As `voronoi_segment` without new points on pieces; what it could not reach is judged in space."""
    complex_ = planar_complex(planar, size)
    kept = kept_pieces(False, len(planar.facets), len(planar.pieces), planar.held())
    rule = rule_of(ACCEPTED_IN_PATCH, "center", "first", None, False)
    run = VoronoiSegmentRun(planar, complex_, size, None, rule, kept, False)
    with progress_bar(False, " points") as bar:
        run.insert(most, bar)
    if run.spent:
        raise InputError(too_many(most + 1, most))
    return run.result(run.finish(DEFAULT_BUDGET))
