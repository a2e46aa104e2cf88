"""Plane facets beside walls that are cut into triangles: layers end there on one polygon in their place."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...base.arrays import flagged, frozen
from ...domain.domain import Domain
from ...domain.space.flat_parts import FlatParts, flat_parts
from ...geometry.polygons import Polygons
from ...mesh.domain_mesh import DomainMesh
from ..layers.walls import wall_pieces

__all__ = ["JoinedBody", "as_pieces_of", "number_of", "with_flat_sides"]


class JoinedBody(Domain):
    """A body with joined facets; messages tell the names and numbers of the body as it was given."""

    given: Domain | None = None
    parts: FlatParts | None = None

    def name(self, piece: int) -> str:
        """The name of the first piece of the given body that is a part of a piece."""
        if self.given is None or self.parts is None:  # while it is made
            return super().name(piece)
        return self.given.name(int(self.parts.piece[piece]))


def number_of(domain: Domain, vertex: int) -> int:
    """The number of a point of a body in messages: that in the body as it was given."""
    if isinstance(domain, JoinedBody) and domain.parts is not None:
        return int(domain.parts.vertex[vertex])
    return int(vertex)


def with_flat_sides(surface: Any, walls: Any) -> tuple[Any, Any, FlatParts | None]:
    """A body in which flat parts beside walls are one polygon each, and its walls.

    Parameters
    ----------
    surface : Domain, or anything else, which is returned as it is
    walls
        Names of markers, pieces, or a list of both; None for all facets.

    Returns
    -------
    surface : Domain
    walls : the same, or pieces of the new body
    parts : FlatParts or None
        None if nothing was joined.
    """
    if not isinstance(surface, Domain) or surface.dimension != 3 or walls is None or not len(surface.facets):
        return surface, walls, None
    many = len(surface.facets)
    chosen = wall_pieces(surface, walls, "walls")
    if not len(chosen) or chosen.max() >= many:
        return surface, walls, None  # what follows refuses it
    wall = flagged(many, chosen)
    ends, owner = Polygons.of(surface.facets).sides
    key = np.sort(ends, axis=1).astype(np.int64)
    key = key[:, 0] << 32 | key[:, 1]
    beside = np.isin(key, key[wall[owner]]) & ~wall[owner]
    parts = flat_parts(surface, flagged(many, owner[beside]), ~wall)
    if parts is None:
        return surface, walls, None
    joined = JoinedBody(**parts.arguments)
    joined.given, joined.parts = surface, parts
    return joined, np.unique(parts.group[chosen]), parts


def as_pieces_of(mesh: DomainMesh, parts: FlatParts) -> None:
    """Let a mesh of a body with joined facets refer to the body as it was given: to the first of each."""
    origin = np.asarray(mesh.origin)
    mesh.origin = frozen(np.where(origin >= 0, parts.vertex[origin], -1).astype(np.int32))
    mesh.face_piece = frozen(parts.piece[np.asarray(mesh.face_piece)].astype(np.int32))
    mesh.piece = frozen(parts.piece[np.asarray(mesh.piece)].astype(np.int32))
