"""What a mesh of a surface is held against: a body's facets or a mesh of triangles, with names and features.

See the book, chapter 2.7.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..geometry.support import Support
from ..geometry.support_features import same_points, side_groups
from ..mesh.marked import marked_facets, marked_sides
from ..mesh.mesh import Mesh
from .domain import Domain
from .space.inside import outward

__all__ = ["USUAL_SHARP", "GivenSurface", "directed", "given_surface"]

NO_EDGE, NO_VERTEX = np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
USUAL_SHARP = 40.0  # degrees by which a surface turns at a crease, if nothing is said


class GivenSurface(NamedTuple):
    """A given surface and its names.

    Attributes
    ----------
    support : Support
        Its points and triangles have the numbers of those of the surface; the facets of a body face outward.
    names : dict of str to (m,) bool
        The triangles of each marker of triangles or facets.
    edges : dict of str to (k, 2) int64
        The edges of each marker of edges. Those of a marker of both are here and in ``names``.
    values : dict of str to (m,) array
        Markers that have a number for each triangle, such as "region".
    piece : (m,) int64
        The facet of a body that each triangle is of; of a mesh, its own number.
    """

    support: Support
    names: dict[str, NDArray[np.bool_]]
    edges: dict[str, NDArray[np.int64]]
    values: dict[str, np.ndarray]
    piece: NDArray[np.int64]

    def markers(self, simplices: np.ndarray, triangle: np.ndarray) -> dict[str, np.ndarray]:
        """The markers of a mesh whose cells lie on these triangles of the surface: rows, and numbers.

        Names of edges are not among them.
        """
        found: dict[str, np.ndarray] = {}
        for name, among in self.names.items():
            found[name] = simplices[among[triangle]]
        for name, values in self.values.items():
            found[name] = values[triangle]
        return found


class Named(NamedTuple):
    """The names of a surface, as of a `GivenSurface`, and the edges and vertices that must be kept."""

    names: dict[str, NDArray[np.bool_]]
    edges: dict[str, NDArray[np.int64]]
    values: dict[str, np.ndarray]
    kept: NDArray[np.int64]
    corners: NDArray[np.int64]


def given_surface(surface: Any, sharp: float | None = USUAL_SHARP) -> GivenSurface:
    """The surface that a user gave.

    Parameters
    ----------
    surface : Domain or Mesh
        A body in space, whose facets and inner facets are meant, or a mesh of triangles in space.
    sharp : float, optional
        As for `Support`. Edges between triangles with different names are features, too, and so are named
        edges; named vertices are corners.

    Raises
    ------
    InputError
        For anything else.
    """
    if isinstance(surface, Domain):
        return _of_body(surface, sharp)
    if not isinstance(surface, Mesh):
        raise InputError(
            f"a surface must be a Domain in space or a Mesh of triangles, not {type(surface).__name__}"
        )
    if surface.points.shape[1] != 3 or list(surface.cells) != ["triangle"] or surface.size == 0:
        raise InputError(f"a surface must be a mesh of triangles in space, not {surface!r}")
    return _of_mesh(surface, sharp)


def directed(given: GivenSurface) -> GivenSurface:
    """The same surface; an error if all its triangles are flat, for then it has no area and no direction."""
    if not given.support.normals.any():
        raise InputError(
            "all triangles of the surface are degenerate: their corners are equal or lie on lines; give a "
            "surface with area"
        )
    return given


def _of_body(domain: Domain, sharp: float | None) -> GivenSurface:
    if domain.dimension != 3:
        raise InputError("a surface must lie in space; the domain is in the plane: refine it instead")
    shell = domain.triangulated
    triangles, piece = shell.triangles.astype(np.int64), shell.piece.astype(np.int64)
    triangles[piece < shell.facets] = outward(shell)
    on = _among(shell.segments, triangles)  # inner segments that lie on no facet are none of its edges
    segments, owner = shell.segments[on].astype(np.int64), shell.segment_piece[on]
    parts = Named({}, {}, {}, segments, NO_VERTEX)
    for name, pieces in domain.markers.items():
        if np.isin(piece, pieces).any():
            parts.names[name] = np.isin(piece, pieces)
        if np.isin(owner, pieces).any():
            parts.edges[name] = segments[np.isin(owner, pieces)]
    return _made(domain.points, triangles, sharp, parts, piece)


def _of_mesh(mesh: Mesh, sharp: float | None) -> GivenSurface:
    triangles = np.asarray(mesh.simplices, dtype=np.int64)
    parts = Named({}, {}, {}, NO_EDGE, NO_VERTEX)
    for name, rows in mesh.markers.items():
        if rows.ndim == 1:
            parts.values[name] = rows
        elif rows.shape[1] == 3:
            parts.names[name] = marked_facets(triangles, rows, len(mesh.points))
        elif rows.shape[1] == 2:
            parts.edges[name] = rows[_among(rows, triangles)].astype(np.int64)
    rest = [rows.ravel().astype(np.int64) for rows in mesh.markers.values() if rows.shape[1:] == (1,)]
    parts = parts._replace(
        kept=np.concatenate([NO_EDGE, *parts.edges.values()]), corners=np.concatenate([NO_VERTEX, *rest])
    )
    return _made(mesh.points, triangles, sharp, parts, np.arange(len(triangles)))


def _among(edges: np.ndarray, triangles: NDArray[np.int64]) -> np.ndarray:
    """Whether each edge is a side of some triangle."""
    return marked_sides(triangles, edges, int(max(triangles.max(), edges.max(initial=0))) + 1)[1]


def _made(
    points: np.ndarray, triangles: NDArray[np.int64], sharp: float | None, parts: Named, piece: np.ndarray
) -> GivenSurface:
    code = np.zeros(len(triangles), dtype=np.int64)
    for values in (*parts.names.values(), *parts.values.values()):
        code = code * (len(triangles) + 1) + np.unique(values, return_inverse=True)[1].ravel()
        code = np.unique(code, return_inverse=True)[1].ravel()
    rows = same_points(points)[triangles]
    place, group, _ = side_groups(rows)
    differ = np.flatnonzero((group[1:] == group[:-1]) & (code[place[1:] // 3] != code[place[:-1] // 3]))
    ends = np.stack([rows, rows[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    edges = np.concatenate([parts.kept, ends[place[differ]]])
    support = Support(points, triangles, sharp=sharp, edges=edges, corners=_ends(parts))
    return GivenSurface(support, parts.names, parts.edges, parts.values, piece)


def _ends(parts: Named) -> NDArray[np.int64]:
    """Named vertices, and those at which a named curve begins, ends or branches."""
    found = [parts.corners]
    for rows in parts.edges.values():
        degree = np.bincount(rows.ravel(), minlength=1)
        found.append(np.flatnonzero((degree > 0) & (degree != 2)))
    return np.unique(np.concatenate(found))
