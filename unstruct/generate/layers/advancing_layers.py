"""Advancing layers: thin cells along walls, layer by layer, and any method of a size for the rest (12.3.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError, UnstructError
from ...connect.planar.complex import PlanarComplex
from ...connect.planar.extraction import named_sets
from ...domain.domain import Domain, as_domain
from ...domain.plane.by_region import size_by_region
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.field import SizeField, as_size
from ...sizing.stretching import Layers
from ..boundary.pairs import paired
from ..rebay.voronoi_segment import voronoi_segment
from ..refinement.refine import refine
from .envelope import freed, short_fans
from .filling import Remainder, matched_size, remainder
from .heights import fronts_of
from .rays import rays_of
from .scene import Scene
from .spacing import spaced_walls
from .stops import REASONS, Stops, stops_of
from .strips import Cells, cells_of, numbered, positive, tops
from .union import steps_of, union_of
from .walls import wall_pieces

__all__ = ["FILLS", "advancing_layers"]

# The methods for the rest, by name: functions of a domain and a size.
FILLS: dict[str, Callable[..., DomainMesh]] = {"voronoi_segment": voronoi_segment, "refine": refine}


def advancing_layers(
    domain: Domain,
    size: Any,
    *,
    layers: Layers,
    walls: Any = None,
    wakes: Any = (),
    cells: str = "triangle",
    stop: str = "nearest",
    fill: str | Callable[..., DomainMesh] = "voronoi_segment",
    progress: bool = False,
    **options: Any,
) -> DomainMesh:
    """Mesh."""
    if not isinstance(layers, Layers):
        raise InputError(f"layers must be Layers(first=, growth=, ...), not {type(layers).__name__}")
    method = FILLS.get(fill) if isinstance(fill, str) else fill
    domain = as_domain(domain)
    scene, c, field = _scene(domain, size, layers, walls, wakes)
    stops, scene, rounds = _advanced(scene, field, layers, stop == "spring")
    while True:
        numbers = numbered(scene.walls.points, scene.rays, scene.fronts, stops.level)
        try:
            rest = remainder(scene, stops.level, numbers)
            break
        except UnstructError:
            if not stops.level.any():
                raise
            stops = positive(scene.walls.points, scene.rays, scene.fronts,
                             Stops(np.maximum(stops.level - 1, 0), stops.reason))
    _, top = tops(scene.rays, stops.level, numbers)
    made = cells_of(scene.rays, stops.level, numbers)
    wanted = matched_size(field, numbers.points, top) if len(top) else field
    filled = method(rest.domain, wanted, **options)
    union = union_of(scene, c, stops.level, numbers, made, rest, filled, cells == "triangle")
    segments = union.segments.astype(np.int32)
    facets = len(domain.facets)
    markers = named_sets(segments, union.piece.astype(np.int32), int((union.piece < facets).sum()), facets, domain.markers)
    markers["region"] = union.region.astype(np.int32)
    steps = steps_of(scene, union, level=stops.level, reason=np.array(REASONS)[stops.reason])
    return DomainMesh(
        union.points, None, cells=union.cells, origin=union.origin, markers=markers,
        regions=c.regions, segments=segments, piece=union.piece, span=union.span, steps=steps,
        counts={"rounds": rounds}
    )


def _advanced(scene: Scene, field: SizeField, layers: Layers, spring: bool) -> tuple[Stops, Scene, int]:
    """Let the fronts advance; where fans end too early, once more with one ray in place of each."""
    points = scene.walls.points
    piece_at = np.full(len(points), -1, dtype=np.int64)
    piece_at[scene.ends[~scene.wall]] = scene.piece[~scene.wall, None]
    every = np.concatenate(
        [np.setdiff1d(scene.ends[~scene.wall].ravel(), scene.walls.ends.ravel()), scene.loose]
    )
    targets = points[every], piece_at[every]
    single = np.zeros(len(points), dtype=bool)
    total = 0
    while True:
        stops = stops_of(scene.rays, scene.fronts, field, targets, spring, scene.slides())
        stops, rounds = freed(scene, stops)
        total += rounds
        short = short_fans(scene, stops.level)
        if not len(short):
            return stops, scene, total
        single[short] = True
        subsegments = scene.ends, scene.piece, scene.span
        rays = rays_of(scene.domain, scene.walls, scene.ends, scene.piece, single)
        scene = scene._replace(
            rays=rays, fronts=fronts_of(scene.domain, scene.walls, rays, layers, subsegments)
        )


def _scene(
    domain: Domain, size: Any, layers: Layers, walls: Any, wakes: Any
) -> tuple[Scene, PlanarComplex, SizeField]:
    wall = np.zeros(len(domain.pieces), dtype=bool)
    wake = wall.copy()
    wall[wall_pieces(domain, walls, "walls")] = True
    wake[wall_pieces(domain, wakes, "wakes")] = True
    sampled, c, found, _ = spaced_walls(domain, size, wall | wake, wake)
    field = as_size(size_by_region(c, size, domain.regions))
    ends = c.ends[: c.segments].astype(np.int64)
    piece, span = c.piece[: c.segments].astype(np.int64), c.span[: c.segments].copy()
    rays = rays_of(domain, found, ends, piece)
    fronts = fronts_of(domain, found, rays, layers, (ends, piece, span))
    return Scene(domain, found, rays, fronts, ends, piece, span, (wall | wake)[piece], domain.loose.astype(np.int64)), c, field
