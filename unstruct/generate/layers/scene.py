"""All that is fixed while the numbers of layers are found: walls, rays, their places, and the boundary."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from .heights import Fronts
from .rays import SLIDING_RAY, Rays
from .strips import Numbering
from .walls import Walls

BESIDE = 0.7  # so much of a subsegment

__all__ = ["Scene", "bare", "rest_of", "slid_pieces", "slid_ranges"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Scene(NamedTuple):
    """Walls, rays and fronts, and the subsegments of the boundary that they start from.

    Attributes
    ----------
    domain : Domain
    walls, rays, fronts : Walls, Rays, Fronts
    ends : (s, 2) int64
        All subsegments, in the direction of their pieces.
    piece : (s,) int64
    span : (s, 2) float64
    wall : (s,) bool
        Which of them belong to walls.
    loose : (j,) int64
        Vertices of the domain that no piece uses.
    slides : (r,) int64
        The piece that each ray slides along, -1 for none.
    """

    domain: Domain
    walls: Walls
    rays: Rays
    fronts: Fronts
    ends: Integers
    piece: Integers
    span: Array
    wall: NDArray[np.bool_]
    loose: Integers
    slides: Integers


def slid_pieces(rays: Rays, piece: Integers) -> Integers:
    """`Scene.slides`, from the pieces of all subsegments."""
    found = np.full(len(rays.base), -1, dtype=np.int64)
    rows = np.flatnonzero(rays.kind == SLIDING_RAY)
    found[rows] = piece[rays.slide[rows]]
    return found


def bare(scene: Scene, level: Integers) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """For each subsegment whether the rest touches it, and whether layers touch it, from either side."""
    walls, rays = scene.walls, scene.rays
    side = len(walls.ends)
    none = np.maximum(level[rays.left[:side]], level[rays.right[:side]]) == 0
    rest, layer = ~scene.wall, np.zeros(len(scene.wall), dtype=bool)
    rest[walls.segment[none]] = True
    layer[walls.segment[~none]] = True
    return rest, layer


def slid_ranges(scene: Scene, level: Integers) -> dict[int, list[tuple[int, float, bool]]]:
    """Per piece along which rays have slid: the ray, the parameter of its last place, and whether from 0."""
    found: dict[int, list[tuple[int, float, bool]]] = {}
    for r in np.flatnonzero((scene.slides >= 0) & (level > 0)).tolist():
        t = scene.fronts.parameter[r]
        found.setdefault(int(scene.slides[r]), []).append((r, float(t[level[r]]), bool(t[1] < 0.5)))
    return found


def rest_of(scene: Scene, level: Integers, numbers: Numbering) -> Integers:
    """The subsegments that bound the rest beside the envelope: (k, 2) numbers of points."""
    rest, _ = bare(scene, level)
    ranges = slid_ranges(scene, level)
    if not ranges:
        return scene.ends[rest]
    rest = rest & ~flagged(len(scene.domain.pieces), list(ranges))[scene.piece]
    parts = [scene.ends[rest]]
    for piece, ends in ranges.items():
        rows = np.flatnonzero(scene.piece == piece)
        low, high = 0.0, 1.0
        first, last = int(scene.ends[rows[0], 0]), int(scene.ends[rows[-1], 1])
        for r, t, forward in ends:
            top = int(numbers.at(np.array([r]), level[[r]])[0])
            if forward:
                low, first = t, top
            else:
                high, last = t, top
        # A vertex beside the last place of a ray is left out: the rest will have others there.
        t, part = scene.span[rows[:-1], 1], BESIDE * np.diff(scene.span[rows[:-1]])[:, 0]
        inner = rows[:-1][(t > low + part * (low > 0)) & (t < high - part * (high < 1))]
        chain = np.concatenate([[first], scene.ends[inner, 1], [last]])
        parts.append(np.column_stack([chain[:-1], chain[1:]]))
    return np.concatenate(parts)
