"""Is a mesh of triangles in space a mesh of a given surface? See the book, chapter 2.7.

The surface is compared as a complex first: its curves are chains of edges of the mesh, at which as many
triangles meet in the same directions; everywhere else two triangles meet, which run through their edge in
opposite directions; components and their Euler characteristics agree. All this is counted. Whether the mesh
meets itself is decided by exact signs. Where it is, and how far from the surface, is measured in numbers that
are rounded.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.report import Problem, Report, problem
from ..domain.given_surface import USUAL_SHARP, given_surface
from ..generate.surface.cleaning import broken_edges, cleaned
from ..geometry.embedded import embedded, flat_rows, meeting_pairs
from ..geometry.support import Support
from ..geometry.support_features import fans_at, same_points, side_groups, united
from ..mesh.domain_mesh import DomainMesh
from ..mesh.mesh import Mesh
from ..predicates.batch import power_of_two
from .pinches import OFF_ULPS
from .surface_curves import Curves, curves_held
from .surface_names import names_held

__all__ = ["check_surface"]

ROUNDED_OFF = OFF_ULPS * 2.0**-53  # in units of the largest coordinate
MEASURED_AGAIN = 1e-9  # part by which a distance that is measured again may differ by rounding


class Places(NamedTuple):
    """Where the cells of a mesh lie on the surface.

    Attributes
    ----------
    triangle : (m,) int64
        The triangle of the surface nearest to the middle of each cell, among those that face it.
    away : (m,) float64
        How far that is from the middle.
    nearest : (m,) int64
        The nearest one of all.
    against : (m,) bool
        Whether the cell faces against that.
    """

    triangle: NDArray[np.int64]
    away: NDArray[np.float64]
    nearest: NDArray[np.int64]
    against: NDArray[np.bool_]


def check_surface(
    mesh: Mesh, surface: object, report: Report, deviation: float | None, sharp: float | None
) -> None:
    """Compare a mesh with a surface; see `check`. O(m log m)."""
    figures = mesh.figures if isinstance(mesh, DomainMesh) else {}
    turn = figures.get("sharp", USUAL_SHARP) if sharp is None else sharp
    surface = _mended(mesh, surface, report)
    given = given_surface(surface, turn if 0.0 < turn < 180.0 else None)
    report.note(f"compared with {surface!r}, whose creases turn by more than {turn:g} degrees")
    support, rows = given.support, np.asarray(mesh.simplices, dtype=np.int64)
    if not _distinct(mesh, rows, report):
        report.skipped.append("the surface, which needs triangles with area and vertices in different places")
        return
    off = ROUNDED_OFF / support.factor if deviation is None else max(deviation, ROUNDED_OFF / support.factor)
    _on_surface(mesh, support, off, deviation is None, report)
    curves = curves_held(mesh, given, ROUNDED_OFF, report)
    _sheets(mesh, support, curves, report)
    _meets_itself(mesh, support, report)
    measured = support.distances(mesh.points, rows)
    places = _places(mesh, support)
    allowed = figures.get("deviation") if deviation is None else deviation
    _deviation(mesh, support, measured, allowed, report)
    most = max(float(measured[0].max()) if allowed is None else allowed, off) * (1.0 + MEASURED_AGAIN)
    turned = places.against & (places.away > most + ROUNDED_OFF / support.factor)
    text = "cells that face against the surface: folded, or turned inside out"
    report.note("cells face as the surface does", problem("turned", text, cells=np.flatnonzero(turned)))
    triangle = np.where(turned, places.nearest, places.triangle)
    _components(mesh, support, triangle, deviation is not None, report)
    names_held(mesh, given, triangle, curves, report)


def _mended(mesh: Mesh, surface: object, report: Report) -> object:
    """For a mesh that is turned coherently, a given surface without what is repeated or turned otherwise."""
    clean, rows = cleaned(surface, flat=True), np.asarray(mesh.simplices, dtype=np.int64)
    again = clean.counts.get("repeated triangles", 0), clean.counts.get("turned triangles", 0)
    hanging = clean.surface.size + again[0] < surface.size if isinstance(surface, Mesh) else False
    if not (any(again) or hanging) or broken_edges(rows, np.zeros(len(rows), dtype=np.int64), 1)[0]:
        return surface
    report.note(f"the surface repeats {again[0]} triangles, which count once, and {again[1]} were turned")
    if hanging:
        report.note("flat triangles hang on single edges of the surface, and do not count")
    return clean.surface


def _distinct(mesh: Mesh, rows: NDArray[np.int64], report: Report) -> bool:
    used = np.unique(rows)
    same = same_points(mesh.points[used])
    copies = np.flatnonzero(same != np.arange(len(used)))
    order = np.lexsort(np.sort(rows, axis=1).T)
    ordered = np.sort(rows, axis=1)[order]
    twice = order[1:][(ordered[1:] == ordered[:-1]).all(axis=1)]
    return report.note(
        "triangles have area, no two the same corners; vertices are in different places (exact)",
        problem("flat cell", "its corners lie on a line", cells=flat_rows(mesh.points, rows)),
        problem("twice", "cells with the vertices of another one", cells=twice),
        problem("equal vertices", "in the place of another vertex", vertices=used[copies]),
    )


def _on_surface(mesh: Mesh, support: Support, off: float, exact: bool, report: Report) -> None:
    used = np.unique(mesh.simplices)
    away = (support.nearest(mesh.points[used])[2] - mesh.points[used]) * support.factor
    away = np.sqrt((away * away).sum(axis=1)) / support.factor
    wrong = problem("off the surface", "vertices that are not on it", vertices=used[away > off])
    moved = None
    if isinstance(mesh, DomainMesh):
        origin, n = np.asarray(mesh.origin), len(support.points)
        bad = (origin < -1) | (origin >= n)
        known = np.flatnonzero((origin >= 0) & ~bad)
        bad[known] = (mesh.points[known] != support.points[origin[known]]).any(axis=1)
        moved = problem("moved", "not where the surface has its vertex", vertices=np.flatnonzero(bad))
    rule = f"up to {OFF_ULPS} units of rounding" if exact else f"up to {off:.6g}"
    report.note(f"vertices lie on the surface, {rule}; those of the surface in their places", wrong, moved)


def _sheets(mesh: Mesh, support: Support, curves: Curves, report: Report) -> None:
    """Test what meets at each edge and vertex: on curves as the surface has it, elsewhere two triangles."""
    ahead, back = curves.meeting
    free = ~curves.on
    ends = curves.sides[free]
    many, turned = (ahead + back)[free], (ahead != back)[free]
    owner = curves.cells[free]
    report.note(
        "two triangles at each edge that is on no curve, in opposite directions",
        problem("hole", "the mesh ends, the surface does not", owner[many == 1], ends[many == 1].ravel()),
        problem("branch", "more than two triangles meet", owner[many > 2], ends[many > 2].ravel()),
        problem(
            "orientation", "two triangles that run through their edge in the same direction",
            owner[(many == 2) & turned], ends[(many == 2) & turned].ravel(),
        ),
    )  # fmt: skip
    fans = fans_at(np.asarray(mesh.simplices, dtype=np.int64), len(mesh.points))
    wanted = np.minimum(fans, 1)
    known = np.flatnonzero(curves.origin >= 0)
    own = fans_at(support.held.rows, len(support.points))[curves.origin[known]]
    wanted[known] = np.where(own > 0, own, wanted[known])  # given points without triangles are no vertices
    wrong = np.flatnonzero((fans != wanted) & (fans > 0))
    text = "the triangles there form more or fewer fans than on the surface"
    report.note(
        "one fan of triangles at each vertex, or as many as on the surface",
        problem("pinched vertex", text, vertices=wrong),
    )


def _meets_itself(mesh: Mesh, support: Support, report: Report) -> None:
    rows = np.asarray(mesh.simplices)
    if embedded(mesh.points, rows):
        report.note("no two triangles meet but in common vertices and edges (exact)")
        return
    found = meeting_pairs(mesh.points, rows)
    if len(found):
        own = support.held.rows
        own = own[(own != own[:, [1, 2, 0]]).all(axis=1)]
        own = own[np.setdiff1d(np.arange(len(own)), flat_rows(support.points, own))]
        if len(own) and len(meeting_pairs(support.points, own)):
            report.skipped.append(
                f"whether the mesh meets itself, as the surface does: {len(found)} pairs do"
            )
            return
    report.note(
        "no two triangles meet but in common vertices and edges (exact)",
        problem("meets itself", "triangles that cross or touch others", cells=found.ravel()),
    )


def _places(mesh: Mesh, support: Support) -> Places:
    x = mesh.points[mesh.simplices]
    middle = x[:, 0] / 3 + x[:, 1] / 3 + x[:, 2] / 3
    x = x * power_of_two(mesh.points)  # products of lengths are finite
    normals = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) if len(x) else x[:, 0]
    length = np.sqrt((normals**2).sum(axis=1))[:, None]
    normals = normals / np.where(length > 0.0, length, 1.0)
    nearest = support.nearest(middle)[0]
    triangle, _, feet = support.nearest(middle, nearest, normals)
    faces = (support.normals[triangle] * normals).sum(axis=1) > 0.0
    away = np.where(faces, np.sqrt((((feet - middle) * support.factor) ** 2).sum(axis=1)), np.inf)
    away = away / support.factor
    against = (support.normals[nearest] * normals).sum(axis=1) < 0.0
    return Places(triangle, away, nearest, against)


def _deviation(
    mesh: Mesh,
    support: Support,
    measured: tuple[np.ndarray, np.ndarray],
    allowed: float | None,
    report: Report,
) -> None:
    there, back = measured
    text = f"mesh from surface {there.max():.6g}, surface from mesh {back.max():.6g}"
    if allowed is None:
        report.note(f"deviation, at samples: {text}; nothing says how much is allowed")
        return
    most = allowed * (1.0 + MEASURED_AGAIN) + ROUNDED_OFF / support.factor
    worst = int(back.argmax())
    place = ", ".join(f"{x:.6g}" for x in support.points[support.triangles[worst]].mean(axis=0))
    report.note(
        f"deviation, at samples: {text}; allowed is {allowed:.6g}",
        problem("deviation", f"farther from the surface than {allowed:.6g}", np.flatnonzero(there > most)),
        Problem(
            "deviation",
            f"the surface is {back[worst]:.6g} from the mesh near ({place}), allowed is {allowed:.6g}",
        )
        if back[worst] > most
        else None,
    )


def _labels(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """The component of each triangle, connected over sides; numbered from 0."""
    place, group, _ = side_groups(rows)
    same = np.flatnonzero(group[1:] == group[:-1])
    parent = np.arange(len(rows))
    united(place[same] // 3, place[same + 1] // 3, parent)
    return np.unique(parent, return_inverse=True)[1].ravel()


def _characters(rows: NDArray[np.int64], label: NDArray[np.int64]) -> NDArray[np.int64]:
    """The Euler characteristic of each component."""
    n, many = int(rows.max()) + 1, int(label.max()) + 1
    vertices = np.unique(np.repeat(label, 3) * n + rows.ravel()) // n
    place, group, _ = side_groups(rows)
    first = place[np.append(True, group[1:] != group[:-1])]
    return (
        np.bincount(vertices, minlength=many)
        - np.bincount(label[first // 3], minlength=many)
        + np.bincount(label, minlength=many)
    )


def _components(mesh: Mesh, support: Support, triangle: NDArray[np.int64], off: bool, report: Report) -> None:
    """Test that each component of the surface is one of the mesh, with the same Euler characteristic.

    A component of the mesh belongs to that of the surface on which most of its vertices lie: where sheets are
    nearer than the mesh deviates, middles of cells may be nearer to another one. Only if components of the
    surface have vertices in common, or vertices of the mesh may be off it, may cells decide instead.
    """
    rows, own = np.asarray(mesh.simplices, dtype=np.int64), support.held.rows
    whole = np.flatnonzero((own != own[:, [1, 2, 0]]).all(axis=1))
    part = np.full(len(own), -1)
    part[whole] = _labels(own[whole])
    label = _labels(rows)
    characters = _characters(rows, label), _characters(own[whole], part[whole])
    used = np.unique(np.repeat(label, 3) * len(mesh.points) + rows.ravel())
    nearest = support.nearest(mesh.points[used % len(mesh.points)])[0]
    wrong = _unmatched(part, _most(used // len(mesh.points), part[nearest]), label, characters)
    corners = np.unique(np.stack([own[whole].ravel(), np.repeat(part[whole], 3)]), axis=1)[0]
    if wrong and (off or len(np.unique(corners)) < len(corners)):
        wrong = _unmatched(part, _most(label, part[triangle]), label, characters)
    many = len(characters[1])
    shown = ", ".join(map(str, characters[1][:8].tolist())) + (", ..." if many > 8 else "")
    report.note(f"components of the surface, each once, with its Euler characteristic: {shown}", *wrong)


def _most(label: NDArray[np.int64], part: NDArray[np.int64]) -> NDArray[np.int64]:
    """The most frequent part of each label."""
    base = int(part.max()) + 2
    pairs, times = np.unique(label * base + part + 1, return_counts=True)
    pairs = pairs[np.lexsort((times, pairs // base))]
    last = np.append(pairs[1:] // base != pairs[:-1] // base, True)
    return pairs[last] % base - 1


def _unmatched(
    part: NDArray[np.int64],
    home: NDArray[np.int64],
    label: NDArray[np.int64],
    characters: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> list[Problem]:
    """What is wrong if each component of the mesh, as cells are labelled, belongs to its home."""
    count = np.bincount(home[home >= 0], minlength=len(characters[1]))
    wrong: list[Problem | None] = []
    for lost in np.flatnonzero(count == 0)[:8].tolist():
        t = int(np.flatnonzero(part == lost)[0])
        wrong.append(Problem("component", f"nothing lies on the one of triangle {t} of the surface"))
    text = "several components on one of the surface"
    wrong.append(problem("component", text, cells=np.flatnonzero((count[home] > 1)[label])))
    for i in np.flatnonzero((count[home] == 1) & (characters[0] != characters[1][home]))[:8].tolist():
        text = f"{characters[0][i]}, but that of the surface is {characters[1][home[i]]}"
        wrong.append(problem("Euler characteristic", text, cells=np.flatnonzero(label == i)[:1]))
    return [one for one in wrong if one is not None]
