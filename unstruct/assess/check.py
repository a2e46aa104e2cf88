"""The one validator: is a mesh what it claims to be, and if not, which cells and vertices are to blame?

Everything is decided by counting or by exact signs. See the book, chapters 1 and 2.0.
"""

from __future__ import annotations

import numpy as np

from ..base.arguments import as_flag, positive
from ..base.arrays import distinct
from ..base.errors import InputError
from ..base.report import Problem, Report, problem
from ..domain.domain import Domain, as_domain
from ..mesh import topology
from ..mesh.cells import cell_rows
from ..mesh.domain_mesh import DomainMesh
from ..mesh.embedding import RidgeFans, crossing_facets
from ..mesh.manifold import bad_vertex_links, crowded_facets, incoherent_facets, pinched_faces
from ..mesh.mesh import Mesh
from ..mesh.split import simplices_of_cells
from ..predicates.batch import orient_rows
from .body import check_body
from .brute import check_brute
from .covering import check_covering
from .mixed import array_faults, check_mixed, rows_as_triangles
from .pinches import pinch_points
from .region import check_domain
from .spheres import check_spheres
from .surface import check_surface

__all__ = ["Problem", "Report", "check"]

BRUTE_LIMIT = 100_000  # points times cells, up to which the brute-force tests run by default


def check(
    mesh: Mesh,
    *,
    domain: Domain | Mesh | None = None,
    delaunay: bool | str = False,
    brute: bool | None = None,
    deviation: float | None = None,
    sharp: float | None = None,
) -> Report:
    """Examine a mesh.

    Parameters
    ----------
    mesh : Mesh
    domain : Domain or Mesh, optional
        What the mesh claims to fill: every piece must be a chain of edges marked "facets" or "inner" on the
        true curve, the mesh must end at the facets exactly, and vertices, names and regions must agree. In
        space each face of the boundary must lie on a facet; for a mesh from a file its place says on which.
        For triangles in space a surface: the facets of a body in space, or a mesh of triangles.
    delaunay : bool or "constrained", optional
        True: the mesh claims to be a Delaunay triangulation of (the hull of) its points; with weights, their
        regular triangulation. "constrained": of a constrained one; facets named by the mesh's markers are
        then opaque.
    brute : bool, optional
        Whether to add tests of all points against all cells, which share no theorem with the fast ones.
        By default only for small meshes (points times cells up to 100 000).
    deviation : float, optional
        For triangles in space: how far the mesh and the surface may be from each other. Vertices may then be
        off the surface, too; without it they lie on it up to rounding, and the deviation must not exceed
        ``mesh.figures["deviation"]``, if the mesh has that.
    sharp : float, optional
        For triangles in space: the surface has creases, which must be edges of the mesh, where it turns by
        more degrees. By default ``mesh.figures["sharp"]``, or else 40; 180 for none.

    Returns
    -------
    Report
        True when no problem was found. ``problems`` lists `Problem` (kind, text, cells, vertices);
        ``passed`` and ``skipped`` say what was and was not examined.

    Notes
    -----
    Always tested: the arrays; every vertex is used or is a listed duplicate; at most two cells share a facet;
    the neighbors are mutual and correct; the links of vertices (exactly for k <= 3; above, only necessary
    conditions); the orientation is coherent; the Euler characteristic agrees with that of the boundary. Also
    tested if k = d: every cell is positively oriented; the cells around each ridge (vertex in 2D, edge in 3D)
    wind around it once; no cells overlap. For ``delaunay=True`` the boundary must be convex, which together
    with the local tests makes the mesh tile the convex hull. Otherwise the boundary must not meet itself
    (d <= 3), and no boundary vertex may lie in a cell of which it is not a corner.

    For triangles in space and a surface: curves and corners of the surface are chains of edges and vertices;
    as many triangles meet there, in the same directions, as on the surface, and two at all other edges; the
    components of both and their Euler characteristics agree; no two triangles meet but in common vertices
    and edges (exact); all cells face as the surface does; the distances of each from the other, measured at
    samples; names.

    Cells of other kinds in space do not overlap if all Jacobians are positive, the faces of the boundary,
    bilinear ones too, meet in common corners and edges alone, and their outer sides are outside: proved in
    `unstruct.assess.covering`. Bilinear faces that are too near each other to be told apart are problems.

    The Delaunay test looks at each interior facet only: by Delaunay's theorem (1934; Shewchuk, *General-
    dimensional constrained Delaunay and constrained regular triangulations*, 2008) locally empty spheres
    in a triangulation of a convex region, or up to opaque facets, are empty. O(m log m) in total; a million
    points in the plane or a hundred thousand in space take some ten seconds.
    """
    known = isinstance(delaunay, bool | np.bool_) or (isinstance(delaunay, str) and delaunay == "constrained")
    if not known:
        raise InputError(f"delaunay must be False, True or 'constrained', not {delaunay!r}")

    brute = None if brute is None else as_flag(brute, "brute")
    if not isinstance(mesh, Mesh):
        raise InputError(f"mesh must be a Mesh, not {type(mesh).__name__}")
    surface = _on_a_surface(mesh, domain, deviation, sharp)
    report = Report(repr(mesh))
    if not _arrays(mesh, report):
        return report
    _vertices(mesh, report)
    if surface:
        check_surface(mesh, domain, report, deviation, sharp)
        report.skipped += (
            ["the Delaunay property, which needs cells that fill their space"] if delaunay else []
        )
        return report
    domain = domain if domain is None else as_domain(domain, None)
    pinches = np.empty(0, dtype=np.int64) if domain is None else pinch_points(mesh, domain)
    if not mesh.is_simplicial:
        report.skipped += ["the Delaunay property, which needs simplices"] if delaunay else []
        if check_mixed(mesh, report, pinches):
            _by_simplices(mesh, domain, brute, report)
        return report
    valid, manifold = _topology(mesh, report, pinches)
    if not valid:
        report.skipped.append("everything that needs valid adjacency, including the domain")
        return report
    if mesh.dimension < mesh.points.shape[1]:
        _surface(mesh, report)
        report.skipped += ["the domain, which needs a planar mesh"] if domain is not None else []
        return report
    if not _orientation(mesh, report):
        report.skipped.append("overlap, spheres and domain, which need positively oriented cells")
        return report
    if brute is None:
        brute = len(mesh.points) * mesh.size <= BRUTE_LIMIT
    fans = RidgeFans(mesh.points, mesh.simplices, mesh.neighbors) if mesh.dimension > 1 else None
    locally_valid = fans is None or _local_overlap(fans, report)
    if delaunay is True and manifold:
        _hull(mesh, fans, report)
    elif locally_valid:
        _overlap(mesh, report, everything=brute)
    if delaunay:
        check_spheres(mesh, report, opaque=delaunay == "constrained")
    if brute and delaunay is True:
        check_brute(mesh, report)
    if domain is not None:
        (check_domain if domain.dimension == 2 else check_body)(mesh, domain, report)
    return report


def _on_a_surface(mesh: Mesh, domain: object, deviation: float | None, sharp: float | None) -> bool:
    """Whether the mesh is to be compared with a surface; wrong arguments raise an error."""
    surface = domain is not None and mesh.points.shape[1] == 3 and list(mesh.cells) == ["triangle"]
    for name, value in (("deviation", deviation), ("sharp", sharp)):
        if value is not None:
            positive(value, name)
            if not surface:
                raise InputError(f"{name} is for meshes of triangles in space with a surface as domain")
    if sharp is not None and sharp > 180.0:
        raise InputError(f"sharp must be an angle up to 180 degrees, not {sharp!r}")
    return surface


# ---------------------------------------------------------------------- arrays and adjacency


def _arrays(mesh: Mesh, report: Report) -> bool:
    """Test the arrays again: they may have been changed since the mesh was made."""
    finite = np.isfinite(mesh.points).all(axis=1)
    bad = problem("points", "coordinates that are not finite", vertices=np.nonzero(~finite)[0])
    problems = [bad]
    if mesh.is_simplicial:
        rows, n = mesh.simplices, len(mesh.points)
        outside = ((rows < 0) | (rows >= n)).any(axis=1)
        problems.append(problem("index", f"vertices outside 0..{n - 1}", cells=np.nonzero(outside)[0]))
        ordered = np.sort(rows, axis=1)
        repeated = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
        problems.append(problem("repeated vertex", "within one cell", cells=np.nonzero(repeated)[0]))
        if mesh.size == 0:
            problems.append(Problem("empty", "the mesh has no cells"))
    else:
        problems += array_faults(mesh)
    return report.note("arrays: finite points, indices in range, distinct corners", *problems)


def _vertices(mesh: Mesh, report: Report) -> None:
    used = np.zeros(len(mesh.points), dtype=bool)
    used[cell_rows(mesh.cells)[1]] = True
    copies, kept = mesh.duplicates.T
    listed = np.zeros(len(mesh.points), dtype=bool)
    listed[copies] = True
    differ = (mesh.points[copies] != mesh.points[kept]).any(axis=1)
    hidden = np.zeros(len(mesh.points), dtype=bool)
    hidden[mesh.hidden] = True
    wrong = differ | used[copies] | ~(used | hidden)[kept]
    text = "every vertex used, or listed as a duplicate of a used one"
    report.note(
        text if mesh.weights is None else f"{text}, or as hidden",
        problem(
            "unused vertex",
            "in no cell, and not a listed duplicate",
            vertices=np.nonzero(~used & ~listed & ~hidden)[0],
        ),
        problem("hidden vertex", "listed as hidden, but in a cell", vertices=np.nonzero(used & hidden)[0]),
        problem("duplicate", "the copy must be unused and equal to a used vertex", vertices=copies[wrong]),
    )


def _topology(mesh: Mesh, report: Report, pinches: np.ndarray) -> tuple[bool, bool]:
    """Whether the adjacency is valid, and whether the complex is also a manifold.

    At the vertices ``pinches`` the cells may form several fans, because facets of the domain meet there.
    """
    simplices, k, n = mesh.simplices, mesh.dimension, len(mesh.points)
    table = topology.FaceTable(simplices)
    facets, cells = crowded_facets(table)
    crowded = problem("facet", "shared by more than two cells", cells, facets.ravel())
    if not report.note("at most two cells at a facet", crowded):
        return False, False
    neighbors = table.neighbors()
    differ = (neighbors != mesh.neighbors).any(axis=1)
    text = "neighbors do not lie across the facet opposite each vertex"
    wrong = problem("neighbors", text, cells=np.nonzero(differ)[0])
    valid = report.note("neighbors mutual and across the right facets", wrong)
    facets, cells = incoherent_facets(table)
    text = "two cells on the same side of a facet, or with different orientations"
    folded = problem("orientation", text, cells, facets.ravel())
    valid &= report.note("coherent orientation: the two cells of a facet on opposite sides", folded)
    pinched = []
    allowed = False
    for faces, fans in pinched_faces(table, neighbors):
        if len(pinches):
            wrong_ones = ~np.isin(faces, pinches).all(axis=1)
            allowed = not wrong_ones.all()
            faces, fans = faces[wrong_ones], fans[wrong_ones]
        kind = {1: "pinched vertex", 2: "pinched edge"}.get(faces.shape[1], "pinched face")
        text = f"up to {fans.max(initial=0)} separate fans of cells meet there"
        pinched.append(problem(kind, text, vertices=faces.ravel()))
    manifold = report.note("cells around every vertex are connected through facets", *pinched)
    boundary = topology.boundary(simplices, neighbors)
    if manifold and k == 3:
        bad = bad_vertex_links(table, boundary, n)
        allowed |= bool(np.isin(bad, pinches).any())
        bad = np.setdiff1d(bad, pinches)
        manifold = report.note(
            "the link of every vertex is a sphere or a disk",
            problem("link", "the cells around the vertex form neither a ball nor a half-ball", vertices=bad),
        )
    elif k > 3:
        report.skipped.append("whether vertex links are spheres (decided up to dimension 3 only)")
    if manifold and allowed:
        report.skipped.append("the Euler characteristic, where facets of the domain meet at a vertex")
    elif manifold:
        manifold = _euler(table, boundary, report)
    return valid, manifold


def _euler(table: topology.FaceTable, boundary: np.ndarray, report: Report) -> bool:
    """For every compact manifold of dimension k: chi(boundary) = (1 - (-1)^k) chi."""
    k = table.simplices.shape[1] - 1
    inside = sum((-1) ** j * count for j, count in enumerate(table.counts()))
    around = 0
    if len(boundary):
        around = len(np.unique(boundary)) if k == 1 else topology.euler(boundary)
    text = f"{inside} inside and {around} on the boundary contradict each other"
    wrong = None if around == (1 - (-1) ** k) * inside else Problem("Euler characteristic", text)
    return report.note(f"Euler characteristic: {inside}, boundary {around}", wrong)


# ---------------------------------------------------------------------- geometry


def _surface(mesh: Mesh, report: Report) -> None:
    """Test that no cell is flat: its projection to some of the coordinate axes must not be flat."""
    from itertools import combinations

    k, d = mesh.dimension, mesh.points.shape[1]
    flat = np.ones(mesh.size, dtype=bool)
    for axes in combinations(range(d), k):
        rows = np.nonzero(flat)[0]
        flat[rows] = orient_rows(np.ascontiguousarray(mesh.points[:, axes]), mesh.simplices[rows]) == 0
    wrong = problem("flat cell", "its corners lie in a lower dimension", cells=np.nonzero(flat)[0])
    report.note("no flat cell", wrong)
    report.skipped.append("whether the surface meets itself")


def _orientation(mesh: Mesh, report: Report) -> bool:
    signs = orient_rows(mesh.points, mesh.simplices)
    return report.note(
        "every cell positively oriented (exact)",
        problem("negative cell", "turned inside out; Mesh.oriented() corrects it", np.nonzero(signs < 0)[0]),
        problem("flat cell", "its corners lie in a lower dimension", np.nonzero(signs == 0)[0]),
    )


def _local_overlap(fans: RidgeFans, report: Report) -> bool:
    rows = fans.overlaps()
    text = "the cells around a vertex (in space: an edge) wind more than once"
    wrong = problem("overlap", text, fans.cells[rows], fans.ridges[rows].ravel())
    return report.note("cells wind once around every vertex (in space: edge)", wrong)


def _hull(mesh: Mesh, fans: RidgeFans | None, report: Report) -> bool:
    """Whether the mesh tiles the hull of its points: connected and locally convex (Tietze-Nakajima)."""
    count, label = topology.components(mesh.neighbors)
    problems = [None if count == 1 else problem("pieces", f"{count} pieces", np.nonzero(label > 0)[0])]
    if fans is not None:
        rows = fans.concave()
        vertices = np.concatenate(
            [fans.ridges[rows].ravel(), fans.b[rows], fans.a[fans.begin[fans.group[rows]]]]
        )
        problems.append(problem("concave boundary", "an angle above pi", fans.cells[rows], vertices))
    return report.note("in one piece, with a convex boundary: the convex hull is tiled", *problems)


def _overlap(mesh: Mesh, report: Report, *, everything: bool) -> None:
    """Test that the boundary does not meet itself and that no cell contains a vertex that is not its own."""
    d = mesh.points.shape[1]
    if d in (2, 3):
        facets = mesh.facets if everything else mesh.boundary
        pairs = crossing_facets(mesh.points, facets)
        text = "meet in more than a common face"
        wrong = problem("crossing", f"{'facets' if everything else 'boundary facets'} that {text}",
                           vertices=facets[pairs.ravel()].ravel())  # fmt: skip
        report.note(f"no two {'' if everything else 'boundary '}facets cross", wrong)
    elif d > 3:
        report.skipped.append("whether boundary facets cross (decided up to dimension 3 only)")
    vertices = distinct(mesh.simplices if everything or d > 3 else mesh.boundary)
    query, cells = mesh.holding(mesh.points[vertices], vertices)
    wrong = problem("overlap", "cells that contain a vertex of others", cells, vertices[query])
    report.note("no cell contains a vertex that is not its own", wrong)


def _by_simplices(mesh: Mesh, domain: Domain | None, brute: bool | None, report: Report) -> None:
    """Cut cells into simplices and apply to these what is decided for simplices only; report the cells.

    That solids do not overlap is proved without this, whether they can be cut or not.
    """
    if mesh.dimension == 2 and domain is None:
        return
    rows, owner = simplices_of_cells(mesh.cells)
    turned = np.unique(owner[orient_rows(mesh.points, rows) <= 0])
    parts, found = _as_simplices(mesh, rows, owner) if not len(turned) else None, Report(report.title)
    if mesh.dimension == 3 and parts is not None:
        if _local_overlap(RidgeFans(parts.points, parts.simplices, parts.neighbors), found):
            everything = len(mesh.points) * parts.size <= BRUTE_LIMIT if brute is None else brute
            _overlap(parts, found, everything=everything)
    if mesh.dimension == 3 and found:
        check_covering(mesh, report)
    if domain is not None and parts is not None:
        (check_domain if domain.dimension == 2 else check_body)(parts, domain, found)
    elif domain is not None:
        report.skipped.append(
            "the domain, which needs cells that can be cut into positive simplices from their lowest "
            f"vertices; cells {turned[:8].tolist()} cannot ({len(turned)} in all)"
        )
    report.passed += found.passed
    report.skipped += found.skipped
    report.problems += [
        Problem(p.kind, p.text, tuple(np.unique(owner[list(p.cells)]).tolist()), p.vertices)
        for p in found.problems
    ]


def _as_simplices(mesh: Mesh, rows: np.ndarray, owner: np.ndarray) -> DomainMesh:
    """The mesh of these parts of cells, with all that is known of their faces and edges."""
    markers, known = {}, {}
    for name, values in mesh.markers.items():
        if values.ndim == 1:
            markers[name] = values[owner]
        elif values.shape[1] == 4:  # faces of both kinds, padded by -1
            markers[name] = rows_as_triangles(values)[0]
        elif values.shape[1] == 2 or mesh.dimension == 3:
            markers[name] = values
    if isinstance(mesh, DomainMesh):
        known = {name: getattr(mesh, name) for name in ("segments", "piece", "span", "faces", "face_piece")}
        if known["faces"].shape[1] == 4:
            known["faces"], row = rows_as_triangles(known["faces"])
            known["face_piece"] = known["face_piece"][row]
    return DomainMesh(
        mesh.points,
        rows,
        origin=mesh.origin,
        duplicates=mesh.duplicates,
        markers=markers,
        regions=mesh.regions,
        **known,
    )
