"""`unstruct.check` for the mesh of a body in space: is every facet there, in place, and nothing else meshed?

See the book, chapter 2.8b.
"""

from __future__ import annotations

from math import fsum

import numpy as np

from ..base.report import Problem, Report, problem
from ..domain.domain import Domain
from ..domain.space.flat_parts import flat_parts
from ..domain.space.inside import outward
from ..geometry.inside_shell import enclosed_volume, even_odd_in_space, front_inside
from ..geometry.polygons import Polygons
from ..mesh import topology
from ..mesh.domain_mesh import DomainMesh
from ..mesh.grouping import group_rows
from ..mesh.mesh import Mesh
from ..predicates.batch import power_of_two
from .held import with_pieces
from .pinches import OFF_ULPS
from .places import numbered, places_of

__all__ = ["check_body"]

Units = tuple[np.ndarray, np.ndarray]  # the points of the mesh and of the domain, at most 1 in magnitude
AREA_ERROR = 2.0**-30  # areas of facets are sums in doubles; what is missing or doubled is far larger
OFF = OFF_ULPS * 2.0**-53  # in units of the largest coordinate


def check_body(mesh: Mesh, domain: Domain, report: Report) -> None:
    """Compare a mesh of tetrahedra with its domain; the report says what was examined and names the culprits.

    Parameters
    ----------
    mesh : Mesh
        Tetrahedra whose adjacency, orientation and freedom from overlap are tested already. `origin` refers
        to the points of the domain; ``faces`` and ``face_piece`` say which face lies on which piece. Without
        that record, as of a mesh from a file, they are found by their places.
    domain : Domain
        In space.
    report : Report

    Notes
    -----
    The faces on facets must be the boundary. Those of one piece must lie on its triangles, up to 64 times
    2^-53 of the largest coordinate for new vertices, have its area, and end at the sides of the polygon:
    together this says that they cover it once; inner pieces outside of the body have none. Areas and volumes
    must agree up to what vertices that are so far off can change; those of given triangles up to the rounding
    of sums. The volume of the cells must be that enclosed by the faces, and by the facets.

    Facets that lie side by side in one plane and have the same names are the same body as one polygon in
    their place. If some have no faces of their own, they are compared as that.
    """
    found = Report(report.title)
    _compare(mesh, domain, found)
    joined = None if found else _in_flat_parts(mesh, domain)
    if joined is not None:
        other = Report(report.title)
        _compare(*joined, other)
        if other:
            other.passed.append("facets side by side in a plane, with the same names, are covered together")
            found = other
    report.passed += found.passed
    report.skipped += found.skipped
    report.problems += found.problems


def _in_flat_parts(mesh: Mesh, domain: Domain) -> tuple[DomainMesh, Domain] | None:
    """The mesh and its domain where facets without faces are joined with those in their plane, if any are."""
    if domain.dimension != 3 or not mesh.is_simplicial or not isinstance(mesh, DomainMesh):
        return None
    many = len(domain.pieces)
    piece, edge_piece, origin = (np.asarray(rows) for rows in (mesh.face_piece, mesh.piece, mesh.origin))
    known = [0 <= rows.min(initial=0) and rows.max(initial=0) < many for rows in (piece, edge_piece)]
    if len(piece) == 0 or not all(known):
        return None
    bare = np.bincount(piece, minlength=many)[: len(domain.facets)] == 0
    parts = flat_parts(domain, bare) if bare.any() else None
    if parts is None or origin.max(initial=-1) >= len(domain.points):
        return None
    place = np.full(len(domain.points), -1)
    place[parts.vertex] = np.arange(len(parts.vertex))
    joined = DomainMesh(
        mesh.points,
        mesh.simplices,
        origin=np.where(origin >= 0, place[origin], -1).astype(np.int32),
        duplicates=mesh.duplicates,
        markers=mesh.markers,
        regions=mesh.regions,
        segments=mesh.segments,
        piece=parts.group[edge_piece],
        span=mesh.span,
        faces=mesh.faces,
        face_piece=parts.group[piece],
    )
    return joined, Domain(**parts.arguments)


def _compare(mesh: Mesh, domain: Domain, report: Report) -> None:
    if mesh.points.shape[1] != 3 or mesh.dimension != 3 or not mesh.is_simplicial:
        report.note(
            "tetrahedra for a body in space",
            Problem("domain", f"the domain is a body in space, but the mesh is {mesh!r}, not tetrahedra"),
        )
        return
    if not isinstance(mesh, DomainMesh) or not len(mesh.faces):
        mesh = with_pieces(mesh, domain)
    place = places_of(mesh, domain, report)
    if place is None or not _faces_held(mesh, domain, report):
        report.skipped.append("the pieces of the domain, which need valid origins and faces")
        return
    factor = power_of_two(
        domain.points
    )  # squares and cubes of very large or small coordinates are no doubles
    units = mesh.points * factor, domain.points * factor
    _covered(mesh, domain, units, report)
    _segments_held(mesh, domain, place, report)
    _volume(mesh, domain, place, units, report)
    _named_faces(mesh, domain, report)
    numbered(mesh, domain, lambda: _parts(mesh), report)


def _keys(rows: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Equal numbers for equal rows of vertices, in any order."""
    group, _ = group_rows(np.sort(np.concatenate([rows, others]), axis=1))
    return group[: len(rows)], group[len(rows) :]


def _faces_held(mesh: DomainMesh, domain: Domain, report: Report) -> bool:
    """Test that faces are faces, each once; those of facets the boundary, the others inside."""
    bounding = mesh.face_piece < len(domain.facets)
    outside = (mesh.face_piece < 0) | (mesh.face_piece >= len(domain.pieces))
    every, border = topology.faces(mesh.simplices, 2), np.asarray(mesh.boundary)
    own, known = _keys(mesh.faces, every)
    there = np.isin(own, known)
    times = np.bincount(own, minlength=1)[own]
    own, edge = _keys(mesh.faces, border)
    at_border = np.isin(own, edge)
    extra = border[~np.isin(edge, own[bounding])]
    return report.note(
        "the mesh ends exactly at its facets; inner facets lie within",
        problem("piece", "faces of pieces that there are not", vertices=mesh.faces[outside].ravel()),
        problem("face", "that is none of the mesh", vertices=mesh.faces[~there].ravel()),
        problem("twice", "faces on two pieces", vertices=mesh.faces[times > 1].ravel()),
        problem(
            "facet", "faces that do not bound the mesh", vertices=mesh.faces[bounding & ~at_border].ravel()
        ),
        problem("boundary", "the mesh ends at faces that are on no facet", vertices=extra.ravel()),
        problem(
            "inner",
            "faces of inner facets at the boundary",
            vertices=mesh.faces[~bounding & at_border].ravel(),
        ),
    )


# ---------------------------------------------------------------------- the pieces


def _covered(mesh: DomainMesh, domain: Domain, units: Units, report: Report) -> None:
    """Test that the faces of each piece lie on it, end at its sides, and have its area."""
    shell = domain.triangulated
    lifted = mesh.faces[_off(mesh, domain, units) > OFF]
    x = units[1][shell.triangles]
    wanted = np.bincount(shell.piece, _areas(x), minlength=len(domain.pieces))
    found = np.bincount(mesh.face_piece, _areas(units[0][mesh.faces]), minlength=len(domain.pieces))
    extent = np.zeros(len(domain.pieces))
    np.maximum.at(extent, shell.piece, np.abs(x - x[:, :1]).max(axis=(1, 2)) ** 2)
    beyond = _beyond(mesh, shell.triangles, shell.piece, domain)
    wanted[beyond] = 0.0
    moved = _moved(mesh, units[0], len(domain.pieces))
    bare = np.bincount(mesh.face_piece, minlength=len(domain.pieces)) == 0
    bare[beyond] = bare[shell.segment_piece] = False
    differ = np.abs(found - wanted) > AREA_ERROR * np.maximum(extent, wanted) + OFF * moved
    wrong = np.flatnonzero(differ | bare)
    astray = _astray(mesh, domain, units)
    report.note(
        f"each piece is covered by its faces, up to {OFF_ULPS} units of rounding of new vertices",
        problem("off the facet", "new vertices that are not on their piece", vertices=lifted),
        Problem("facet", f"pieces {wrong[:8].tolist()} are not covered once: the areas differ")
        if len(wrong)
        else None,
        problem("side", "edges where the faces of a piece end inside of it", vertices=astray.ravel()),
    )


def _beyond(mesh: DomainMesh, corners: np.ndarray, piece: np.ndarray, domain: Domain) -> np.ndarray:
    """The inner pieces that lie outside of the body, by the middle of one of their parts.

    Inner pieces cross no facet, so that one point tells where the whole piece is.
    """
    number, first = np.unique(piece, return_index=True)
    first = first[number >= len(domain.facets)]
    if len(domain.facets) == 0 or len(first) == 0:
        return piece[:0]
    middle = domain.points[corners[first]].mean(axis=1)
    odd, on = even_odd_in_space(mesh.points, np.asarray(mesh.boundary), middle)
    return piece[first[~odd & ~on]]


def _moved(mesh: DomainMesh, points: np.ndarray, many: int) -> np.ndarray:
    """By how much the area of the faces of each piece grows for each unit that new vertices are off."""
    x = points[mesh.faces]
    around = np.zeros(len(x))
    for k in range(3):
        around += np.sqrt(((x[:, k] - x[:, k - 1]) ** 2).sum(axis=1))
    new = (np.asarray(mesh.origin)[mesh.faces] < 0).any(axis=1)
    return np.bincount(mesh.face_piece[new], around[new], minlength=many)


def _areas(x: np.ndarray) -> np.ndarray:
    """The areas of triangles (t, 3, 3)."""
    return np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1) / 2


def _off(mesh: DomainMesh, domain: Domain, units: Units) -> np.ndarray:
    """How far the new vertices of each face, (f, 3), are from the planes of the triangles of its piece.

    Vertices of the domain are judged by the sides at which the faces end.
    """
    shell = domain.triangulated
    start = np.searchsorted(shell.piece, np.arange(len(domain.pieces) + 1))
    count = np.diff(start)
    new = np.asarray(mesh.origin)[mesh.faces] < 0
    rows = np.flatnonzero(new.any(axis=1))
    pairs = np.repeat(rows, count[mesh.face_piece[rows]])
    ahead = np.cumsum(count[mesh.face_piece[rows]]) - count[mesh.face_piece[rows]]
    step = np.arange(len(pairs)) - np.repeat(ahead, count[mesh.face_piece[rows]])
    corners = _longest_first(units[1][shell.triangles])[start[mesh.face_piece[pairs]] + step]
    along = corners[:, 1] - corners[:, 0]
    normal = np.cross(along, corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0, length, 1.0)[:, None]
    # The normal of a needle is rounded: seen from the foot on its longest side, its vertices are so near
    # that this does not matter.
    x = units[0][mesh.faces[pairs]]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    share = ((x - corners[:, :1]) * along[:, None]).sum(axis=2) / square[:, None]
    foot = corners[:, :1] + share[..., None] * along[:, None]
    away = np.abs(((x - foot) * unit[:, None]).sum(axis=2))
    nearest = np.full((len(mesh.faces), 3), np.inf)
    np.minimum.at(nearest, pairs, away)
    return np.where(new, nearest, 0.0)


def _longest_first(x: np.ndarray) -> np.ndarray:
    """Triangles (t, 3, 3) whose corners are turned so that the longest side is that of the first two."""
    square = np.stack([((x[:, (k + 1) % 3] - x[:, k]) ** 2).sum(axis=1) for k in range(3)], axis=1)
    turn = square.argmax(axis=1)
    return np.take_along_axis(x, ((turn[:, None] + np.arange(3)) % 3)[..., None], axis=1)


def _astray(mesh: DomainMesh, domain: Domain, units: Units) -> np.ndarray:
    """Edges where the faces of a piece end that lie on no side of its polygon."""
    ends = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    piece = np.tile(mesh.face_piece, 3)
    group, _ = group_rows(np.column_stack([np.sort(ends, axis=1), piece]))
    once = np.bincount(group)[group] % 2 == 1
    ends, piece = ends[once], piece[once]
    polygons: Polygons = domain.pieces
    sides, owner = polygons.sides
    order = np.argsort(owner, kind="stable")
    start = np.searchsorted(owner[order], np.arange(len(polygons) + 1))
    count = np.diff(start)[piece]
    pairs = np.repeat(np.arange(len(ends)), count)
    step = np.arange(len(pairs)) - np.repeat(np.cumsum(count) - count, count)
    side = units[1][sides[order[start[piece[pairs]] + step]]]
    x = units[0][ends[pairs]]
    along = side[:, 1] - side[:, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    share = ((x - side[:, :1]) * along[:, None]).sum(axis=2) / square[:, None]
    foot = side[:, :1] + np.clip(share, 0.0, 1.0)[..., None] * along[:, None]
    near = np.linalg.norm(x - foot, axis=2).max(axis=1) <= OFF
    on = np.zeros(len(ends), dtype=bool)
    on[pairs[near]] = True
    return ends[~on]


def _segments_held(mesh: DomainMesh, domain: Domain, place: np.ndarray, report: Report) -> None:
    """Test that inner segments are chains of edges of the mesh."""
    shell = domain.triangulated
    if len(shell.segments) == 0:
        return
    ends, piece = np.asarray(mesh.segments), np.asarray(mesh.piece)
    own, known = _keys(ends, topology.faces(mesh.simplices, 1))
    beyond = _beyond(mesh, shell.segments, shell.segment_piece, domain).tolist()
    missing = [int(i) for i in shell.segment_piece if not (piece == i).any() and i not in beyond]
    text = f"inner segments without an edge in the mesh: {missing[:8]}"
    loose = []
    for row, i in zip(shell.segments, shell.segment_piece.tolist()):
        if i in beyond:
            continue
        odd = np.flatnonzero(np.bincount(ends[piece == i].ravel(), minlength=len(mesh.points)) % 2)
        if sorted(odd.tolist()) != sorted(place[row].tolist()):
            loose.append(i)
    report.note(
        "inner segments are chains of edges",
        Problem("segment", text) if missing else None,
        problem(
            "edge", "segments that are no edges of the mesh", vertices=ends[~np.isin(own, known)].ravel()
        ),
        Problem("segment", f"inner segments {loose[:8]} are not connected from end to end")
        if loose
        else None,
    )


# ---------------------------------------------------------------------- inside and outside


def _volume(mesh: DomainMesh, domain: Domain, place: np.ndarray, units: Units, report: Report) -> None:
    """Test that the mesh fills what the facets enclose (even-odd) and uses the loose vertices in it."""
    if len(domain.facets) == 0:
        report.skipped.append("volume and loose vertices of a domain without facets")
        return
    points, shell = units[0], domain.triangulated
    border = np.asarray(mesh.boundary)
    inside = front_inside(mesh.points, border)
    ends = enclosed_volume(points, border)
    wanted = enclosed_volume(units[1], outward(shell))
    # Given triangles are held exactly. Else the volume changes by what the faces move, times their area.
    new = (np.asarray(mesh.origin)[border] < 0).any(axis=1)
    cut = (domain.pieces.corners > 3)[mesh.face_piece]
    own, cut = _keys(border, mesh.faces[cut])
    slack = OFF * float(_areas(points[border[new | np.isin(own, cut)]]).sum()) + 2.0**-50 * abs(wanted)
    volumes, error = _six_volumes(points[mesh.simplices])
    filled, text = fsum(volumes.tolist()) / 6, None
    if abs(ends - wanted) > slack:
        text = f"the mesh ends around {ends:.17g}, the facets enclose {wanted:.17g} (even-odd)"
    elif abs(filled - ends) > error + 2.0**-50 * abs(ends):
        text = f"the cells fill {filled:.17g}, the faces enclose {ends:.17g} (even-odd)"
    report.note(
        "the mesh fills what the facets enclose by the even-odd rule",
        Problem("volume", text) if text else None,
        problem("inside out", "faces with the mesh on their outer side", vertices=border[inside].ravel()),
    )
    loose = np.asarray(domain.loose)
    odd, on = even_odd_in_space(mesh.points, border, domain.points[loose])
    there = place[loose] >= 0
    lost, extra = loose[odd & ~on & ~there], loose[~odd & ~on & there]
    text = f"loose vertices of the domain that are not in the mesh: {lost[:8].tolist()}"
    report.note(
        "loose vertices inside are vertices of the mesh",
        Problem("missing vertex", text) if len(lost) else None,
        problem("outer vertex", "loose vertices that lie outside", vertices=place[extra]),
    )


def _named_faces(mesh: DomainMesh, domain: Domain, report: Report) -> None:
    """Test that each marker of the domain contains the faces of its pieces, and no others."""
    wrong: list[Problem | None] = []
    for name, pieces in domain.markers.items():
        rows = np.asarray(mesh.markers.get(name, ()))
        wanted = mesh.faces[np.isin(mesh.face_piece, pieces)]
        if len(wanted) == 0 and rows.ndim == 2 and rows.shape[1] == 2:
            wanted = np.asarray(mesh.segments)[np.isin(mesh.piece, pieces)]
        if name not in mesh.markers:
            wrong.append(Problem("marker", f"the mesh has no marker {name!r}"))
        elif rows.ndim != 2 or rows.shape[1] != wanted.shape[1]:
            wrong.append(Problem("marker", f"marker {name!r} has no rows of {wanted.shape[1]} vertices"))
        else:
            one, two = _keys(rows, wanted)
            differ = np.concatenate([rows[~np.isin(one, two)], wanted[~np.isin(two, one)]])
            text = f"marker {name!r} does not contain exactly the faces of its pieces"
            wrong.append(problem("marker", text, vertices=differ.ravel()))
    if domain.markers:
        report.note("named faces are those of the named pieces", *wrong)


def _parts(mesh: DomainMesh) -> np.ndarray:
    """The part of each cell, if the faces on pieces divide the mesh."""
    rows = mesh.simplices[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3)
    own, wall = _keys(rows, mesh.faces)
    neighbors = np.array(mesh.neighbors)
    neighbors[np.isin(own, wall).reshape(-1, 4)] = -1
    return topology.components(neighbors)[1]


def _six_volumes(x: np.ndarray) -> tuple[np.ndarray, float]:
    """Six times the volumes of cells (m, 4, 3), and how much their sum may err by rounding."""
    u, v, w = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], x[:, 3] - x[:, 0]
    most = np.abs(u).max(axis=1) * np.abs(v).max(axis=1) * np.abs(w).max(axis=1)
    return (u * np.cross(v, w)).sum(axis=1), 12 * 2.0**-50 * float(most.sum())
