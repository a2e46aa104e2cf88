"""`unstruct.check` for the mesh of a region: is every piece there, in its place, and nothing else meshed?

See the book, chapters 2.5 and 2.6d.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ..base.report import Problem, Report, problem
from ..domain.domain import Domain
from ..geometry.curves import Arc
from ..geometry.outline_distance import distance_to_line, distance_to_piece
from ..geometry.parity import cells_area, enclosed_area, even_odd, left_parity
from ..mesh.marked import marked_sides, parts
from ..mesh.mesh import Mesh
from .chains import Chains, among, assigned, chains_of, keys_of
from .places import numbered, places_of

__all__ = ["check_domain", "scatter_of"]

ULPS = 64  # the most that a new vertex may be off its true curve, in 2^-53 of the largest coordinate
SCATTER_STEPS = np.arange(-8, 9) * 2.0**-52  # steps of a parameter over which a function for a curve scatters


def check_domain(mesh: Mesh, domain: Domain, report: Report) -> None:
    """Compare a planar mesh with its domain; the report says what was examined and names the culprits.

    Parameters
    ----------
    mesh : Mesh
        Triangles whose adjacency, orientation and freedom from overlap are tested already. Its `origin`
        refers to the points of the domain; markers "facets" and "inner" are the edges on its pieces.
    domain : Domain
    report : Report

    Notes
    -----
    Marked edges between domain vertices must be chains, one for each piece; new vertices in them must lie on
    the true piece up to 64 times 2^-53 of the largest coordinate, in order. The mesh must end at the facets
    exactly, and its area must be that enclosed by the chains (sums without rounding error).
    """
    if mesh.points.shape[1] != 2 or mesh.dimension != 2:
        report.note("a planar mesh for a planar domain", Problem("domain", "the mesh is not planar"))
        return
    place = places_of(mesh, domain, report)
    marked = {name: _edges(mesh, name) for name in ("facets", "inner")}
    if place is None or not _marked(mesh, marked, report):
        report.skipped.append("the pieces of the domain, which need valid origins and markers")
        return
    chains = chains_of(mesh, place, np.concatenate(list(marked.values())), report)
    if chains is not None:
        chains = assigned(mesh, domain, chains, marked["facets"], report)
    if chains is None:
        report.skipped.append("places and area of the chains, which need one chain for each piece")
        return
    _inside_out(mesh, domain, place, marked["facets"], report)
    _curves_met(mesh, domain, chains, report)
    _names(mesh, domain, chains, report)
    edges = np.concatenate(list(marked.values()))
    numbered(mesh, domain, lambda: parts(mesh, edges), report)


# ---------------------------------------------------------------------- vertices and markers


def _edges(mesh: Mesh, name: str) -> np.ndarray:
    rows = mesh.markers.get(name, np.empty((0, 2), dtype=np.int32))
    return np.asarray(rows, dtype=np.int64).reshape(-1, 2) if rows.ndim == 2 else np.empty((0, 2), np.int64)


def _marked(mesh: Mesh, marked: dict[str, np.ndarray], report: Report) -> bool:
    """Test that marked edges are edges marked once, facets are the boundary, and inner edges are inside."""
    n = len(mesh.points)
    border = keys_of(mesh.boundary, n)
    facets, inner = keys_of(marked["facets"], n), keys_of(marked["inner"], n)
    both = np.concatenate([facets, inner])
    values, times = np.unique(both, return_counts=True)
    twice = np.concatenate([marked["facets"], marked["inner"]])[among(both, values[times > 1])]
    missing = marked["facets"][~among(facets, border)]
    extra = np.asarray(mesh.boundary)[~among(border, facets)]
    within = marked_sides(mesh.simplices, marked["inner"], n)[1] & ~among(inner, border)
    astray = marked["inner"][~within]
    return report.note(
        "the mesh ends exactly at its facets; inner edges lie within",
        problem("marked twice", "as facet or inner edge", vertices=twice.ravel()),
        problem("facet", "facet edges that do not bound the mesh", vertices=missing.ravel()),
        problem("boundary", "the mesh ends at edges that are no facets", vertices=extra.ravel()),
        problem("inner", "inner edges that are no edges inside the mesh", vertices=astray.ravel()),
    )


# ---------------------------------------------------------------------- places


def _ahead(a: list[float], b: list[float], x: list[float], y: list[float]) -> bool:
    """Whether y is ahead of x in the direction from a to b (exact)."""
    return (
        sum((Fraction(t) - Fraction(s)) * (Fraction(q) - Fraction(p)) for p, q, s, t in zip(a, b, x, y)) > 0
    )


def _curves_met(mesh: Mesh, domain: Domain, chains: Chains, report: Report) -> None:
    """Test that new vertices of chains lie on the true piece up to rounding, in the order of the piece."""
    inner, owner = chains.inner(), chains.owner()
    rows, piece = chains.vertices[inner], chains.piece[owner[inner]]
    x, ends = mesh.points[rows], domain.points[domain.pieces[piece]]
    away, t = distance_to_line(ends[:, 0], ends[:, 1], x)
    scale = np.abs(ends).max(axis=(1, 2))
    if domain.curves:
        _onto_curves(domain, piece, x, away, t, scale)
    unit = np.maximum(scale, 1e-300) * 2.0**-53
    far = np.flatnonzero(away > ULPS * unit)
    far = far[np.isin(piece[far], list(domain.curves))]
    if len(far):
        away[far] = np.maximum(away[far] - 2 * scatter_of(domain, piece[far], t[far]), 0.0)
    ulps = away / unit
    along = np.zeros(len(owner))
    along[chains.start[1:] - 1] = 1.0
    along[inner] = t
    stuck = np.append(along[1:] <= along[:-1], False)
    steps = np.unique(np.concatenate([inner - 1, inner]))
    for i in steps[stuck[steps]].tolist():
        if (number := int(chains.piece[owner[i]])) not in domain.curves:
            # parameters in doubles may not tell vertices apart that are in order
            line, step = domain.points[domain.pieces[number]], mesh.points[chains.vertices[i : i + 2]]
            stuck[i] = not _ahead(*line.tolist(), *step.tolist())
    back = stuck[inner - 1] | stuck[inner]
    worst = float(ulps.max(initial=0.0))
    text = f"off the true curve by up to {worst:.3g} units of rounding ({ULPS} allowed)"
    report.note(
        f"new vertices on the true curves (within {ULPS} units of rounding), in order",
        problem("off the curve", text, vertices=rows[ulps > ULPS]),
        problem("order", "vertices of a chain that go back along their piece", vertices=rows[back]),
    )


def scatter_of(domain: Domain, piece: np.ndarray, t: np.ndarray) -> np.ndarray:
    """How much a function for a curve scatters by rounding near a parameter: the deviation from a line."""
    at = np.clip(t[:, None] + SCATTER_STEPS, 0.0, 1.0)
    places = domain.points_at(np.repeat(piece, len(SCATTER_STEPS)), at.ravel()).reshape(
        len(t), len(SCATTER_STEPS), 2
    )
    places = places - places.mean(axis=1, keepdims=True)
    slope = (SCATTER_STEPS[:, None] * places).sum(axis=1, keepdims=True) / (SCATTER_STEPS**2).sum()
    rest = places - SCATTER_STEPS[:, None] * slope
    return np.hypot(rest[..., 0], rest[..., 1]).max(axis=1)


def _onto_curves(
    domain: Domain, piece: np.ndarray, x: np.ndarray, away: np.ndarray, t: np.ndarray, scale: np.ndarray
) -> None:
    """Write the distances, parameters and largest coordinates of points on curved pieces."""
    order = np.argsort(piece, kind="stable")
    heads = np.flatnonzero(np.diff(piece[order], prepend=-1))
    for part in np.split(order, heads[1:]) if len(order) else []:
        number = int(piece[part[0]])
        curve = domain.curves.get(number)
        if curve is None:
            continue
        away[part], t[part] = distance_to_piece(domain, number, x[part])
        if isinstance(curve, Arc):
            most = curve.radius + np.abs(curve.center).max()
        else:
            most = np.abs(x[part]).max()
        scale[part] = np.maximum(scale[part], most)


# ---------------------------------------------------------------------- inside and outside


def _inside_out(mesh: Mesh, domain: Domain, place: np.ndarray, facets: np.ndarray, report: Report) -> None:
    """Test that the mesh covers what the chains enclose (even-odd) and uses the loose vertices in it."""
    if len(domain.facets) == 0:
        report.skipped.append("area and loose vertices of a domain without facets")
        return
    left = left_parity(mesh.points, facets)
    turned = np.where(left[:, None], facets, facets[:, ::-1])
    wanted = enclosed_area(mesh.points, turned)
    area = cells_area(mesh.points, mesh.simplices)
    wrong = abs(area - wanted) > 2.0**-50 * abs(wanted)
    text = f"the cells cover {area:.17g}, the chains enclose {wanted:.17g} (even-odd)"
    n = len(mesh.points)
    border = np.asarray(mesh.boundary, dtype=np.int64)
    turned_out = turned[~among(turned[:, 0] * n + turned[:, 1], border[:, 0] * n + border[:, 1])].ravel()
    report.note(
        "the mesh covers what the chains enclose by the even-odd rule (exact)",
        Problem("area", text) if wrong else None,
        problem("inside out", "facets with the mesh on their outer side", vertices=turned_out),
    )
    inside, on = even_odd(mesh.points, facets, domain.points[domain.loose])
    there = place[domain.loose] >= 0
    lost, extra = domain.loose[inside & ~on & ~there], domain.loose[~inside & ~on & there]
    text = f"loose vertices of the domain that are not in the mesh: {lost[:8].tolist()}"
    report.note(
        "loose vertices inside are vertices of the mesh",
        Problem("missing vertex", text) if len(lost) else None,
        problem("outer vertex", "loose vertices that lie outside", vertices=place[extra]),
    )


# ---------------------------------------------------------------------- names


def _names(mesh: Mesh, domain: Domain, chains: Chains, report: Report) -> None:
    """Test that each marker of the domain contains the edges of its pieces, and no others."""
    n = len(mesh.points)
    wrong: list[Problem | None] = []
    rows, piece = chains.edges()
    order = np.argsort(piece, kind="stable")
    keys, start = keys_of(rows, n)[order], np.searchsorted(piece[order], np.arange(len(domain.pieces) + 1))
    for name, pieces in domain.markers.items():
        if name not in mesh.markers:
            wrong.append(Problem("marker", f"the mesh has no marker {name!r}"))
            continue
        wanted = [keys[start[i] : start[i + 1]] for i in pieces.tolist()]
        found = keys_of(_edges(mesh, name), n)
        differ = np.setxor1d(np.concatenate([np.empty(0, dtype=np.int64), *wanted]), found)
        text = f"marker {name!r} does not contain exactly the edges of its pieces"
        wrong.append(problem("marker", text, vertices=np.concatenate([differ // n, differ % n])))
    if domain.markers:
        report.note("named edges are those of the named pieces", *wrong)
