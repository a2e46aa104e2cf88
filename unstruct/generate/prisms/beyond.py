"""What is beyond layers filled with tetrahedra, and both as one mesh of the body. See the book, chapter 5."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...base.errors import InputError
from ...domain.domain import Domain
from ...domain.space.cutting import at
from ...geometry import simplex
from ...geometry.inside_shell import side_mates
from ...geometry.polygons import Polygons
from ...mesh.cells import incident_facets
from ...mesh.domain_mesh import IS_MISSING, DomainMesh
from ...mesh.grouping import group_rows
from ...mesh.mesh import Mesh
from ...mesh.split import simplices_of_cells
from ...sizing.field import SizeField
from ..bodies.tetrahedralize import LARGE_TRIANGLE, tetrahedra_by_size
from ..volume.filling import numbered_parts_of
from ..volume.lacking import what_is_missing
from ..volume.rounder import faces_of_cells
from .remainder import Grown, Remainder, padded_to_four, remainder, side_pieces

__all__ = ["LARGEST_JUMP", "LEAST_BEYOND", "MEDIAN_JUMP", "filled_beyond", "sides_of_layers", "whole_faces"]

Rows = NDArray[np.int64]
SAME_VOLUME = 2.0**-30  # of the body's volume: sums in doubles; what is wrong is far larger
SEEDS_BEYOND = 3  # how many are tried as long as the cap is not kept
MEDIAN_JUMP, LARGEST_JUMP = "jump of volume at the cap, median", "jump of volume at the cap, largest"
LEAST_BEYOND = "least dihedral angle beyond"
DIVIDED_CAP = f"a triangle of the cap, undivided,{IS_MISSING}"
LARGE_ON_SURFACE = "a triangle of the surface, or the cap above it, is larger than the size: divide it before"
OTHER_LAYERS = "other layers, or another seed, may help"


def filled_beyond(
    domain: Domain, grown: Grown, field: SizeField, options: dict[str, Any]
) -> tuple[DomainMesh, str]:
    """Layers and tetrahedra as one mesh of a body.

    Parameters
    ----------
    domain : Domain
        The body.
    grown : Grown
        Layers on its walls, inside.
    field : SizeField
        The wanted length of edges beyond.
    options : dict
        ``optimize``, ``seed``, ``budget``, ``progress`` and ``split_boundary`` (None or False), as for
        `tetrahedralize`.

    Returns
    -------
    DomainMesh
        The vertices of the layers come first, and so do their cells among those of each kind. Cells are
        "hexahedron", "wedge", "pyramid", "tetra" as far as there are any. In markers and ``faces`` the
        triangles of the cap are inner faces: they have the marker "cap".
    str
        What is missing, "" if nothing is: then the cap is kept, triangle by triangle, and the mesh is one of
        the body.

    Raises
    ------
    InputError
        If what is left is no body (see `remainder`), or layers surround other facets, loose points, or inner
        pieces.
    """
    layers = Mesh(grown.points, None, cells=grown.cells)
    rest, inside = remainder(domain, grown), layers.volume
    _must_leave_points(domain, layers)
    if abs(rest.domain.volume + inside - domain.volume) > SAME_VOLUME * domain.volume:
        raise InputError(
            f"layers have the volume {inside:.6g}, what they leave of the body has {rest.domain.volume:.6g}, "
            f"but the body has {domain.volume:.6g}: they surround other facets, or overlap; make them thinner"
        )
    for step in range(SEEDS_BEYOND):
        more = options | {"seed": options["seed"] + step}
        mesh = tetrahedra_by_size(rest.domain, field, **more, names=lambda piece: rest.name(piece, domain))
        lacking, above = what_is_missing(rest.domain, mesh, OTHER_LAYERS), _above_cap(mesh, rest)
        lost = np.flatnonzero(above < 0)
        if not lacking and not len(lost):
            break
    why = [LARGE_ON_SURFACE if reason == LARGE_TRIANGLE else reason for reason in mesh.reasons.tolist()]
    reasons = dict(zip(mesh.unrefined.tolist(), why, strict=True))
    if len(lost) and not lacking:
        place = [float(f"{x:.6g}") for x in grown.points[grown.cap[lost[0]]].mean(axis=0)]
        lacking = (
            f"the mesh is not one of the body: {len(lost)} triangles of the cap are divided, near {place}, "
            f"and the layers below are not; {OTHER_LAYERS}"
        )
        reasons |= dict.fromkeys(_cells_at(mesh, rest, lost).tolist(), DIVIDED_CAP)
    return _joined(domain, grown, rest, mesh, above, reasons), lacking


def _must_leave_points(domain: Domain, layers: Mesh) -> None:
    """Points that are to be vertices, loose or of inner pieces, must not lie in layers."""
    inner = Polygons.of(domain.inner).vertices if len(domain.inner) else np.empty(0, dtype=np.int64)
    every = np.unique(np.concatenate([np.asarray(domain.loose), inner])).astype(np.int64)
    if not len(every):
        return
    within = every[layers.find_simplex(domain.points[every]) >= 0]
    if len(within):
        v = int(within[0])
        raise InputError(
            f"a point {at(domain.points[v])} that is loose, or a corner of an inner piece, lies in the "
            "layers, which have no vertex there: make them thinner, or leave it out"
        )


def _above_cap(mesh: DomainMesh, rest: Remainder) -> Rows:
    """The cell of the rest at each triangle of the cap; -1 for those that are missing or divided."""
    piece = np.asarray(mesh.face_piece)
    own = np.flatnonzero((piece >= rest.cap.start) & (piece < rest.cap.stop))
    whole = (np.asarray(mesh.origin)[np.asarray(mesh.faces)[own]] >= 0).all(axis=1)
    own = own[whole]
    result = np.full(rest.cap.stop - rest.cap.start, -1, dtype=np.int64)
    cell, _ = _cells_of_faces(mesh, np.asarray(mesh.faces)[own])
    result[piece[own] - rest.cap.start] = cell
    return result


def _cells_of_faces(mesh: DomainMesh, faces: NDArray[np.integer]) -> tuple[Rows, Rows]:
    """The cell of each face of the boundary, and the corner opposite."""
    every = np.sort(np.concatenate([np.delete(mesh.simplices, i, axis=1) for i in range(4)]), axis=1)
    wanted = np.sort(faces, axis=1)
    border = np.flatnonzero((np.asarray(mesh.neighbors) < 0).T.ravel())
    order = np.lexsort(every[border].T[::-1])
    keys, own = _ranks(every[border][order], wanted)
    at = np.searchsorted(keys, own).clip(max=max(len(keys) - 1, 0))
    place = border[order][at]
    return place % len(mesh.simplices), place // len(mesh.simplices)


def _ranks(rows: Rows, others: Rows) -> tuple[Rows, Rows]:
    """Numbers that order rows of three as the rows themselves are ordered."""
    _, both = np.unique(np.concatenate([rows, others]), axis=0, return_inverse=True)
    both = both.ravel()
    return both[: len(rows)], both[len(rows) :]


def _cells_at(mesh: DomainMesh, rest: Remainder, lost: Rows) -> Rows:
    """Cells of the rest at parts of some triangles of the cap; the first one if there is none."""
    own = np.isin(np.asarray(mesh.face_piece) - rest.cap.start, lost)
    at = faces_of_cells(mesh.simplices, np.asarray(mesh.faces)[own], len(mesh.points)).any(axis=1)
    return np.flatnonzero(at) if at.any() else np.zeros(1, dtype=np.int64)


# ---------------------------------------------------------------------- one mesh


def _joined(
    domain: Domain,
    grown: Grown,
    rest: Remainder,
    mesh: DomainMesh,
    above: Rows,
    reasons: dict[int, str],
) -> DomainMesh:
    """The mesh of both; ``above`` has the cell of the rest at each triangle of the cap."""
    number, origin, points = _numbers(domain, grown, rest, mesh)
    cells = {kind: rows for kind, rows in grown.cells.items() if kind != "tetra" and len(rows)}
    own = grown.cells.get("tetra", np.empty((0, 4), dtype=np.int32))
    cells["tetra"] = np.concatenate([own, number[mesh.simplices]]).astype(np.int32)
    before = len(grown.column)
    faces, whole, piece = sides_of_layers(domain, grown, grown.piece)
    rest_piece = rest.piece[np.asarray(mesh.face_piece)]
    bare = _bare_columns(grown)  # there the cap is the wall
    at_cap = np.flatnonzero(rest_piece < 0)
    row = np.asarray(mesh.face_piece)[at_cap] - rest.cap.start
    is_wall = bare[row]
    rest_piece[at_cap[is_wall]] = grown.piece[row[is_wall]]
    stays = rest_piece >= 0
    rest_faces = number[np.asarray(mesh.faces)[stays]]
    every = np.concatenate([faces, rest_faces])
    every_piece = np.concatenate([piece[0], rest_piece[stays]])
    segments = number[np.asarray(mesh.segments)].reshape(-1, 2)
    segment_piece = rest.piece[np.asarray(mesh.piece)]
    wide = padded_to_four(rest_faces)
    markers = names_of_faces(
        domain,
        (np.concatenate([whole, wide]), np.concatenate([piece[1], rest_piece[stays]])),
        (segments, segment_piece),
    )
    part = np.concatenate([np.asarray(mesh.markers["region"])[above][grown.column], mesh.markers["region"]])
    bare_mesh = Mesh(points, None, cells=cells)
    cap = grown.cap[~bare]
    listed = sorted(reasons)
    return DomainMesh(
        points,
        None,
        cells=cells,
        origin=origin.astype(np.int32),
        markers=markers | {"cap": cap, "region": numbered_parts_of(domain, bare_mesh, part)},
        regions={name: k for k, name in enumerate(domain.regions)},
        segments=segments,
        piece=segment_piece,
        span=mesh.span,
        faces=every,
        face_piece=every_piece,
        unrefined=[before + cell for cell in listed] if listed else None,
        reasons=[reasons[cell] for cell in listed] if listed else None,
        counts=mesh.counts,
        figures=_figures(grown, mesh, bare_mesh, above),
    )


def _numbers(
    domain: Domain, grown: Grown, rest: Remainder, mesh: DomainMesh
) -> tuple[Rows, Rows, NDArray[np.float64]]:
    """The number in the whole of each vertex of the rest; origins and places of all vertices of the whole."""
    many, n = len(domain.points), len(grown.points)
    own = np.full(many, -1, dtype=np.int64)
    base = np.flatnonzero(grown.level == 0)
    own[grown.stem[base]] = base
    at = np.asarray(mesh.origin, dtype=np.int64)
    known = np.where(at >= 0, rest.vertex[at], -1)  # in the numbers of `Remainder`
    number = np.where(known >= many, known - many, -1)
    of_body = (known >= 0) & (known < many)
    number[of_body] = own[known[of_body]]
    new = np.flatnonzero(number < 0)
    number[new] = n + np.arange(len(new))
    origin = np.full(n + len(new), -1, dtype=np.int64)
    origin[base] = grown.stem[base]
    origin[n:] = np.where(of_body[new], known[new], -1)
    return number, origin, np.concatenate([grown.points, mesh.points[new]])


def _bare_columns(grown: Grown) -> NDArray[np.bool_]:
    """The columns without layers, (t,)."""
    return np.asarray((grown.base == grown.cap[:, :3]).all(axis=1), dtype=bool)


def sides_of_layers(
    domain: Domain | None, grown: Grown, walls: NDArray[np.integer], *, exposed: bool = False
) -> tuple[Rows, Rows, tuple[Rows, Rows]]:
    """The faces of layers on pieces of the body: their bases, and their sides in planes where they end.

    Parameters
    ----------
    domain : Domain or None
        None for a surface that is open: it has no pieces in the planes in which layers end.
    grown : Grown
    walls : (k,) int
        The facets that are walls, with layers or not.
    exposed : bool
        Whether layers may end elsewhere, too; these sides are left out.

    Returns
    -------
    faces : (f, 3)
        Quadrilaterals as two triangles, cut from their lowest vertices.
    whole : (g, 4)
        The same faces, triangles padded by -1.
    pieces : tuple of (f,) and (g,)
        The piece of each.
    """
    a, b, c = grown.base.T
    solid = ~_bare_columns(grown) & (a != b) & (b != c) & (c != a)  # what stands on creases has no base
    base, piece = grown.base[solid], grown.piece[solid]
    if domain is None:
        return base, padded_to_four(base), (piece, piece)
    with_fans = bool(((a == b) | (b == c) | (c == a)).any())
    rows = _every_side(grown, base) if with_fans else _outer_sides(grown)
    if len(rows) == 0:
        return base, padded_to_four(base), (piece, piece)
    found = side_pieces(domain, grown, rows, walls, exposed=exposed)
    rows, found = rows[found >= 0], found[found >= 0]
    quads = rows[:, 3] >= 0
    halves, owner = simplices_of_cells({"quad": rows[quads]})
    faces = np.concatenate([base, rows[~quads, :3], halves])
    whole = np.concatenate([padded_to_four(base), rows])
    of_faces = np.concatenate([piece, found[~quads], found[quads][owner]])
    return faces, whole, (of_faces, np.concatenate([piece, found]))


def _every_side(grown: Grown, base: Rows) -> Rows:
    """The faces of the boundary that are neither base nor cap, padded by -1 to four vertices."""
    rows = _boundary(grown.cells)
    ends = [padded_to_four(part) for part in (base, grown.cap)]
    number, _ = group_rows(np.sort(np.concatenate([rows, *ends]), axis=1))
    return rows[~np.isin(number[: len(rows)], number[len(rows) :])]


def _boundary(cells: dict[str, Any]) -> Rows:
    rows, _, group = incident_facets(cells)
    rows = rows[np.bincount(group)[group] == 1].astype(np.int64)
    return padded_to_four(rows)


def _outer_sides(grown: Grown) -> Rows:
    """The faces of cells over the border of the walls, padded by -1 to four vertices.

    Only the columns there are looked at, which are few.
    """
    below = grown.stem[grown.base]
    side = np.flatnonzero(side_mates(below) < 0)
    t, k = side // 3, side % 3
    border = _edge_keys(below[t, (k + 1) % 3], below[t, (k + 2) % 3])
    chosen = flagged(len(below), t)[grown.column]
    cells, start = {}, 0
    for kind, block in grown.cells.items():
        cells[kind] = block[chosen[start : start + len(block)]]
        start += len(block)
    cells = {kind: block for kind, block in cells.items() if len(block)}
    if not cells:
        return np.empty((0, 4), dtype=np.int64)
    rows = _boundary(cells)
    stems = np.where(rows >= 0, grown.stem[rows], grown.stem[rows[:, :1]])
    low, high = stems.min(axis=1), stems.max(axis=1)
    over_one_edge = ((stems == low[:, None]) | (stems == high[:, None])).all(axis=1) & (low < high)
    return rows[over_one_edge & np.isin(_edge_keys(low, high), border)]


def _edge_keys(a: Rows, b: Rows) -> Rows:
    return (np.minimum(a, b) << 32) | np.maximum(a, b)


def whole_faces(rows: Rows) -> Rows:
    """Faces padded by -1 to four vertices, as rows of three if none has four."""
    return rows if (rows[:, 3] >= 0).any() else rows[:, :3]


def names_of_faces(
    domain: Domain, faces: tuple[Rows, Rows], segments: tuple[Rows, Rows]
) -> dict[str, NDArray[Any]]:
    """The markers of a body's pieces: faces (padded by -1 to four) and segments, each with their pieces."""
    rows, piece = faces
    bounding = piece < len(domain.facets)
    markers = {"facets": whole_faces(rows[bounding]), "inner": whole_faces(rows[~bounding])}
    for name, pieces in domain.markers.items():
        named = whole_faces(rows[np.isin(piece, pieces)])
        edges = segments[0][np.isin(segments[1], pieces)]
        markers[name] = named if len(named) or not len(edges) else edges
    return markers


# ---------------------------------------------------------------------- figures


def _figures(grown: Grown, mesh: DomainMesh, whole: Mesh, above: Rows) -> dict[str, float]:
    """How volumes change at the cap, and the least angle between faces of tetrahedra beyond."""
    last = np.full(len(grown.cap), -1, dtype=np.int64)
    order = np.argsort(grown.layer, kind="stable")
    last[grown.column[order]] = order
    several = np.flatnonzero((last < 0) & ~_bare_columns(grown))  # one cell is below these and the one before
    last[several] = last[np.maximum.accumulate(np.where(last >= 0, np.arange(len(last)), 0))[several]]
    chosen = np.flatnonzero((last >= 0) & (above >= 0))
    figures = {}
    if len(chosen):
        below = whole.volumes[last[chosen]]
        ratio = whole.volumes[len(grown.column) + above[chosen]] / below
        figures = {
            MEDIAN_JUMP: float(np.median(ratio)),
            LARGEST_JUMP: float(np.maximum(ratio, 1 / ratio).max()),
        }
    angles = simplex.quality("min_dihedral", mesh.points[mesh.simplices])
    return figures | {LEAST_BEYOND: float(angles.min())}
