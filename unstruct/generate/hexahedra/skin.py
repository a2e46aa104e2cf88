"""The faces of cubes at the surface of a body, and the rest of the surface around them. See the book, 4c."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...domain.domain import Domain
from ...geometry.segment_pairs import vertices_on_segments
from ...mesh.cells import incident_facets
from ...mesh.grouping import group_rows
from ...predicates.batch import power_of_two
from ..bodies.covering import Cover
from .pattern import Cubes
from .planes import Planes, pieces_at

__all__ = ["NO_SKIN", "Skin", "cover_of", "places_of_vertices", "skin_of"]

Numbers = NDArray[np.int64]


class Skin(NamedTuple):
    """Faces of cells on pieces of a body.

    Attributes
    ----------
    faces : (f, 4) int32
        Vertices of the cubes, outward at facets; triangles end with -1.
    piece : (f,) int64
    """

    faces: NDArray[np.int32]
    piece: Numbers


NO_SKIN = Skin(np.empty((0, 4), dtype=np.int32), np.empty(0, dtype=np.int64))


def skin_of(cubes: Cubes, domain: Domain, planes: Planes) -> Skin:
    """The faces of cells that lie on pieces in planes: at facets those of one cell, at walls of two."""
    blocks = {"hexahedron": cubes.hexahedra, "pyramid": cubes.pyramids, "tetra": cubes.tetrahedra}
    cells = {name: rows for name, rows in blocks.items() if len(rows)}
    rows, _, group = incident_facets(cells)
    if rows.shape[1] == 3:
        rows = np.column_stack([rows, np.full(len(rows), -1)])
    first = np.unique(group, return_index=True)[1]
    count = np.bincount(group)[group[first]]
    rows = rows[first]
    ends = np.column_stack([cubes.outer, np.full(len(cubes.outer), -1)])
    both, _ = group_rows(np.sort(np.concatenate([ends, rows]), axis=1))
    left = ~np.isin(both[len(ends) :], both[: len(ends)])
    rows, count = rows[left], count[left]
    piece = pieces_at(domain, planes, cubes.points, rows)
    on = (piece >= 0) & ((count == 1) == (piece < len(domain.facets)))
    return Skin(rows[on].astype(np.int32), piece[on])


def places_of_vertices(domain: Domain, points: NDArray[np.float64]) -> Numbers:
    """For each of some points that of the domain in the same place, or -1."""
    every = np.concatenate([domain.points, points]) + 0.0  # zero has one sign
    _, first, number = np.unique(every, axis=0, return_index=True, return_inverse=True)
    found = first[number.ravel()[len(domain.points) :]]
    return np.where(found < len(domain.points), found, -1)


def cover_of(domain: Domain, planes: Planes, cubes: Cubes, skin: Skin) -> tuple[Cover, Numbers]:
    """What the cubes cover of facets, and the numbers of their vertices at their ends: -1 for others.

    Numbers are those of points of the domain, and then of the points of the cover.
    """
    used = np.unique(np.concatenate([skin.faces[skin.faces >= 0], cubes.outer.ravel()]))
    place = np.full(len(cubes.points), -1, dtype=np.int64)
    place[used] = places_of_vertices(domain, cubes.points[used])
    new = used[place[used] < 0]
    place[new] = len(domain.points) + np.arange(len(new))
    points = cubes.points[new]
    edges, face = _edges_of(skin.faces)
    edges = place[edges]
    key = np.column_stack([np.sort(edges, axis=1), skin.piece[face]])
    group, _ = group_rows(key)
    outline = np.bincount(group, minlength=1)[group] == 1
    around = cubes.outer[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    kept = np.unique(np.sort(np.concatenate([edges, place[around]]), axis=1), axis=0)
    side, vertex = _on_sides(domain, planes, points, place[used])
    return Cover(points, edges[outline], skin.piece[face[outline]], side, vertex, kept), place


def _edges_of(faces: NDArray[np.int32]) -> tuple[Numbers, Numbers]:
    """The edges of triangles and quadrilaterals, and the face of each."""
    four = faces[:, 3] >= 0
    edges, owner = [], []
    for which, width in ((four, 4), (~four, 3)):
        rows = np.flatnonzero(which)
        ring = faces[rows][:, :width].astype(np.int64)
        edges.append(np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2))
        owner.append(np.repeat(rows, width))
    return np.concatenate(edges), np.concatenate(owner)


def _on_sides(
    domain: Domain, planes: Planes, more: NDArray[np.float64], vertices: Numbers
) -> tuple[Numbers, Numbers]:
    """Sides of facets in planes and the vertices on them, in order along each; exact."""
    points = np.concatenate([domain.points, more])
    points = points * power_of_two(points)
    ends, owner = domain.pieces.sides
    found = [np.empty((0, 3), dtype=np.int64)]
    for axis, at, pieces in planes.groups():
        own = np.unique(np.sort(ends[np.isin(owner, pieces)].astype(np.int64), axis=1), axis=0)
        flat = np.ascontiguousarray(points[:, [(axis + 1) % 3, (axis + 2) % 3]])
        here = vertices[np.concatenate([domain.points, more])[vertices, axis] == at]
        v, k = vertices_on_segments(flat, here, own).T
        found.append(np.column_stack([own[k], v]))
    rows = np.unique(np.concatenate(found), axis=0)
    along = points[rows[:, 1]] - points[rows[:, 0]]
    longest = np.abs(along).argmax(axis=1)
    at_row = np.arange(len(rows))
    away = np.abs(points[rows[:, 2], longest] - points[rows[:, 0], longest])
    order = np.lexsort((away[at_row], rows[:, 1], rows[:, 0]))
    return rows[order, :2], rows[order, 2]
