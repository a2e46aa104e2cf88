"""The walls of a body, or of a surface that ends in planes: read, tested, turned to the side of the layers.

A body is tested by `Domain`, exactly. A surface that is open passes the same tests as an inner piece of one;
it must be turned alike all over, and each loop of its border must lie in a plane. Layers end in planes also
where facets of a body are no walls: there the rays slide in the planes of these facets, at a corner along the
line that two planes have in common.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.errors import DomainError, InputError
from ...domain.domain import Domain, as_domain
from ...domain.space.cutting import at
from ...domain.space.surfaces import parts_of
from ...geometry.inside_shell import front_inside, side_mates, triangle_components
from ...mesh.mesh import Mesh
from ...predicates.batch import orient_rows
from ..layers.walls import wall_pieces
from .flat_sides import number_of
from .planes import planes_beside, planes_of_loops
from .records import Others, Walls
from .stars import stars_of

__all__ = ["LARGEST_COORDINATE", "WALL_SIDES", "Base", "base_of", "must_end_on_facets"]

WALL_SIDES = ("inside", "outside")
LARGEST_COORDINATE = 2.0**300  # products of three lengths are doubles


class Base(NamedTuple):
    """What layers stand on.

    Attributes
    ----------
    walls : Walls
    others : Others
    markers : dict of str to array
        Names of pieces, as of the surface.
    origin : (m,) int
        The row among the points that were given, for each of ``others.points``.
    domain : Domain or None
        The body; None for an open surface.
    """

    walls: Walls
    others: Others
    markers: Mapping[str, NDArray]
    origin: NDArray[np.int32]
    domain: Domain | None


def base_of(surface: Any, which: Any, side: str) -> Base:
    """The walls of a surface and what stands beside them.

    Parameters
    ----------
    surface : Domain or Mesh
    which
        Names of markers, pieces, or a list of both; None for all facets.
    side : "inside" or "outside"
        Of an open surface, "outside" is the side to which its normals point.
    """
    opened = None
    if isinstance(surface, Mesh):
        found = parts_of(surface, "surface")
        opened = _open_piece(found.parts) if _is_open(found.parts["facets"]) else None
        domain = Domain.surface(surface) if opened is None else opened
        _must_be_turned_alike(domain)
        origin = domain.origin if opened is None else np.asarray(found.origin)
    elif isinstance(surface, Domain):
        domain = as_domain(surface, 3)
        origin = np.arange(len(domain.points), dtype=np.int32)
    else:
        raise InputError(f"surface must be a Domain in space or a Mesh of one, not {type(surface).__name__}")
    _must_be_of_some_size(domain.points)
    shell = domain.triangulated
    many = len(domain.pieces) if opened is not None else len(domain.facets)
    if not len(shell.triangles):
        raise InputError("the surface has no facets: there is nothing that layers could stand on")
    wall = np.zeros(len(domain.pieces), dtype=bool)
    wall[np.arange(many) if which is None else wall_pieces(domain, which, "walls")] = True
    if wall[many:].any():
        raise InputError(
            f"walls names {domain.name(many + int(np.argmax(wall[many:])))}, which has no side that is "
            "outside: layers stand on facets"
        )
    bounding = shell.piece < many
    rows, piece = shell.triangles[bounding], shell.piece[bounding]
    if opened is None:
        turn = front_inside(domain.points, rows) != (side == "inside")
    else:
        turn = np.full(len(rows), side == "inside")
    rows = np.where(turn[:, None], rows[:, ::-1], rows).astype(np.int32)
    on = wall[piece]
    if not on.any():
        raise InputError("walls name no facet: there is nothing that layers could stand on")
    inner = shell.triangles[~bounding] if side == "inside" else shell.triangles[:0]
    inner_piece = shell.piece[~bounding][: len(inner)]
    return _divided(domain, rows, piece, on, inner, inner_piece, origin, opened is not None)


def _divided(
    domain: Domain,
    rows: NDArray[np.int32],
    piece: NDArray[np.int32],
    on: NDArray[np.bool_],
    inner: NDArray[np.int32],
    inner_piece: NDArray[np.int32],
    origin: NDArray[np.int32],
    is_open: bool,
) -> Base:
    """Walls and the rest, with planes; errors where they hang together in a way that layers cannot have."""
    points = domain.points
    vertex = np.unique(rows[on])
    number = np.full(len(points), -1, dtype=np.int32)
    number[vertex] = np.arange(len(vertex))
    triangles = number[rows[on]]
    _must_be_manifold(domain, rows, rows[on], piece[on], inner, inner_piece)
    stars = stars_of(triangles, len(vertex))
    single = stars.single & stars_of(rows, len(points)).single[vertex]
    if not single.all():
        v = int(vertex[int(np.argmin(single))])
        raise InputError(
            f"two parts of the surface touch at point {number_of(domain, v)}, {at(points[v])}, of which one "
            "is a wall, where no ray can be in both: give each part a point of its own, and move them apart"
        )
    others = np.concatenate([rows[~on], inner])
    if is_open:
        planes, normals = planes_of_loops(points, vertex, triangles, stars.mates)
        plane = np.full(len(others), -1, dtype=np.int32)
    else:
        planes, normals, plane = planes_beside(domain, vertex, triangles, stars.mates, rows[~on], piece[~on])
        plane = np.concatenate([plane, np.full(len(inner), -1, dtype=np.int32)])
    walls = Walls(points[vertex], triangles, vertex.astype(np.int32), piece[on], planes, normals)
    body = None if is_open else domain
    return Base(walls, Others(points, others, plane), domain.markers, origin, body)


# ---------------------------------------------------------------------- what is refused


def _is_open(polygons: Any) -> bool:
    """Whether some edge has an odd number of facets."""
    ends = np.sort(polygons.sides[0], axis=1).astype(np.int64)
    key = np.sort((ends[:, 0] << 32) | ends[:, 1])
    return len(key) % 2 == 1 or not np.array_equal(key[::2], key[1::2])


def _open_piece(parts: Mapping[str, Any]) -> Domain:
    """An open surface as an inner piece, which passes all tests of a body but that of being closed."""
    try:
        return Domain(
            parts["points"], np.empty((0, 3), dtype=np.int32), inner=parts["facets"], markers=parts["markers"]
        )
    except DomainError as error:
        text = str(error).replace("inner facet", "facet")
        text = text.replace("let resolve=True", "let Domain.surface(mesh, resolve=True)")
        raise DomainError(text, error.outline, error.faults) from None


def _must_be_of_some_size(points: NDArray[np.float64]) -> None:
    farthest = float(np.abs(points).max(initial=0.0))
    if not len(points):
        raise InputError("the surface has no facets: there is nothing that layers could stand on")
    if not 1 / LARGEST_COORDINATE <= farthest <= LARGEST_COORDINATE:
        raise InputError(
            f"layers are made of coordinates whose largest is between {1 / LARGEST_COORDINATE:.0e} and "
            f"{LARGEST_COORDINATE:.0e}, but here it is {farthest}: scale the surface and the layers"
        )


def _must_be_turned_alike(domain: Domain) -> None:
    """A mesh of a surface has a direction, other than a body."""
    shell = domain.triangulated
    against = triangle_components(shell.triangles)[1]
    if not against.any():
        return
    ends = np.concatenate([shell.triangles[:, [k, (k + 1) % 3]] for k in range(3)]).astype(np.int64)
    key = (ends[:, 0] << 32) | ends[:, 1]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    if not len(same):  # a strip with one side alone, for instance
        raise InputError("the surface has only one side: layers need two")
    i, j = (int(order[same[0] + k]) % len(shell.triangles) for k in (0, 1))
    a, b = ends[order[same[0]]].tolist()
    raise InputError(
        f"facets {shell.piece[i]} and {shell.piece[j]} are turned against each other: both run along the "
        f"edge {a}-{b} in one direction, {at(domain.points[a])}; turn one, or give Domain.surface(mesh), for "
        "which the direction does not matter"
    )


def _must_be_manifold(
    domain: Domain,
    rows: NDArray[np.int32],
    walls: NDArray[np.int32],
    piece: NDArray[np.int32],
    inner: NDArray[np.int32],
    inner_piece: NDArray[np.int32],
) -> None:
    """At most two triangles at each edge of a wall."""
    rows = np.concatenate([rows, inner])
    ends = np.sort(rows[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    key = np.sort((ends[:, 0] << 32) | ends[:, 1])
    many = key[2:][key[2:] == key[:-2]]
    if not len(many):
        return
    own = np.sort(walls[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    bad = np.flatnonzero(np.isin((own[:, 0] << 32) | own[:, 1], many))
    if len(bad):
        a, b = own[bad[0]].tolist()
        edge = f"the edge {number_of(domain, a)}-{number_of(domain, b)}"
        where = f"{edge} of {domain.name(int(piece[bad[0] // 3]))}, {at(domain.points[a])}"
        ends = np.flatnonzero((inner == a).any(axis=1) & (inner == b).any(axis=1))
        if len(ends):
            raise InputError(
                f"{domain.name(int(inner_piece[ends[0]]))} ends at {where}, which is a wall: layers would "
                "cut it; leave the facets there out of walls, or let it end before them"
            )
        raise InputError(
            f"more than two facets meet at {where}: there layers would overlap; leave a gap between the "
            "parts, or leave these facets out of walls"
        )


def must_end_on_facets(base: Base) -> None:
    """Facets beside walls must be on that side of them on which the layers are: there these end on them.

    At an edge where the body is concave they would end within the body, in the plane of the facet beside,
    but not on it. Facets in the plane of the wall are none of these: no ray has a height there.
    """
    walls, others = base.walls, base.others
    own = walls.vertex[walls.triangles]
    mates = side_mates(np.concatenate([own, others.triangles]).astype(np.int32))[: 3 * len(own)]
    side = np.flatnonzero(mates >= 3 * len(own))
    other = mates[side] - 3 * len(own)
    corner = others.triangles[other // 3, other % 3]
    signs = orient_rows(others.points, np.column_stack([own[side // 3], corner]))
    away = np.flatnonzero(signs < 0)
    if len(away):
        row, k = divmod(int(side[away[0]]), 3)
        a = own[row, (k + 1) % 3]
        raise InputError(
            f"the walls end at an edge {at(others.points[a])}, where the body is concave: layers would not "
            "end on the facet beside it; make that a wall, too"
        )
