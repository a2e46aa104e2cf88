"""isosurface_stuffing: tetrahedra with bounded dihedral angles in what a function or a surface bounds.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flag, finite, positive
from ...base.errors import InputError
from ...domain.domain import Domain, as_domain
from ...geometry.segment_tree import SegmentTree
from ...geometry.triangle_tree import TriangleTree
from ...mesh import topology
from ...mesh.domain_mesh import DomainMesh, noticed
from ...mesh.mesh import Mesh
from ...predicates.batch import power_of_two
from ...sizing.field import SizeField, as_size
from ..tree.growing import MOST_LEAVES, as_box
from .account import lost_or_filled
from .creases import creases_of, with_creases
from .dividing import NOTHING_INSIDE, filled_leaves
from .ending import boundary_faces, overlapping_cells, pinched_vertices
from .filling import Filling
from .laying import Laid, laid_in_level_set
from .raising import LARGEST_COSINE, survey_pieces
from .rounds_of_raising import Background
from .sampling import LevelSet
from .surfaces import laid_in_surface

__all__ = ["isosurface_stuffing"]

ZERO_TOLERANCE = 1e-10  # of the zeros on edges, as a share of the edge
CELL_GROWTH = 0.4  # of the size of cells from places of the surface, per length
MOST_COORDINATE = 2.0**128  # its fourth power and that of its inverse are doubles, with much room
PINCHED = "the boundary touches itself here: the body, or the gap beside it, is thinner than a cell"
CELLS_OVERLAP = "cells overlap here: a gap or a bubble is thinner than a cell; take a smaller size"
TOO_COARSE = "the size is smaller here than the cells along the surface; graded=True follows it"
ANGLE_NOT_RAISED = "a dihedral angle is below 10 or above 165 degrees here; improve may make it better"
POOR_STRIP = "a dihedral angle is below 10 or above 165 degrees here, in the strip along a sharp edge"
LOST_CREASE = "a sharp edge is not kept here: the strip along it could not be filled; try another size"


def isosurface_stuffing(
    body: Any,
    size: Any,
    *,
    box: ArrayLike | None = None,
    cap: bool = False,
    graded: bool = False,
    features: float | None = None,
    tolerance: float | None = ZERO_TOLERANCE,
    budget: int = MOST_LEAVES,
    progress: bool = False,
) -> DomainMesh:
    """Fill what a function or a closed surface bounds with tetrahedra whose dihedral angles are bounded.

    Parameters
    ----------
    body : callable, Domain in space, or Mesh of triangles that close
        A function takes points (k, 3) and returns k finite numbers, positive inside, negative outside, zero
        on the surface only; it needs a `box`.
    size : number, function (k, 3) -> (k,), or size field
        The long edges of the lattice; the short ones are sqrt(3)/2 as long. All cells along the surface have
        one size, the smallest that is asked for in the body or near it; those inside become larger, by
        factors of two, as the size allows.
    box : array_like, shape (2, 3), optional
        For a function: two opposite corners of the box in which the body lies. The function is never asked
        outside of it, and must not be positive at its sides, unless `cap` is set. By default ``body.box``,
        which the bodies of `examples` have.
    cap : bool
        Whether the body ends at the sides of the box, where the function is positive there. Cells are flat
        there if the box has a whole number of them along each axis; otherwise its edges are cut off.
    graded : bool
        Whether cells along the surface follow the size, too. Their angles are then measured, not proved;
        cells with angles below 10 or above 165 degrees are made better where that can be done; for that,
        some leaves become as small as others beside them.
    features : float, optional
        For a surface that is flat between its sharp edges, up to 1e-6 of its extent, as of a file in single
        precision: degrees. Edges at which the normals of facets differ by at least so much are kept: each is
        a chain of edges of the mesh, from corner to corner. Triangles that are so thin that single precision
        can turn their normals by the angle do not decide.
    tolerance : float or None
        For a function: to what share of an edge zeros are found. None: those of the linear interpolation
        between the ends of the edge are taken.
    budget : int
        The largest number of leaves of the octree, and of cells of the lattice in the box of a function.
    progress : bool

    Returns
    -------
    DomainMesh
        ``counts`` has the numbers of vertices that were "moved" onto the surface, of "cut points", of those
        "raised", which moved because of angles, of leaves "divided" because of them, of "values" of the
        function, and of "pinched" vertices; with `features`, of the cells of the "strip", which are the last
        ones, and of parts "on creases". For a surface, ``figures`` has the largest
        distance of a place of it from the mesh, "cells missed". For a Domain, ``markers`` has for each of its
        names the faces that are nearest to facets of that name, and "region" the number of each cell if
        regions have names. ``unrefined`` has cells where the boundary touches itself, cells next to which a
        part of the body is lost, or a gap filled, by more than 0.8 of a cell, and one for each component of
        the surface beside which the boundary is not connected as it is (by components and Euler
        characteristic: a lost cavity, a filled tunnel), cells larger than wanted, and those of graded
        surfaces and of the strip with angles below 10 or above 165 degrees; ``reasons`` tell the place.

    Raises
    ------
    InputError
        For other arguments; if the function raises an error, or returns anything but finite numbers; if it is
        positive at the sides of the box, or exactly 0 in whole cells beside the body, as functions are that
        are 1 inside and 0 outside; if nothing is inside, or the budget is exceeded; with `features`, if the
        surface is not flat between sharp edges.
    DomainError
        For a Mesh that is no closed surface.

    Notes
    -----
    With one size along the surface all dihedral angles are between 10.7 and 164.8 degrees, whatever the body:
    `studies.stuffing_bounds` proves it by intervals. In smooth bodies that are much larger than the size they
    are between 15 and 152 degrees. For graded surfaces nothing is proved. Where levels meet at the
    surface, vertices move until angles are between 10 and 165 degrees: those on it to other cut points, those
    inside anywhere, and, where the surface is a disc, onto it or off it. Where that fails, the larger leaves
    around are divided, and all begins anew, up to four times, if the budget allows. In 440 rough bodies with
    steep sizes and parts as thin as a cell, of 15 million cells in all, no angle is then below 10 or above
    165 degrees; leaves were divided in five of them. What might remain is listed; ``improve(mesh)`` may raise
    it, and keeps the boundary.

    With `features` the cells within one cell of sharp edges are taken out. What is left between the others
    and the surface is a body of its own. Its flat sides are divided by `voronoi_segment`, with the creases
    cut at the size, and `tetrahedralize` fills it. The size there is that of the cells beside the strip,
    which are as small everywhere as anywhere on the surface, unless they are graded; then the strip is 1.4 of
    them wide. The other cells keep the angles of the theorem. Those in the strip are measured: in 401 turned
    boxes, prisms of five to eight sides and wedges of 20 to 90 degrees, with constant sizes and sizes that
    grow by up to 1.2 of a length, angles are from 12.4 to 157.8 degrees. With ``graded=True`` they are from
    11 to 162 degrees in 280 of 281 such bodies; in the other one, of the steepest sizes, the strip could not
    be filled. Cells with angles below 10 or above 165 degrees, as there must be in sharper wedges, are in
    ``unrefined``, and so are those along a strip that is not filled.
    Then the mesh has exactly the volume of the body, up to rounding, and to how far its sides are from flat.
    Edges within flat sides are not kept: where those are given in triangles, each side is a union of faces in
    its plane, which ``check(mesh, domain=body.simplified())`` tests. In single precision sides are in no
    plane, by more than the 64 units of rounding that `check` allows; `check(mesh)` is for any body.

    Vertices on the boundary are on the surface up to the tolerance, or, for surfaces of triangles, up to
    rounding; the boundary's faces are chords. So creases and corners are cut off, by less than a cell.
    Whether a vertex of the lattice is inside of a surface, outside or on it is decided exactly. Only what the
    vertices of the lattice see is there: where the body or a gap is thinner than a cell, it may be lacking,
    or the boundary may touch itself. For surfaces all this is found; a function may have parts between all
    places at which it is asked. Each vertex of the lattice is asked once, in calls of up to 262,144 points,
    and once more each time that leaves are divided because of angles.

    In another unit of length that is a power of two times as long, the mesh is the same bit for bit, and so
    it is for values of a function that are multiplied by one. For other factors these are rounded in another
    way: zeros then differ by up to the tolerance, and a vertex of the lattice that is on the surface but for
    rounding may be inside, outside or on it.

    O(n log n) for n leaves. Source: F. Labelle, J. R. Shewchuk, *Isosurface stuffing: fast tetrahedral meshes
    with good dihedral angles*, ACM Trans. Graph. 26(3), 2007: the stencils and the parity rule are theirs. Of
    the shares of edges within which vertices move, those with the largest least angle are taken. Book: 4c.
    """
    field, budget = as_size(size), as_count(budget, "budget")
    graded, progress, cap = as_flag(graded, "graded"), as_flag(progress, "progress"), as_flag(cap, "cap")
    if tolerance is not None:
        tolerance = positive(tolerance, "tolerance")
    if features is not None:
        features = finite(features, "features")
    if isinstance(body, Mesh) and body.points.shape[1] == 3 and body.dimension == 2:
        body = Domain.surface(body)
    limits = (budget, progress)
    if isinstance(body, Domain):
        body = as_domain(body, 3)
        if box is not None:
            raise InputError("a box goes with a function; a surface has its own")
        if len(body.inner):
            raise InputError("inner pieces are not kept by stuffing; use tetrahedralize, or leave them out")
        if features is not None and not 0.0 < features < 180.0:
            raise InputError(f"features = {features} must be an angle between 0 and 180 degrees")
        laid, made = _made(laid_in_surface(body, field, graded, limits), budget)
        if features is not None:
            made = _with_creases(made, body, features, laid, progress)
        return noticed(_finished(laid, made, body, 0))
    if features is not None:
        raise InputError("features are kept of a surface: give a Domain in space or a Mesh of triangles")
    if not callable(body):
        raise InputError(
            f"a function, a Domain in space or a Mesh of triangles is needed, not {type(body).__name__}"
        )
    box = getattr(body, "box", None) if box is None else box
    if box is None:
        raise InputError("a function needs a box: two opposite corners of a box around the body")
    level_set = LevelSet(body, as_box(box, 3), cap)
    laid, made = _made(laid_in_level_set(level_set, field, graded, tolerance, limits), budget)
    return noticed(_finished(laid, made, None, level_set.called))


class Made(NamedTuple):
    """Vertices, cells, the points of the domain among the vertices, reasons by cell, and counts."""

    points: NDArray[np.float64]
    cells: NDArray[np.int32]
    on_surface: NDArray[np.bool_]
    origin: NDArray[np.int32]
    reasons: dict[int, str]
    counts: dict[str, int]


def _made(laid: Laid, budget: int) -> tuple[Laid, Made]:
    """What is stuffed, and over which tree."""
    before = laid.tree.divided
    laid, background, filling = filled_leaves(laid, budget)
    if not len(filling.cells):
        raise InputError(NOTHING_INSIDE)
    poor = dict.fromkeys(filling.poor.tolist(), ANGLE_NOT_RAISED)
    return laid, Made(
        filling.points,
        filling.cells,
        filling.on_surface,
        np.full(len(filling.points), -1, dtype=np.int32),
        poor | _too_coarse(laid, background, filling),
        {
            "moved": filling.moved,
            "cut points": filling.cut,
            "raised": filling.raised,
            "divided": laid.tree.divided - before,
        },
    )


def _with_creases(made: Made, domain: Domain, angle: float, laid: Laid, progress: bool) -> Made:
    """The same with the sharp edges of a domain."""
    cell, field, unit = float(laid.grid.side[0]) * 0.5**laid.grid.depth, _size_of_strip(laid), 1.0
    if (
        not 1.0 / MOST_COORDINATE <= float(np.abs(domain.points).max()) <= MOST_COORDINATE
    ):  # volumes would not be doubles
        unit = power_of_two(domain.points)
        domain = Domain(domain.points * unit, domain.facets)
        field = _in_unit(field, unit)
    creases = creases_of(domain, angle, field)
    mesh = (made.points * unit, made.cells, made.on_surface)
    filled, gone = with_creases(domain, creases, mesh, (field, cell * unit), progress)
    if filled is None:
        reasons = made.reasons | dict.fromkeys(np.flatnonzero(gone).tolist(), LOST_CREASE)
        return made._replace(reasons=reasons)
    rank = np.cumsum(~gone) - 1
    on_surface = np.zeros(len(filled.points), dtype=bool)
    everywhere = np.ones(len(filled.points), dtype=bool)
    on_surface[boundary_faces(filled.cells, everywhere)[0].ravel()] = True
    strip = np.flatnonzero(filled.strip)
    bad = np.empty(len(strip))
    survey_pieces(filled.points, filled.cells[strip], bad)
    reasons = {int(rank[row]): why for row, why in made.reasons.items() if not gone[row]}
    return Made(
        filled.points / unit,
        filled.cells,
        on_surface,
        filled.origin,
        reasons | dict.fromkeys(strip[bad >= LARGEST_COSINE].tolist(), POOR_STRIP),
        made.counts | {"strip": int(filled.strip.sum()), "on creases": len(creases.segments)},
    )


def _size_of_strip(laid: Laid) -> SizeField:
    """The size along creases: that of the cells beside them, since the strip is one of them wide.

    Where the size is larger than the cells along the surface, which are as small as anywhere on it, cells of
    the strip with such edges would be flat.
    """
    if laid.field.constant is not None or laid.samples is None:
        return laid.field
    x, side = laid.samples
    if (side == side[0]).all():
        return as_size(float(side[0]))
    tree = SegmentTree(x, side)
    return as_size(lambda y: tree.least(y, CELL_GROWTH, laid.field(y))[0])


def _in_unit(field: SizeField, unit: float) -> SizeField:
    """The same size in another unit of length."""
    if field.constant is not None:
        return as_size(field.constant * unit)
    return as_size(lambda x: field(x / unit) * unit)


def _finished(laid: Laid, made: Made, domain: Domain | None, called: int) -> DomainMesh:
    """The mesh, with names and an account of what is not as asked for."""
    faces, cell = boundary_faces(made.cells, made.on_surface)
    pinched = pinched_vertices(faces, len(made.points))
    reasons = dict(made.reasons)
    for row in cell[np.isin(faces, pinched).any(axis=1)].tolist():
        reasons[row] = PINCHED
    for row in overlapping_cells(made.points, made.cells, made.on_surface).tolist():
        reasons[row] = CELLS_OVERLAP
    figures = {}
    if laid.samples is not None and domain is not None:
        shell = domain.triangulated
        surface, mesh = (shell.points, shell.bounding), (made.points, faces, cell)
        lost, figures["cells missed"] = lost_or_filled(laid.samples, surface, mesh, "cell")
        reasons |= lost
    rows = sorted(reasons)
    markers, regions = _names(domain, made, faces)
    return DomainMesh(
        made.points,
        made.cells,
        origin=made.origin,
        markers=markers,
        regions=regions,
        unrefined=np.array(rows, dtype=np.int32) if rows else None,
        reasons=[reasons[row] for row in rows] if rows else None,
        counts=made.counts | {"pinched": len(pinched), "values": called},
        figures=figures,
    )


def _too_coarse(laid: Laid, background: Background, filling: Filling) -> dict[int, str]:
    """The cells in leaves that the size would have divided; their background begins with the leaf's
    center."""
    if not len(laid.refused):
        return {}
    leaf = background.cells[filling.owner, 0] - (len(background.points) - len(laid.grid.first))
    return dict.fromkeys(np.flatnonzero(np.isin(leaf, laid.refused)).tolist(), TOO_COARSE)


def _names(
    domain: Domain | None, filling: Made, faces: NDArray[np.int32]
) -> tuple[dict[str, NDArray[Any]], dict[str, int]]:
    """Markers of boundary faces by the nearest facets, and the regions of cells by the seeds in them."""
    if domain is None:
        return {}, {}
    markers: dict[str, NDArray[Any]] = {}
    if domain.markers:
        shell = domain.triangulated
        which, _ = TriangleTree(shell.points[shell.bounding]).nearest(filling.points[faces].mean(axis=1))
        piece = shell.piece[shell.piece < shell.facets][which]
        markers = {name: faces[np.isin(piece, rows)] for name, rows in domain.markers.items()}
    if not domain.regions:
        return markers, {}
    bare = Mesh(filling.points, filling.cells)
    _, part = topology.components(np.asarray(bare.neighbors))
    region = np.full(len(filling.cells), -1, dtype=np.int32)
    for k, seeds in enumerate(domain.regions.values()):
        cells = bare.find_simplex(seeds)
        region[np.isin(part, part[cells[cells >= 0]])] = k
    rest = np.unique(part[region < 0], return_inverse=True)[1]
    region[region < 0] = len(domain.regions) + rest
    return {**markers, "region": region}, {name: k for k, name in enumerate(domain.regions)}
