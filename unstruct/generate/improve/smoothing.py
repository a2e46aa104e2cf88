"""Smoothing: vertices are moved to better places and diagonals are swapped; every step keeps the mesh valid.

See `generate.improve.rounds` for the kernels and the sources. Book: 2.6d.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flags, finite
from ...base.errors import InputError, MeshError
from ...connect.planar.stars import Stars, opposite_half_edges
from ...connect.swapping import constraints, first_fault, planar_coordinates
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from ...mesh.topology import twins
from ...predicates.batch import unscaled
from .rounds import CENTROID, FLIPS, INVALID, LAPLACE, LOOKED, MOVED, OPTIMAL, SEARCH, WORSE, smooth_round

__all__ = ["smooth", "staying"]

METHODS = {"laplace": LAPLACE, "optimal": OPTIMAL, "centroid": CENTROID, "search": SEARCH}
VISITS_A_CALL = 200_000  # vertices visited in one kernel call: Ctrl-C works between calls
COUNTED = {"moved": MOVED, "invalid": INVALID, "worse": WORSE, "swaps": FLIPS, "examined": LOOKED}


def smooth(
    mesh: Mesh,
    method: str = "laplace",
    *,
    rounds: int = 10,
    smart: bool = True,
    swap: bool = True,
    below: float | None = None,
    fixed: ArrayLike | None = None,
    progress: bool = False,
) -> DomainMesh:
    """Move the inner vertices of a planar triangle mesh so that its triangles become rounder.

    Parameters
    ----------
    mesh : Mesh
        Counterclockwise triangles in the plane.
    method : {"laplace", "optimal", "centroid", "search"}
        Where a vertex is moved, one vertex after the other: to the mean of its neighbors; to the mean of the
        circumcenters of its triangles, weighted by their areas (optimal Delaunay triangulation); to the mean
        of their centroids, weighted in the same way (centroidal patches, close to a centroidal Voronoi
        tessellation); or to the best place that a search in eight directions finds.
    rounds : int
        How often all vertices are visited; smoothing ends sooner when no vertex moves.
    smart : bool
        Move a vertex only if the minimum 2 r / R around it grows. Otherwise every valid move is made.
    swap : bool
        Swap diagonals after each move, so that a constrained Delaunay triangulation stays one.
    below : float, optional
        Look only at vertices with a triangle whose 2 r / R is less than this.
    fixed : array_like of int, optional
        Vertices that stay. In a mesh of a domain (`DomainMesh`) the default is the vertices of the domain.
    progress : bool
        Show the rounds.

    Returns
    -------
    DomainMesh
        The same vertices and markers, with new places and, with ``swap``, new triangles. ``counts`` contains
        the moves that were made ("moved"), those refused because a triangle would turn over ("invalid", an
        exact test) or because the star would be no better ("worse"), the vertices looked at ("examined"), and
        the "swaps" and "rounds".

    Raises
    ------
    MeshError
        For a mesh that is not made of counterclockwise triangles of the plane (`improve` is for tetrahedra).
    InputError
        For an unknown method, a negative number of rounds, or numbers of vertices that do not exist.

    Notes
    -----
    Boundary vertices, those on marked edges, those named by a marker and those in `pairs`, which the result
    keeps, stay. With ``swap``, the input is
    expected to be constrained Delaunay (`swap_diagonals` makes it so); regions and marked edges are kept. A
    round takes O(n). Ctrl-C leaves the input untouched. Sources: Field (1988); Chen and Holst (2011).
    Book: 2.6d.
    """
    as_flags(smart=smart, swap=swap, progress=progress)
    if not isinstance(method, str) or method not in METHODS:
        *names, last = METHODS
        raise InputError(f"no method is called {method!r}; there are {', '.join(names)} and {last}")
    rounds = as_count(rounds, "rounds")
    limit = 2.0 if below is None else finite(below, "below")
    if isinstance(mesh, Mesh) and mesh.dimension == 3:
        raise MeshError(f"smooth is for triangles in the plane; for {mesh!r} see improve")
    coordinates, wide = planar_coordinates(mesh)
    if mesh.size == 0:
        raise MeshError(f"there is nothing to smooth: {mesh!r}")
    fault = first_fault(coordinates, mesh.simplices, mesh.neighbors, wide)
    if wide or fault >= 0:
        what = "its coordinates span too many exponents" if wide else f"simplices[{fault}] is not valid"
        raise MeshError(f"this mesh cannot be smoothed: {what}; see unstruct.check")
    markers, locked = constraints(mesh, None)
    xy = coordinates.copy()
    vertex, twin = mesh.simplices.ravel().copy(), twins(mesh.neighbors)
    mark = np.where((twin >= 0) & ~locked.ravel(), -1, 0).astype(np.int32)  # 0: the edge must stay
    at = np.empty(len(xy), dtype=np.int32)
    opposite_half_edges(vertex, np.zeros(mesh.size, dtype=np.int32), mesh.size, at)
    closed = mark.reshape(-1, 3) >= 0
    stays = staying(mesh, fixed) | (at < 0)
    stays[mesh.simplices[np.roll(closed, 1, axis=1) | np.roll(closed, -1, axis=1)]] = True  # ends of these
    counts = np.zeros(8, dtype=np.int64)
    where = np.zeros(1, dtype=np.int32)  # all edges that must stay share one mark; its place is never used
    ring, stack = np.empty(len(mark) + 8, dtype=np.int32), np.empty(4 * len(mark) + 64, dtype=np.int32)
    places = np.empty((len(ring) + 1, 2))
    stars = Stars(xy, vertex, twin, mark, where, at, stays, ring, places, stack, counts)
    done = 0
    for number in _rounds(rounds, progress):
        done, before = number, counts[MOVED]
        for start in range(0, len(xy), VISITS_A_CALL):
            stop = min(start + VISITS_A_CALL, len(xy))
            smooth_round(stars, METHODS[method], smart, swap, limit, start, stop)
        if counts[MOVED] == before:
            break
    found = {name: int(counts[place]) for name, place in COUNTED.items()} | {"rounds": done}
    moved = (xy != coordinates).any(axis=1)
    points = np.array(mesh.points)
    points[moved] = unscaled(xy[moved], _factor(mesh.points, coordinates))
    points[mesh.duplicates[:, 0]] = points[mesh.duplicates[:, 1]]
    return _result(mesh, points, vertex.reshape(-1, 3), markers, found)


def _factor(points: NDArray[np.float64], coordinates: NDArray[np.float64]) -> float:
    k = int(np.argmax(np.abs(points)))
    return float(coordinates.flat[k] / points.flat[k])


def staying(mesh: Mesh, fixed: ArrayLike | None) -> NDArray[np.bool_]:
    """Vertices (n,) that do not move: those in pairs, those that a marker names, and ``fixed``."""
    stays = np.zeros(len(mesh.points), dtype=bool)
    stays[mesh.pairs.ravel()] = True
    for rows in mesh.markers.values():
        if rows.ndim == 2 and rows.shape[1] == 1:
            stays[rows[:, 0]] = True
    if fixed is None:
        return stays | (mesh.origin >= 0) if isinstance(mesh, DomainMesh) else stays
    rows = np.asarray(fixed).ravel()
    if rows.size and (rows.dtype.kind not in "iu" or rows.min() < 0 or rows.max() >= len(stays)):
        raise InputError(f"fixed must be numbers of vertices, 0..{len(stays) - 1}")
    stays[rows.astype(np.int64)] = True
    return stays


def _rounds(rounds: int, progress: bool) -> Any:
    numbers = range(1, rounds + 1)
    if not progress:
        return numbers
    from tqdm.auto import tqdm

    return tqdm(numbers, unit=" rounds")


def _result(
    mesh: Mesh, points: NDArray, simplices: NDArray, markers: dict[str, NDArray], counts: dict[str, int]
) -> DomainMesh:
    """The smoothed mesh with the account of a `DomainMesh`; unrefined cells that still exist stay listed."""
    rest: dict[str, Any] = {}
    if isinstance(mesh, DomainMesh):
        rest = {"segments": mesh.segments, "piece": mesh.piece, "span": mesh.span}
        old = np.sort(mesh.simplices[mesh.unrefined], axis=1)
        number = {tuple(row): k for k, row in enumerate(old.tolist())}
        rows = np.sort(simplices, axis=1).tolist() if number else []
        same = [(t, number[tuple(row)]) for t, row in enumerate(rows) if tuple(row) in number]
        rest["unrefined"] = [t for t, _ in same]
        rest["reasons"] = [mesh.reasons[k] for _, k in same]
        counts = mesh.counts | counts
    return DomainMesh(
        points,
        simplices,
        origin=mesh.origin,
        duplicates=mesh.duplicates,
        markers=markers,
        regions=mesh.regions,
        periodic=mesh.periodic,
        counts=counts,
        **rest,
    )
