"""One run of `advancing_layers`: fronts that advance, the rest that is filled, and fronts that step back."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import IncompleteWarning, InputError, UnstructError
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ...sizing.stretching import Layers
from .envelope import freed, short_fans
from .filling import Remainder, remainder
from .heights import fronts_of
from .matched import matched_size
from .rays import rays_of
from .scene import Scene, slid_pieces
from .spacing import spaced_walls
from .stops import BY_SHAPE, Stops, stops_of
from .strips import cells_of, numbered, positive
from .union import Union, extreme_angle, union_of

__all__ = ["LayersRun"]

POOR_ANGLE = 15.0  # degrees: where the rest has a smaller angle, the fronts beside it step back
BAD_ANGLE = 10.0  # ... and only below this one they may lose their last layer
MOST_REPEATS = 6


class LayersRun:
    """The state of one run.

    Parameters
    ----------
    domain, size, layers
        As for `advancing_layers`.
    wall, wake : (p,) bool
        Which pieces are walls (wakes included), and which are wakes.
    spring : bool
        Whether springs recognize opposing fronts.
    """

    def __init__(
        self, domain: Domain, size: Any, layers: Layers,
        wall: NDArray[np.bool_], wake: NDArray[np.bool_], spring: bool,
    ):  # fmt: skip
        self.domain, self.layers, self.spring = domain, layers, spring
        self.complex, walls, self.field = spaced_walls(domain, size, wall, wake)
        c = self.complex
        if not len(walls.ends):
            raise InputError("walls name no piece that bounds the domain or lies inside: name others")
        ends, piece = c.ends[: c.segments].astype(np.int64), c.piece[: c.segments].astype(np.int64)
        span = c.span[: c.segments].copy()
        rays = rays_of(domain, walls, ends, piece)
        fronts = fronts_of(domain, walls, rays, layers, (ends, piece, span))
        loose, slides = domain.loose.astype(np.int64), slid_pieces(rays, piece)
        self.scene = Scene(domain, walls, rays, fronts, ends, piece, span, wall[piece], loose, slides)
        self.rest: Remainder
        self.filled: DomainMesh
        self.rounds = self.repeats = 0

    # ------------------------------------------------------------------ fronts

    def advance(self) -> None:
        """Let the fronts advance; where fans end too early, once more with one ray in place of each."""
        scene = self.scene
        points = scene.walls.points
        piece_at = np.full(len(points), -1, dtype=np.int64)
        piece_at[scene.ends[~scene.wall]] = scene.piece[~scene.wall, None]
        others = flagged(len(points), scene.ends[~scene.wall])
        others[scene.walls.ends] = False
        every = np.concatenate([np.flatnonzero(others), scene.loose])
        single = np.zeros(len(points), dtype=bool)
        while True:
            targets = points[every], piece_at[every]
            stops = stops_of(scene.rays, scene.fronts, self.field, targets, self.spring, scene.slides)
            self.stops, self.numbers, rounds = freed(scene, stops)
            self.rounds += rounds
            short = short_fans(scene, self.stops.level)
            if not len(short):
                break
            single[short] = True
            rays = rays_of(scene.domain, scene.walls, scene.ends, scene.piece, single)
            subsegments = scene.ends, scene.piece, scene.span
            fronts = fronts_of(scene.domain, scene.walls, rays, self.layers, subsegments)
            scene = scene._replace(rays=rays, fronts=fronts, slides=slid_pieces(rays, scene.piece))
        self.scene = scene

    # ------------------------------------------------------------------ the rest

    def _leave(self) -> Remainder:
        """A domain of the rest; where it is none, fronts step back."""
        scene = self.scene
        while True:
            try:
                return remainder(scene, self.stops.level, self.numbers)
            except UnstructError:  # the envelope touches a curve between its chords
                if not self.stops.level.any():
                    raise
                lower = Stops(np.maximum(self.stops.level - 1, 0), self.stops.reason)
                self.stops = positive(scene.walls.points, scene.rays, scene.fronts, lower)
                self.numbers = numbered(scene.walls.points, scene.rays, scene.fronts, self.stops.level)

    def fill(self, method: Callable[..., DomainMesh], options: Mapping[str, Any]) -> None:
        """Mesh the rest; where its angles are poor, let the fronts beside them step back and repeat."""
        best: tuple[float, Any] = (-1.0, None)
        for repeat in range(MOST_REPEATS + 1):
            self.rest = self._leave()
            wanted: Any = self.field
            if len(self.rest.top):
                wanted = matched_size(self.field, self.numbers.points, self.rest.top)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", IncompleteWarning)
                self.filled = method(self.rest.domain, wanted, **options)
            if not isinstance(self.filled, DomainMesh):
                what = type(self.filled).__name__
                raise InputError(f"fill must return a mesh of the domain, a DomainMesh, not {what}")
            angle = extreme_angle(self.filled, True)
            least = 180.0 if angle is None else angle
            if least > best[0]:
                best = least, (self.stops, self.numbers, self.rest, self.filled)
            enough = POOR_ANGLE if repeat < MOST_REPEATS - 2 else BAD_ANGLE
            if least >= enough or repeat == MOST_REPEATS or not self._step_back(repeat):
                break
            self.repeats += 1
        self.least, (self.stops, self.numbers, self.rest, self.filled) = best

    def _step_back(self, repeat: int) -> bool:
        """Lower the rays beside poor cells of the rest; False if there are none."""
        filled, rest, scene = self.filled, self.rest, self.scene
        poor = filled.quality("min_angle") < POOR_ANGLE
        corners = np.unique(filled.simplices[poor])
        last = repeat >= MOST_REPEATS - 2
        for _ in range(0 if last else min(repeat, 2)):  # and those a little farther away
            beside = np.isin(filled.simplices, corners).any(axis=1)
            corners = np.unique(filled.simplices[beside])
        origin = np.asarray(filled.origin)[corners]
        near = rest.vertex[origin[origin >= 0]]
        level = self.stops.level
        tip = self.numbers.at(np.arange(len(level)), level)
        rows = np.flatnonzero(np.isin(tip, near) & (level > 0))
        if not len(rows):
            return False
        lower, why = level.copy(), self.stops.reason.copy()
        lower[rows] = np.maximum(lower[rows] - 1 - repeat, 0 if last else 1)
        why[rows] = BY_SHAPE
        self.stops, self.numbers, rounds = freed(scene, Stops(lower, why))
        self.rounds += rounds
        return True

    def union(self, triangles: bool) -> Union:
        """Layers and rest as the arrays of one mesh."""
        cells = cells_of(self.scene.rays, self.stops.level, self.numbers)
        return union_of(
            self.scene, self.complex, self.stops.level, self.numbers, cells, self.rest, self.filled, triangles
        )
