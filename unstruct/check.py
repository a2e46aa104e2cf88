"""The one validator: is a mesh what it claims to be, and if not, which cells and vertices are to blame?

Everything is decided by counting or by exact signs. See the book, chapters 1 and 2.0.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from . import topology
from .embedding import RidgeFans, crossing_facets, orient_rows
from .errors import InputError
from .manifold import bad_vertex_links, crowded_facets, incoherent_facets, pinched_faces
from .predicates import in_sphere, orient

if TYPE_CHECKING:
    from .mesh import Mesh

__all__ = ["Problem", "Report", "boundary_is_convex", "check"]

CHUNK = 1 << 19
SMALL = 100_000  # points times cells, up to which the brute-force tests run by default


@dataclass(frozen=True)
class Problem:
    """One kind of defect, and the cells and vertices that have it."""

    kind: str
    text: str
    cells: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()

    def __str__(self) -> str:
        parts = [f"{self.kind}: {self.text}"]
        parts += [f"cells {_few(self.cells)}"] if self.cells else []
        parts += [f"vertices {_few(self.vertices)}"] if self.vertices else []
        return "; ".join(parts)


@dataclass
class Report:
    """What `check` found. True when all is well; ``problems`` names the culprits when not."""

    title: str
    problems: list[Problem] = field(default_factory=list)
    passed: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return not self.problems

    def __str__(self) -> str:
        lines = [f"{'well' if self else 'NOT WELL'}: {self.title}"]
        lines += [f"  problem  {problem}" for problem in self.problems]
        lines += [f"  checked  {name}" for name in self.passed]
        lines += [f"  skipped  {name}" for name in self.skipped]
        return "\n".join(lines)

    __repr__ = __str__

    def note(self, name: str, *problems: Problem | None) -> bool:
        """Record a test by its name, or the problems it found; tell whether there were none."""
        found = [problem for problem in problems if problem is not None]
        self.problems += found
        if not found:
            self.passed.append(name)
        return not found


def _few(numbers: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, numbers[:8]))
    return shown if len(numbers) <= 8 else f"{shown}, ... ({len(numbers)} in all)"


def _problem(kind: str, text: str, cells: Iterable = (), vertices: Iterable = ()) -> Problem | None:
    """A problem with these culprits; None when there are none."""
    cells, vertices = (
        tuple(np.unique(np.asarray(list(v), dtype=np.int64)).tolist()) for v in (cells, vertices)
    )
    return Problem(kind, text, cells, vertices) if cells or vertices else None


def check(mesh: Mesh, *, delaunay: bool | str = False, brute: bool | None = None) -> Report:
    """Examine a mesh.

    Parameters
    ----------
    mesh : Mesh
    delaunay : bool or "constrained", optional
        True: the mesh claims to be a Delaunay triangulation of (the hull of) its points. "constrained": of
        a constrained one; facets named by the mesh's markers are then opaque.
    brute : bool, optional
        Whether to add tests of all points against all cells, which share no theorem with the fast ones.
        By default only for small meshes (points times cells up to 100 000).

    Returns
    -------
    Report
        True when no problem was found. ``problems`` lists `Problem` (kind, text, cells, vertices);
        ``passed`` and ``skipped`` say what was and was not examined.

    Notes
    -----
    Always: arrays; every vertex used or a listed duplicate; at most two cells at a facet; neighbors mutual
    and right; links of vertices (exact for k <= 3; necessary conditions above); coherent orientation; the
    Euler characteristic against the boundary's. With k = d also: every cell positively oriented; cells
    around each ridge (vertex in 2D, edge in 3D) wind once; and no overlap: for ``delaunay=True`` the
    boundary must be convex, which together with the local tests makes the mesh tile the convex hull; else
    the boundary must not meet itself (d <= 3) and no boundary vertex may lie in a foreign cell.

    The Delaunay test looks at each interior facet only: by Delaunay's theorem (1934; Shewchuk, *General-
    dimensional constrained Delaunay and constrained regular triangulations*, 2008) locally empty spheres
    in a triangulation of a convex region, or up to opaque facets, are empty. O(m log m) in all; a million
    points in the plane or a hundred thousand in space take some ten seconds.
    """
    if delaunay not in (False, True, "constrained"):
        raise InputError(f"delaunay must be False, True or 'constrained', not {delaunay!r}")
    report = Report(repr(mesh))
    if not _arrays(mesh, report):
        return report
    if not mesh.is_simplicial:
        from .check_cells import check_mixed

        check_mixed(mesh, report)
        return report
    _vertices(mesh, report)
    if not _topology(mesh, report):
        report.skipped.append("everything that needs sound adjacency")
        return report
    if mesh.dimension < mesh.points.shape[1]:
        _surface(mesh, report)
        return report
    if not _orientation(mesh, report):
        report.skipped.append("overlap and spheres, which need positively oriented cells")
        return report
    if brute is None:
        brute = len(mesh.points) * mesh.size <= SMALL
    fans = RidgeFans(mesh.points, mesh.simplices, mesh.neighbors) if mesh.dimension > 1 else None
    locally_well = fans is None or _local_overlap(fans, report)
    if delaunay is True:
        _hull(mesh, fans, report)
    elif locally_well:
        _overlap(mesh, report, everything=brute)
    if delaunay:
        _spheres(mesh, report, opaque=delaunay == "constrained")
    if brute and delaunay is True:
        _brute(mesh, report)
    return report


def boundary_is_convex(mesh: Mesh) -> bool:
    """Whether the mesh tiles the convex hull of its points, by exact signs (its adjacency is trusted)."""
    used = len(np.unique(mesh.simplices)) + len(mesh.duplicates)
    if mesh.size == 0 or used < len(mesh.points) or (orient_rows(mesh.points, mesh.simplices) <= 0).any():
        return False
    report = Report("")
    fans = RidgeFans(mesh.points, mesh.simplices, mesh.neighbors) if mesh.dimension > 1 else None
    well = fans is None or _local_overlap(fans, report)
    return well and _hull(mesh, fans, report)


# ---------------------------------------------------------------------- arrays and adjacency


def _arrays(mesh: Mesh, report: Report) -> bool:
    """The arrays may have been written to since the mesh was made."""
    finite = np.isfinite(mesh.points).all(axis=1)
    bad = _problem("points", "coordinates that are not finite", vertices=np.nonzero(~finite)[0])
    problems = [bad]
    if mesh.is_simplicial:
        rows, n = mesh.simplices, len(mesh.points)
        outside = ((rows < 0) | (rows >= n)).any(axis=1)
        problems.append(_problem("index", f"vertices outside 0..{n - 1}", cells=np.nonzero(outside)[0]))
        ordered = np.sort(rows, axis=1)
        repeated = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
        problems.append(_problem("repeated vertex", "within one cell", cells=np.nonzero(repeated)[0]))
        if mesh.size == 0:
            problems.append(Problem("empty", "the mesh has no cells"))
    return report.note("arrays: finite points, indices in range, distinct corners", *problems)


def _vertices(mesh: Mesh, report: Report) -> None:
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.simplices.ravel()] = True
    copies, kept = mesh.duplicates.T
    listed = np.zeros(len(mesh.points), dtype=bool)
    listed[copies] = True
    differ = (mesh.points[copies] != mesh.points[kept]).any(axis=1)
    wrong = differ | used[copies] | ~used[kept]
    report.note(
        "every vertex used, or listed as a duplicate of a used one",
        _problem("unused vertex", "in no cell and no duplicate", vertices=np.nonzero(~used & ~listed)[0]),
        _problem("duplicate", "the copy must equal a used vertex and be unused", vertices=copies[wrong]),
    )


def _topology(mesh: Mesh, report: Report) -> bool:
    simplices, k, n = mesh.simplices, mesh.dimension, len(mesh.points)
    table = topology.FaceTable(simplices)
    facets, cells = crowded_facets(table)
    crowded = _problem("facet", "shared by more than two cells", cells, facets.ravel())
    if not report.note("at most two cells at a facet", crowded):
        return False
    neighbors = table.neighbors()
    differ = (neighbors != mesh.neighbors).any(axis=1)
    text = "neighbors do not lie across the facet opposite each vertex"
    wrong = _problem("neighbors", text, cells=np.nonzero(differ)[0])
    well = report.note("neighbors mutual and across the right facets", wrong)
    facets, cells = incoherent_facets(table)
    text = "two cells on the same side of a facet, or against its orientation"
    folded = _problem("orientation", text, cells, facets.ravel())
    well &= report.note("coherent orientation: the two cells of a facet on opposite sides", folded)
    pinched = []
    for faces, fans in pinched_faces(table, neighbors):
        kind = {1: "pinched vertex", 2: "pinched edge"}.get(faces.shape[1], "pinched face")
        text = f"up to {fans.max(initial=0)} separate fans of cells meet there"
        pinched.append(_problem(kind, text, vertices=faces.ravel()))
    manifold = report.note("cells around every vertex hang together", *pinched)
    boundary = topology.boundary(simplices, neighbors)
    if manifold and k == 3:
        bad = bad_vertex_links(table, boundary, n)
        manifold = report.note(
            "the link of every vertex is a sphere or a disc",
            _problem("link", "the cells around the vertex form neither a ball nor a half-ball", vertices=bad),
        )
    elif k > 3:
        report.skipped.append("whether vertex links are spheres (decided up to dimension 3 only)")
    if manifold:
        well &= _euler(table, boundary, report)
    return well and manifold


def _euler(table: topology.FaceTable, boundary: np.ndarray, report: Report) -> bool:
    """For every compact manifold of dimension k: chi(boundary) = (1 - (-1)^k) chi."""
    k = table.simplices.shape[1] - 1
    inside = sum((-1) ** j * count for j, count in enumerate(table.counts()))
    around = 0
    if len(boundary):
        around = len(np.unique(boundary)) if k == 1 else topology.euler(boundary)
    text = f"{inside} inside and {around} on the boundary cannot go together"
    wrong = None if around == (1 - (-1) ** k) * inside else Problem("Euler characteristic", text)
    return report.note(f"Euler characteristic: {inside}, boundary {around}", wrong)


# ---------------------------------------------------------------------- geometry


def _surface(mesh: Mesh, report: Report) -> None:
    """Cells of lower dimension: none may be flat (some projection to coordinate axes must be solid)."""
    from itertools import combinations

    k, d = mesh.dimension, mesh.points.shape[1]
    flat = np.ones(mesh.size, dtype=bool)
    for axes in combinations(range(d), k):
        rows = np.nonzero(flat)[0]
        flat[rows] = orient_rows(np.ascontiguousarray(mesh.points[:, axes]), mesh.simplices[rows]) == 0
    problem = _problem("flat cell", "its corners lie in a lower dimension", cells=np.nonzero(flat)[0])
    report.note("no flat cell", problem)
    report.skipped.append("whether the surface meets itself")


def _orientation(mesh: Mesh, report: Report) -> bool:
    signs = orient_rows(mesh.points, mesh.simplices)
    return report.note(
        "every cell positively oriented (exact)",
        _problem("negative cell", "turned inside out; Mesh.oriented() mends it", np.nonzero(signs < 0)[0]),
        _problem("flat cell", "its corners lie in a lower dimension", np.nonzero(signs == 0)[0]),
    )


def _local_overlap(fans: RidgeFans, report: Report) -> bool:
    rows = fans.overlaps()
    text = "the cells around a vertex (in space: an edge) wind more than once"
    problem = _problem("overlap", text, fans.cells[rows], fans.ridges[rows].ravel())
    return report.note("cells wind once around every vertex (in space: edge)", problem)


def _hull(mesh: Mesh, fans: RidgeFans | None, report: Report) -> bool:
    """Connected and locally convex, so (Tietze-Nakajima) convex: the mesh tiles its points' hull."""
    count, label = topology.components(mesh.neighbors)
    problems = [None if count == 1 else _problem("pieces", f"{count} pieces", np.nonzero(label > 0)[0])]
    if fans is not None:
        rows = fans.concave()
        vertices = np.concatenate(
            [fans.ridges[rows].ravel(), fans.b[rows], fans.a[fans.begin[fans.group[rows]]]]
        )
        problems.append(_problem("concave boundary", "an angle above pi", fans.cells[rows], vertices))
    return report.note("in one piece, with a convex boundary: the convex hull is tiled", *problems)


def _overlap(mesh: Mesh, report: Report, *, everything: bool) -> None:
    """The boundary must not meet itself, and no cell may hold a vertex that is not its own."""
    d = mesh.points.shape[1]
    if d in (2, 3):
        facets = mesh.facets if everything else mesh.boundary
        pairs = crossing_facets(mesh.points, facets)
        text = "meet in more than a common face"
        problem = _problem("crossing", f"{'facets' if everything else 'boundary facets'} that {text}",
                           vertices=facets[pairs.ravel()].ravel())  # fmt: skip
        report.note(f"no two {'' if everything else 'boundary '}facets cross", problem)
    elif d > 3:
        report.skipped.append("whether boundary facets cross (decided up to dimension 3 only)")
    vertices = np.unique(mesh.simplices if everything or d > 3 else mesh.boundary)
    query, cells = mesh._locator.holding(mesh.points[vertices])
    foreign = (mesh.simplices[cells] != vertices[query][:, None]).all(axis=1)
    problem = _problem(
        "overlap", "cells that hold a vertex of others", cells[foreign], vertices[query[foreign]]
    )
    report.note("no cell holds a foreign vertex", problem)


# ---------------------------------------------------------------------- spheres


def _spheres(mesh: Mesh, report: Report, *, opaque: bool) -> None:
    simplices, neighbors = mesh.simplices, mesh.neighbors
    cells, corner = np.nonzero(neighbors > np.arange(mesh.size)[:, None])
    others = neighbors[cells, corner]
    name = "locally Delaunay across every facet (exact)"
    if opaque:
        name = "locally Delaunay across every facet that is not marked (exact)"
        closed = _marked(mesh, topology.oriented_facet(simplices, cells, corner))
        cells, corner, others = cells[~closed], corner[~closed], others[~closed]
    # The vertex across: that of the other cell which is not on the facet. Sums avoid a search.
    across = simplices[others].sum(axis=1) - simplices[cells].sum(axis=1) + simplices[cells, corner]
    inside = np.empty(len(cells), dtype=bool)
    for i in range(0, len(cells), CHUNK):
        part = slice(i, i + CHUNK)
        inside[part] = in_sphere(mesh.points[simplices[cells[part]]], mesh.points[across[part]]) > 0
    text = "spheres of cells that hold the vertex across a facet"
    report.note(name, _problem("not Delaunay", text, cells[inside], across[inside]))


def _marked(mesh: Mesh, facets: np.ndarray) -> np.ndarray:
    d = mesh.dimension
    named = [rows for rows in mesh.markers.values() if rows.ndim == 2 and rows.shape[1] == d]
    group, _ = topology.group_rows(np.sort(np.concatenate([*named, facets]), axis=1))
    return np.isin(group[len(group) - len(facets) :], group[: len(group) - len(facets)])


def _brute(mesh: Mesh, report: Report) -> None:
    """All points against all spheres and all hull facets, and the volume in rational numbers."""
    points, corners = mesh.points, mesh.corners
    inside = in_sphere(corners[:, None], points) > 0
    cells, vertices = np.nonzero(inside)
    report.note(
        "brute force: no vertex in any sphere",
        _problem("not Delaunay", "spheres that hold vertices (all pairs)", cells, vertices),
    )
    beyond = _beyond(points, mesh.boundary)
    report.note(
        "brute force: no vertex beyond a boundary facet",
        _problem("concave boundary", "vertices beyond boundary facets", vertices=np.nonzero(beyond)[0]),
    )
    if points.shape[1] > 1:  # the ends of a segment are no oriented facets
        total, hull = _exact_volume(points, mesh.simplices), _exact_volume(points, mesh.boundary)
        wrong = None if total == hull else Problem("volume", f"cells {float(total)}, hull {float(hull)}")
        report.note("brute force: the cells' volume is the hull's, in rational numbers", wrong)


def _beyond(points: np.ndarray, boundary: np.ndarray) -> np.ndarray:
    """Which points lie strictly outside some boundary facet; (q, facet) is positive for q inside."""
    n, d = points.shape
    if d == 1:
        ends = points[boundary[:, 0], 0]
        return (points[:, 0] < ends.min()) | (points[:, 0] > ends.max())
    facets = np.broadcast_to(points[boundary][:, None], (len(boundary), n, d, d))
    everyone = np.broadcast_to(points[None, :, None], (len(boundary), n, 1, d))
    return (np.asarray(orient(np.concatenate([everyone, facets], axis=2))) < 0).any(axis=0)


def _exact_volume(points: np.ndarray, rows: np.ndarray) -> Fraction:
    """d! times the sum of the volumes of simplices, or of cones from the origin over facets."""
    d = points.shape[1]
    total = Fraction(0)
    for row in rows.tolist():
        corners = [[Fraction(x) for x in points[v].tolist()] for v in row]
        base = [Fraction(0)] * d if len(row) == d else corners.pop(0)
        total += _determinant([[x - y for x, y in zip(corner, base)] for corner in corners])
    return total


def _determinant(rows: list[list[Fraction]]) -> Fraction:
    """By elimination."""
    rows, result = [row[:] for row in rows], Fraction(1)
    for i in range(len(rows)):
        pivot = next((r for r in range(i, len(rows)) if rows[r][i] != 0), None)
        if pivot is None:
            return Fraction(0)
        if pivot != i:
            rows[i], rows[pivot], result = rows[pivot], rows[i], -result
        result *= rows[i][i]
        for r in range(i + 1, len(rows)):
            factor = rows[r][i] / rows[i][i]
            rows[r] = [x - factor * y for x, y in zip(rows[r], rows[i])]
    return result
