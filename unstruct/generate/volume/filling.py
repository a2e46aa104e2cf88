"""Tetrahedra of the vertices of a body, in which its facets are faces: recovery, inside, names, account.

See the book, 2.8b.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...connect.spatial.adding import add_points
from ...connect.spatial.complex import RESTARTS, WORTH_ANOTHER, Recovered, SpatialComplex, SpatialMesh
from ...domain.domain import Domain
from ...domain.space.cutting import Shell
from ...geometry.edge_vectors import lengths
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from ...sizing.field import SizeField, as_size
from .coarse import CoarseFacets
from .lattice import Lattice, lattice_points
from .rounder import faces_of_cells, rounded

__all__ = ["chains_of_segments", "filled", "numbered_parts_of", "numbered_regions", "with_names"]

HELPERS = 4  # points outside that may help to recover a surface, for each of its points
MORE_SEEDS = 3  # how often some seeds are tried, without and with points outside
MOST_HELPERS_OF_FEW = 1000  # however few points it has
MUCH_LARGER = 2.0  # edges of facets that are more times as long as wanted are named


def filled(
    domain: Domain,
    lattice: Lattice | None = None,
    *,
    field: SizeField | None = None,
    names: Callable[[int], str] | None = None,
    large: str = "a facet is larger than the size",
    optimize: bool = False,
    seed: int = 0,
    budget: int | None = None,
    history: bool = False,
    progress: bool = False,
) -> DomainMesh:
    """Tetrahedra of the vertices of a body, and of further ones where there must be.

    Parameters
    ----------
    domain : Domain
        In space.
    lattice : Lattice, optional
        Further vertices, on no piece; those outside are dropped in the end.
    field : SizeField, optional
        The wanted length of edges, by which cells at facets that are much larger are listed.
    names : callable, optional
        What messages call a piece; by default `Domain.name`.
    large : str
        What is said of these.
    optimize : bool
        Whether to make the cells rounder afterwards; see `rounded`.
    seed : int
        Of the random numbers of the recovery.
    budget : int, optional
        How many points may be added; see `SpatialComplex.recover`.
    history : bool
        Whether to keep a record of the recovery in ``steps``; not together with ``optimize``.
    progress : bool
        Show progress bars.

    Returns
    -------
    DomainMesh
        See `constrained_delaunay`.
    """
    if len(domain.facets) == 0:
        raise InputError(
            "the domain has no facets, so nothing is inside: give facets; without any, delaunay(points) "
            "fills the convex hull of points"
        )
    options: dict[str, Any] = {"seed": seed, "budget": budget, "history": history, "progress": progress}
    complex_, found, added = _with_lattice(domain, lattice, options)
    made = complex_.inside()
    if len(made.simplices) == 0:
        raise InputError("the facets enclose no volume")
    chains = chains_of_segments(domain, found, made)
    counts = {} if lattice is None else {"lattice points": added}
    if optimize and found.complete:
        made, changes = _rounder(domain, made, chains[0], seed, progress)
        counts |= changes
    unrefined = _incomplete(domain, found, made, names or domain.name)
    if field is not None:
        for cell in _large(made, field, None if lattice is None else lattice.coarse).tolist():
            unrefined.setdefault(cell, large)
    steps = None
    if history:
        steps = complex_.history() | {"inside": complex_.inside_slots(), "vertex": made.vertex}
    return with_names(domain, found, made, chains, unrefined, counts, steps)


def _with_lattice(
    domain: Domain, lattice: Lattice | None, options: dict[str, Any]
) -> tuple[SpatialComplex, Recovered, int]:
    """The cells with the parts inside numbered, and how many points of the lattice they have.

    Points that might be in the way of a facet are added afterwards; where facets are missing all the same,
    all are.
    """
    shell = domain.triangulated
    if lattice is None:
        complex_, found = _bare(domain, options)
        complex_.flood(len(shell.bounding))
        return complex_, found, 0
    first = np.concatenate([lattice.inside, lattice.outside])
    many, later = len(lattice.inside), lattice.beside
    if len(first):
        complex_, found = _recovered(np.concatenate([domain.points, first]), shell, options)
    if len(first) == 0 or not found.complete:
        other = _bare(domain, options)
        if len(first) == 0 or other[1].rank < found.rank:
            complex_, found = other
            many, later = 0, np.concatenate([lattice.inside, later])
    complex_.flood(len(shell.bounding))
    if len(later) and found.complete:
        many += add_points(complex_, later, found, shell.segments, progress=options["progress"])
    return complex_, found, many


def _recovered(
    points: NDArray[np.float64], shell: Shell, options: dict[str, Any]
) -> tuple[SpatialComplex, Recovered]:
    complex_ = SpatialComplex(points, progress=options["progress"])
    return complex_, complex_.recover(shell.triangles, shell.segments, **options)


def _bare(domain: Domain, options: dict[str, Any]) -> tuple[SpatialComplex, Recovered]:
    """The best of some seeds, without and with points outside, until all is exact.

    Where something is missing, often behind flat cells of points in a plane up to rounding, points outside
    help more than another seed: their cells are not flat. Where all is there, though in parts, another seed
    costs less. As long as something is missing, further seeds follow: each has its luck with the last few
    facets.
    """
    shell, best, more = domain.triangulated, None, domain.points
    for first in range(0, MORE_SEEDS * RESTARTS, RESTARTS):
        waiting: list[tuple[int, bool]] = [(first + k, False) for k in range(RESTARTS)]
        while waiting:
            step, outside = waiting.pop(0)
            if outside and more is domain.points:
                more = np.concatenate([domain.points, _outside(domain)])
            later = options | {"seed": options["seed"] + step, "restarts": 1, "hurry": best is None}
            one = _recovered(more if outside else domain.points, shell, later)
            best = one if best is None else min(best, one, key=_rank)
            if best[1].exact:
                return best
            if not outside:
                waiting.insert(len(waiting) if one[1].complete else 0, (step, True))
            if step > first and outside and sum(one[1].rank[:2]) > WORTH_ANOTHER:
                break
        if best is not None and best[1].complete:
            break
    assert best is not None
    return best


def _rank(one: tuple[SpatialComplex, Recovered]) -> tuple[int, int, int]:
    return one[1].rank


def _outside(domain: Domain) -> NDArray[np.float64]:
    """Points outside, next to the surface and as dense as it is; none if there would be too many."""
    low, high = domain.bounds
    size = as_size(float((high - low).max()))
    try:
        return lattice_points(domain, size, HELPERS * len(domain.points) + MOST_HELPERS_OF_FEW).outside
    except InputError:
        return np.empty((0, 3))


def _rounder(
    domain: Domain, made: SpatialMesh, segments: NDArray[np.int32], seed: int, progress: bool
) -> tuple[SpatialMesh, dict[str, int]]:
    """The same points inside, with rounder cells, and how they were made so."""
    marked = faces_of_cells(made.simplices, made.faces, len(made.points))
    better = rounded(
        made.points,
        (made.simplices, made.neighbors, made.region),
        marked,
        segments,
        made.vertex < len(domain.points),
        seed=seed,
        progress=progress,
    )
    result = made._replace(
        points=better.points, simplices=better.simplices, neighbors=better.neighbors, region=better.region
    )
    return result, {"refills": better.refills, "moves": better.moves}


def with_names(
    domain: Domain,
    found: Recovered,
    made: SpatialMesh,
    chains: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]],
    unrefined: dict[int, str],
    counts: dict[str, int],
    steps: dict[str, NDArray] | None = None,
) -> DomainMesh:
    """The mesh with all that is known of it."""
    shell = domain.triangulated
    given = len(domain.points)
    origin = np.where(made.vertex < given, made.vertex, -1).astype(np.int32)
    piece = shell.piece[made.triangle]
    segments, segment_piece, span = chains
    region = numbered_regions(domain, made)
    cells = sorted(unrefined)
    bounding = piece < len(domain.facets)
    markers: dict[str, Any] = {
        "facets": made.faces[bounding],
        "inner": made.faces[~bounding],
        "region": region,
    }
    for name, rows in domain.markers.items():
        faces = made.faces[np.isin(piece, rows)]
        edges = segments[np.isin(segment_piece, rows)]
        markers[name] = faces if len(faces) or not len(edges) else edges
    crossed = zip(("vertex-face", "edge-edge", "edge-face", "face-face"), found.crossings.tolist())
    mesh = DomainMesh(
        made.points,
        made.simplices,
        neighbors=made.neighbors,
        origin=origin,
        markers=markers,
        regions={name: k for k, name in enumerate(domain.regions)},
        segments=segments,
        piece=segment_piece,
        span=span,
        faces=made.faces,
        face_piece=piece,
        unrefined=np.array(cells, dtype=np.int32) if cells else None,
        reasons=[unrefined[cell] for cell in cells] if cells else None,
        counts={
            "added on pieces": len(found.steiner),
            "added inside": len(found.inner),
            "missing segments": len(found.segments),
            "missing triangles": len(found.triangles),
            **{f"crossings {kind}": count for kind, count in crossed},
            "seed": found.seed,
            **counts,
        },
        steps=steps,
    )
    return mesh


def chains_of_segments(
    domain: Domain, found: Recovered, made: SpatialMesh
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
    """The edges of inner segments, their pieces and the parameters of their ends."""
    shell = domain.triangulated
    number = np.full(max(int(made.vertex.max()) + 1, len(domain.points)), -1, dtype=np.int64)
    number[made.vertex] = np.arange(len(made.vertex))
    lost = {tuple(row) for row in np.sort(found.segments, axis=1).tolist()}
    ends: list[tuple[int, int]] = []
    owner: list[int] = []
    span: list[tuple[float, float]] = []
    for row, i in zip(shell.segments.tolist(), shell.segment_piece.tolist()):
        u, v = row
        vertices = found.chains.get((min(u, v), max(u, v)), [min(u, v), max(u, v)])
        chain = number[vertices if u < v else vertices[::-1]]
        if (min(u, v), max(u, v)) in lost or chain.min() < 0:
            continue
        start, along = domain.points[u], domain.points[v] - domain.points[u]
        axis = int(np.abs(along).argmax())  # the points are on the segment up to rounding
        share = (made.points[chain[1:-1], axis] - start[axis]) / along[axis]
        places = [0.0, *share.tolist(), 1.0]
        ends += pairwise(chain.tolist())
        span += pairwise(places)
        owner += [i] * (len(chain) - 1)
    return (
        np.array(ends, dtype=np.int32).reshape(-1, 2),
        np.array(owner, dtype=np.int32),
        np.array(span, dtype=np.float64).reshape(-1, 2),
    )


def numbered_regions(domain: Domain, made: SpatialMesh) -> NDArray[np.int32]:
    """The number of each cell: the place of the name of its part, or a further number for each other part."""
    cells = Mesh(made.points, made.simplices, neighbors=made.neighbors)
    return numbered_parts_of(domain, cells, made.region)


def numbered_parts_of(domain: Domain, cells: Mesh, parts: NDArray[Any]) -> NDArray[np.int32]:
    """The same for any mesh, with the part of the domain of each of its cells."""
    if not domain.regions:
        return _counted(parts, 0)
    names = list(domain.regions)
    seeds = np.concatenate(list(domain.regions.values()))
    name = np.repeat(np.arange(len(names)), [len(rows) for rows in domain.regions.values()])
    named = np.full(int(parts.max()) + 1, -1, dtype=np.int64)
    for k, cell in enumerate(cells.find_simplex(seeds).tolist()):
        part = parts[cell] if cell >= 0 else -1
        if part < 0:
            continue  # only if facets are missing; a `Domain` refuses seeds outside
        if named[part] not in (-1, name[k]):
            one, two = names[named[part]], names[name[k]]
            raise InputError(
                f"the seed {seeds[k].tolist()} of region {two!r} is in the same part as one of {one!r}; "
                "divide the part by inner facets, or give one name"
            )
        named[part] = name[k]
    rest = _counted(np.where(named[parts] < 0, parts, -1), len(names))
    return np.where(named[parts] >= 0, named[parts], rest).astype(np.int32)


def _counted(part: NDArray[Any], first: int) -> NDArray[np.int32]:
    """Parts (-1 for none) numbered from ``first`` on, in the order of their cells."""
    values, where, inverse = np.unique(part, return_index=True, return_inverse=True)
    rank = np.empty(len(values), dtype=np.int64)
    known = values >= 0
    order = np.argsort(where[known], kind="stable")
    rank[np.flatnonzero(known)[order]] = first + np.arange(len(order))
    rank[~known] = -1
    return rank[inverse.ravel()].astype(np.int32)


def _incomplete(
    domain: Domain, found: Recovered, made: SpatialMesh, name: Callable[[int], str]
) -> dict[int, str]:
    """The cells with an edge of what is missing, and what that is."""
    if found.complete:
        return {}
    shell = domain.triangulated
    number = np.full(len(domain.points), -1, dtype=np.int64)
    known = np.flatnonzero(made.vertex < len(domain.points))
    number[made.vertex[known]] = known
    reason: dict[int, str] = {}
    lost = [(shell.triangles[t], f"{name(int(shell.piece[t]))} is missing") for t in found.triangles]
    lost += [(row, f"the edge {row[0]}-{row[1]} is missing") for row in found.segments.tolist()]
    for row, text in lost:
        rows = number[np.asarray(row)]
        for cell in np.flatnonzero(np.isin(made.simplices, rows[rows >= 0]).sum(axis=1) >= 2).tolist():
            reason.setdefault(cell, text)
    if not reason:  # far from the inside
        reason = {0: lost[0][1]}
    return reason


def _large(made: SpatialMesh, field: SizeField, coarse: CoarseFacets | None) -> NDArray[np.int64]:
    """The cells at faces of pieces, or near coarse facets, with an edge that is much longer than wanted."""
    corners = made.points[made.faces]
    large = np.zeros(len(corners), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        length = lengths(corners[:, i] - corners[:, j])
        large |= length > MUCH_LARGER * field((corners[:, i] + corners[:, j]) / 2)
    at = faces_of_cells(made.simplices, made.faces[large], len(made.points)).any(axis=1)
    if coarse is not None:
        at |= _larger_beside(made, field, coarse)
    return np.flatnonzero(at)


def _larger_beside(made: SpatialMesh, field: SizeField, coarse: CoarseFacets) -> NDArray[np.bool_]:
    """Which cells have an edge much longer than wanted, where the size is that of a coarse facet."""
    corners = made.points[made.simplices]
    center = corners.mean(axis=1)
    size, longest = field(center), np.zeros(len(corners))
    for i in range(4):
        for j in range(i):
            np.maximum(longest, lengths(corners[:, i] - corners[:, j]), out=longest)
    beside = coarse.least(center, np.zeros(len(center))) > size
    return beside & (longest > MUCH_LARGER * size)
