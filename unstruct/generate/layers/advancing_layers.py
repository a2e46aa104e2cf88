"""Advancing layers: thin cells along walls, layer by layer, and any method of a size beyond (12.3.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import as_count, as_flags, as_mapping
from ...base.errors import InputError
from ...connect.planar.extraction import named_sets
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.stretching import Layers
from ..boundary.pairs import paired
from ..front.advancing_front import advancing_front
from ..rebay.voronoi_segment import voronoi_segment
from ..refinement.refine import refine
from .rays import FAN_RAY, SLIDING_RAY, TAPER_RAY
from .run import LayersRun
from .stops import BY_END, STOP_REASONS
from .union import extreme_angle
from .walls import wall_pieces

__all__ = ["FILLS", "advancing_layers"]

# The methods for the rest, by name: functions of a domain and a size.
FILLS: dict[str, Callable[..., DomainMesh]] = {
    "advancing_front": advancing_front,
    "voronoi_segment": voronoi_segment,
    "refine": refine,
}
DEFAULT_FILL = "advancing_front"
LARGEST_SCALE = 2.0**300  # products of lengths, and of their inverses, are doubles
LAYER_CELLS, STOP_RULES = ("triangle", "quad"), ("nearest", "spring")


def advancing_layers(
    domain: Domain,
    size: Any,
    *,
    layers: Layers,
    walls: Any = None,
    wakes: Any = (),
    cells: str = "triangle",
    stop: str = "nearest",
    fill: str | Callable[..., DomainMesh] = DEFAULT_FILL,
    fill_options: Mapping[str, Any] | None = None,
    budget: int | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Mesh a planar domain with layers of thin cells along walls.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), SizeField, or dict of region name to one of these
        The wanted edge length, along walls and in the rest. In gaps between walls, and beside short pieces,
        edges along walls are shorter.
    layers : Layers
        The heights of the layers: numbers, or functions of the place on the wall.
    walls : str, int, or list of these, optional
        Names of markers, or pieces, along which there are layers; by default all facets. An inner piece has
        layers on both sides.
    wakes : str, int, or list of these
        Inner pieces, such as a line that leaves a trailing edge. They have layers on both sides, too, which
        become fewer towards an end that lies free, where a wall would be surrounded by a fan.
    cells : "triangle" or "quad"
        Whether quadrilaterals in the layers are divided.
    stop : "nearest" or "spring"
        How an opposing front is recognized; see the notes.
    fill : str or callable
        The method for the rest: "advancing_front", "voronoi_segment", "refine", or a function of a domain and
        a size.
    fill_options : dict, optional
        More arguments of this method.
    budget : int, optional
        The largest number of points that the method for the rest may insert.
    progress : bool
        Show the bar of that method.

    Returns
    -------
    DomainMesh
        Triangles, or ``mesh.cells`` with "triangle" and "quad". ``steps`` has one row for each ray, which
        starts at a vertex of a wall (several at a sharp corner): "vertex" (-1 if nothing is left of it in the
        mesh), "place" (r, 2), "level" (how many layers), "height" (their total), and "reason", why there are
        no more: "count" (there are as many as were asked for), "match" (the next step would be as long as the
        spacing of the front, or the wanted size), "near" (an opposing front), "step" (a neighbor has
        stopped; levels of neighbors differ by at most 1), "exactness" (a cell would not be positive, or the
        front would meet something), "shape" (cells of the rest would be poor), "end" (the wall ends, or its
        corner is too sharp). "cell_layer" has for each cell its layer from 1 on, 0 in the rest; "envelope"
        (e, 2) the edges between layers and rest.
        ``counts``: "rays", "fan rays", "sliding rays", "refused" (rays without a layer, apart from ends),
        "stopped: ..." for each reason, "layer cells", "rest cells", "rounds" of stepping back, "repeats".
        ``figures``: "minimum angle of the rest", "largest angle".
        ``unrefined`` and ``reasons`` are those of the method for the rest.

    Raises
    ------
    InputError
        For layers that are none, unknown names of pieces or methods, walls outside, wakes that are facets;
        and as the method for the rest does.

    Notes
    -----
    *Rays* start at the vertices of walls in the mean direction of the normals, smoothed as long as both sides
    stay well visible; at corners of bodies sharper than 130 degrees a fan of rays starts, one in 20 degrees.
    A wall may end at another piece. If the angle there is between 50 and 130 degrees, the last ray follows
    that piece (on the true curve), otherwise the layers become fewer towards it. *Cells* are quadrilaterals
    up to the lower level of two rays, and one triangle where levels differ. *Opposing fronts*: "nearest"
    stops both where a point of the other is within two steps and one spacing. "spring" imagines springs of
    the length of the front edge from its ends to candidates, and stops where an existing point takes less
    force than the new ones, or stretches neither spring.

    *Validity* is exact: all cells are positive, quadrilaterals convex, and the envelope meets neither itself
    nor the rest; so nothing overlaps. Where this fails, the fronts step back; without any layer the rest is
    the domain itself, so the method ends. Edges of the envelope are not divided by the method for the rest,
    whose size is min(size, length of the envelope's edges + 0.2 distance). It is finished more quickly than
    by that method alone, as the least angles of such a size are not worth the time. Where its cells still
    become poor, the fronts beside them step back, and the rest is meshed again, at most some times.

    O(r k log(r k)) for r rays of k layers, in practice, besides the method for the rest. Sources: S.
    Pirzadeh, AIAA Journal 32 (1994) 1735-1737 and 34 (1996) 43-49. Book: 3.3.
    """
    as_flags(progress=progress)
    if not isinstance(layers, Layers):
        raise InputError(f"layers must be Layers(first=..., growth=...), not {type(layers).__name__}")
    for name, value, known in (("cells", cells, LAYER_CELLS), ("stop", stop, STOP_RULES)):
        if not isinstance(value, str) or value not in known:
            raise InputError(f"{name} must be {known[0]!r} or {known[1]!r}, not {value!r}")
    method = FILLS.get(fill) if isinstance(fill, str) else fill
    if method is None or not callable(method):
        names = ", ".join(map(repr, FILLS))
        raise InputError(f"fill must be one of {names}, or a function of a domain and a size, not {fill!r}")
    options = dict(as_mapping({} if fill_options is None else fill_options, "fill_options"))
    if method in FILLS.values():
        unknown = [key for key in options if key not in signature(method).parameters]
        if unknown:
            raise InputError(f"fill_options has {unknown[0]!r}, which {method.__name__} does not know")
    if budget is not None:
        options["budget"] = as_count(budget, "budget")
    if progress:
        options["progress"] = True
    domain = as_domain(domain)
    farthest = float(np.abs(domain.points).max(initial=0.0))
    if not 1 / LARGEST_SCALE <= farthest <= LARGEST_SCALE:
        raise InputError(
            f"layers are made of coordinates whose largest is between {1 / LARGEST_SCALE:.0e} and "
            f"{LARGEST_SCALE:.0e}, but here it is {farthest}: scale the domain, the size and the layers"
        )
    run = LayersRun(domain, size, layers, *_pieces(domain, walls, wakes), stop == "spring")
    run.advance()
    run.fill(method, options)
    return noticed(paired(domain, _mesh(run, cells == "triangle")))


def _pieces(domain: Domain, walls: Any, wakes: Any) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which pieces are walls (wakes included), and which are wakes."""
    wall, wake = np.zeros((2, len(domain.pieces)), dtype=bool)
    wall[wall_pieces(domain, walls, "walls")] = True
    wake[wall_pieces(domain, wakes, "wakes")] = True
    facets = np.flatnonzero(wake[: len(domain.facets)])
    if len(facets):
        raise InputError(
            f"wakes names {domain.name(int(facets[0]))}: a wake is an inner piece; name it in walls"
        )
    return wall | wake, wake


def _mesh(run: LayersRun, triangles: bool) -> DomainMesh:
    """The whole mesh with its account."""
    domain, scene, level = run.domain, run.scene, run.stops.level
    union, numbers = run.union(triangles), run.numbers
    segments, piece = union.segments.astype(np.int32), union.piece.astype(np.int32)
    facets = len(domain.facets)
    markers = named_sets(segments, piece, int((piece < facets).sum()), facets, domain.markers)
    markers["region"] = union.region.astype(np.int32)
    rays, reason = scene.rays, run.stops.reason
    row = np.arange(len(level))
    steps = {
        "vertex": union.place[rays.base].astype(np.int32),
        "place": numbers.points[rays.base],
        "level": level,
        "height": np.hypot(*(scene.fronts.places[row, level] - scene.fronts.places[row, 0]).T),
        "reason": np.array(STOP_REASONS)[reason],
        "cell_layer": union.layer,
        "envelope": union.place[run.rest.top],
    }
    layered, kinds = int((union.layer > 0).sum()), np.bincount(rays.kind, minlength=TAPER_RAY + 1).tolist()
    counts = {
        "rays": len(level),
        "fan rays": kinds[FAN_RAY],
        "sliding rays": kinds[SLIDING_RAY],
        "refused": int(((level == 0) & (reason != BY_END)).sum()),
        "layer cells": layered,
        "rest cells": len(union.layer) - layered,
        "rounds": run.rounds,
        "repeats": run.repeats,
    }
    stopped = np.bincount(reason, minlength=len(STOP_REASONS)).tolist()
    counts |= {f"stopped: {name}": stopped[i] for i, name in enumerate(STOP_REASONS)}
    account: dict[str, Any] = {
        "regions": run.complex.regions, "steps": steps, "counts": counts,
        "unrefined": union.fill[run.filled.unrefined], "reasons": run.filled.reasons,
    }  # fmt: skip
    if set(union.cells) == {"triangle"}:
        cells, parts = (union.cells["triangle"], None), (segments, piece, union.span)
        mesh = DomainMesh.of_triangles(union.points, union.origin, cells, markers, parts, **account)
    else:
        mesh = DomainMesh(
            union.points, None, cells=union.cells, origin=union.origin, markers=markers, segments=segments,
            piece=piece, span=union.span, **account,
        )  # fmt: skip
    mesh.figures.update(
        {"minimum angle of the rest": run.least, "largest angle": extreme_angle(mesh, False) or 0.0}
    )
    return mesh
