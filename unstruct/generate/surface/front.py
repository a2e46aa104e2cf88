"""An advancing front on a surface: triangles of a wanted size, one after the other. See the book, 2.7."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import DEFAULT_BUDGET, as_count, as_flag, finite
from ...base.errors import IncompleteWarning, InputError
from ...base.progress import progress_bar
from ...domain.given_surface import USUAL_SHARP, GivenSurface, directed, given_surface
from ...geometry.embedded import flat_rows
from ...geometry.support import Support
from ...mesh.domain_mesh import DomainMesh, noticed
from ...sizing.asked import MISSED_SIZE
from ...sizing.field import SizeField, as_size
from .cleaning import cleaned
from .front_finish import made_rounder
from .front_march import MarchedFront, marched, surface_sizes
from .front_sound import fault_of_front, meets_itself
from .missed import crossing_reasons, missed_size
from .remesh import remesh

__all__ = ["surface_front"]

Array = NDArray[np.float64]
# What is tried, one after the other: the share of the wanted lengths, and the angle in radians by which the
# surface may turn within a length.
ATTEMPTS = ((1.0, np.inf), (1.0, 0.8), (0.7, 0.5))
LOWERED_SIZE = "small: the front did not close with the wanted lengths, so they were lowered"
REMESHED = "remeshed: the front did not close ({}), so the surface was remeshed"
NOT_CLOSED = "given: the front did not close ({}), so the triangles of the surface were kept"
BUDGET_SHORT = "given: the budget does not suffice, so the triangles of the surface were kept"


class MadeFront(NamedTuple):
    """Vertices and triangles, edges on curves with their curve, the vertex of the surface that each is."""

    points: Array
    rows: NDArray[np.int64]
    edges: NDArray[np.int64]
    chain: NDArray[np.int64]
    origin: NDArray[np.int64]


def surface_front(
    surface: Any,
    size: Any,
    *,
    sharp: float = USUAL_SHARP,
    improve: bool = True,
    budget: int = DEFAULT_BUDGET,
    progress: bool = False,
) -> DomainMesh:
    """Cover a surface with triangles of a wanted size by an advancing front.

    Parameters
    ----------
    surface : Domain or Mesh
        The facets of a body in space, or a mesh of triangles in space, which may be open, branch, and have
        several components. New vertices lie on it.
    size : float, SizeField or callable
        The wanted edge length; a function takes points (k, 3) and returns k lengths.
    sharp : float
        The degrees by which the surface turns at a crease; 180 for no creases. Edges of the mesh run along
        creases, the boundary, edges between triangles with different names, and named edges; corners of these
        are vertices.
    improve : bool
        Whether edges are flipped and vertices moved along the surface when the front has closed.
    budget : int
        The largest number of vertices.
    progress : bool
        Show a progress bar.

    Returns
    -------
    DomainMesh
        Triangles, turned as those of the surface, all of a part as its first one; the facets of a body face
        outward. ``origin`` has the vertices of the surface that were kept, ``markers`` the names. ``counts``
        tells how triangles were found: "candidate" with a vertex near the ideal point, "point" with a new
        vertex, "search" with one farther away, "again" edges that had to wait; "attempts"; and what was wrong
        with the triangles of a given mesh, as in `remesh`: "equal points", "degenerate triangles", "repeated
        triangles", "turned triangles", "own crossings". Triangles that miss the size, at the barycenter or at
        a corner, and those that cross others are in ``unrefined``, with ``reasons``. ``figures`` has "sharp",
        and the "deviation", the largest distance of the mesh and the surface from each other at samples.

    Raises
    ------
    InputError
        For wrong arguments, and if all triangles are flat.

    Notes
    -----
    The front itself is judged in tangent planes, where the tests are exact, but projections of a curved front
    need not be one. So when it has closed, the mesh is tested: its edges and vertices, components and their
    Euler characteristics by counting, and, exactly, that it does not meet itself. If the front gets stuck or
    the mesh fails, it is tried again with lengths lowered where the surface turns much within them, twice. If
    that fails, too, the triangles of the surface are remeshed, and if that meets itself, the mesh is the
    surface itself. This always ends, and nothing is silent: the reasons are in ``unrefined`` and ``reasons``,
    and a warning tells them.

    O(n log n) for n triangles. Sources: J. Peraire, J. Peiró, L. Formaggia, K. Morgan, O. C. Zienkiewicz,
    Int. J. Numer. Meth. Engng 26 (1988) 2135-2159; R. Löhner, P. Parikh, Int. J. Numer. Meth. Fluids 8 (1988)
    1135-1149. Book: 2.7.
    """
    field, budget, improve = as_size(size), as_count(budget, "budget"), as_flag(improve, "improve")
    if not 0.0 < finite(sharp, "sharp") <= 180.0:
        raise InputError(f"sharp must be an angle up to 180 degrees, not {sharp!r}")
    clean = cleaned(surface, flat=True)
    given = directed(given_surface(clean.surface, sharp if sharp < 180.0 else None))
    support = given.support
    why, counts = "", {}
    nodes = surface_sizes(support, field)
    for attempt, tried in enumerate(ATTEMPTS):
        with progress_bar(progress, " triangles") as bar:
            front = marched(support, field, nodes, tried, budget, bar)
        counts = front.counts | {"attempts": attempt + 1} | clean.counts
        why = front.why or _fault(support, front)
        if not why:
            made = _finished(support, front, field, improve)
            reason = LOWERED_SIZE if attempt else ""
            return noticed(_as_mesh(given, made, (sharp, clean.regions, field), counts, reason))
        if front.full:
            break
    if not front.full:
        other = _remeshed(clean.surface, support, field, (sharp, budget), counts, why)
        if other is not None:
            return noticed(other)
    reason = BUDGET_SHORT if front.full else NOT_CLOSED.format(why)
    return noticed(_as_mesh(given, _kept(support), (sharp, clean.regions, field), counts, reason))


def _fault(support: Support, front: MarchedFront) -> str:
    return fault_of_front(front.points, front.rows, front.origin, support, front.sides)


def _finished(support: Support, front: MarchedFront, size: SizeField, improve: bool) -> MadeFront:
    """The mesh made rounder, unless it meets itself then."""
    made = MadeFront(front.points, front.rows, front.edges, front.chain, front.origin)
    if not improve:
        return made
    corners = np.flatnonzero(np.isin(front.origin, support.corners))
    rounder = made_rounder(
        support, front.points, front.rows, (front.edges, front.chain, corners), front.near, front.wanted, size
    )
    if meets_itself(rounder[0], rounder[1], support):
        return made
    return MadeFront(*rounder, _places(rounder[0], support))


def _places(points: Array, support: Support) -> NDArray[np.int64]:
    """The corner of the surface in the place of each vertex, -1 for none."""
    places = (support.points[support.corners] * support.factor).tolist()
    known = {tuple(row): int(v) for v, row in zip(support.corners, places)}
    return np.array([known.get(tuple(row), -1) for row in points.tolist()], dtype=np.int64)


def _remeshed(
    surface: Any,
    support: Support,
    size: SizeField,
    options: tuple[float, int],
    counts: dict[str, int],
    why: str,
) -> DomainMesh | None:
    """The surface remeshed; None if that meets itself."""
    sharp, budget = options
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)  # all cells get a reason of their own
        mesh = remesh(surface, size, sharp=sharp if sharp < 180.0 else None, budget=budget)
    points, rows = mesh.points * support.factor, mesh.simplices.astype(np.int64)
    if len(flat_rows(points, rows)) or meets_itself(points, rows, support):
        return None
    return DomainMesh(
        mesh.points,
        mesh.simplices,
        origin=mesh.origin,
        markers=mesh.markers,
        regions=mesh.regions,
        unrefined=np.arange(mesh.size),
        reasons=np.full(mesh.size, REMESHED.format(why)),
        counts=counts | {"own crossings": mesh.counts["own crossings"]},
        figures={"sharp": sharp, "deviation": mesh.figures["deviation"]},
    )


def _kept(support: Support) -> MadeFront:
    """The triangles of the surface itself, without flat ones."""
    rows = support.held.rows[(support.normals != 0.0).any(axis=1)]
    used, rows = np.unique(rows, return_inverse=True)
    number = np.full(len(support.points), -1)
    number[used] = np.arange(len(used))
    edges = number[support.features]
    whole = (edges >= 0).all(axis=1)
    return MadeFront(
        support.points[used] * support.factor,
        rows.reshape(-1, 3),
        edges[whole],
        support.chain[whole],
        used,
    )


def _as_mesh(
    given: GivenSurface,
    made: MadeFront,
    told: tuple[float, Mapping[str, int], SizeField],
    counts: dict[str, int],
    reason: str,
) -> DomainMesh:
    """The mesh with its names; ``told`` has the angle of creases, the numbers of named regions, the size."""
    support, rows = given.support, made.rows.astype(np.int32)
    points, x = made.points / support.factor, made.points[rows]  # scaled: products of lengths are finite
    middle = (x[:, 0] / 3 + x[:, 1] / 3 + x[:, 2] / 3) / support.factor
    normals = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    triangle = support.nearest(middle, normals=normals)[0]
    markers = given.markers(rows, triangle) | _named_edges(given, made, points)
    there, back = support.deviation(points, rows)
    crossing, own = crossing_reasons(made.points, rows, support)
    why = dict.fromkeys(range(len(rows)), reason) if reason else {}
    if not why:
        why = dict.fromkeys(missed_size(points, rows, told[2]).tolist(), MISSED_SIZE)
    why |= crossing
    cells = sorted(why)
    return DomainMesh(
        points,
        rows,
        origin=made.origin,
        markers=markers,
        regions=told[1],
        unrefined=cells,
        reasons=[why[i] for i in cells],
        counts=counts | {"own crossings": own},
        figures={"sharp": told[0], "deviation": max(there, back)},
    )


def _named_edges(given: GivenSurface, made: MadeFront, points: Array) -> dict[str, NDArray[np.int64]]:
    """The edges on curves whose middle lies on a named edge of the surface."""
    found: dict[str, NDArray[np.int64]] = {}
    if not given.edges:
        return found
    support, n = given.support, len(given.support.points)
    feature = support.onto_chain(points[made.edges].mean(axis=1), made.chain)[0]
    ends = np.sort(support.features[feature], axis=1)
    first = np.arange(n)
    first[given.support.triangles.ravel()] = support.held.rows.ravel()
    for name, rows in given.edges.items():
        if name not in given.names:
            named = np.sort(first[rows], axis=1)
            found[name] = made.edges[np.isin(ends[:, 0] * n + ends[:, 1], named[:, 0] * n + named[:, 1])]
    return found
