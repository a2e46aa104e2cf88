"""Names on a surface and on a mesh of it: of cells by where they lie, of edges by their curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.report import Problem, Report, problem
from ..domain.given_surface import GivenSurface
from ..geometry.support_features import same_points
from ..mesh.marked import marked_facets
from ..mesh.mesh import Mesh
from .chains import among, keys_of
from .surface_curves import Curves

__all__ = ["names_held"]


def names_held(
    mesh: Mesh, given: GivenSurface, triangle: NDArray[np.int64], curves: Curves, report: Report
) -> None:
    """Test that each name of the surface names the cells and edges that lie where it does, and no others.

    Parameters
    ----------
    triangle : (m,) int64
        The triangle of the surface on which each cell lies.
    """
    wrong: list[Problem | None] = []
    for name, on in given.names.items():
        rows = mesh.markers.get(name)
        if _lacks(name, rows, 3, wrong) or rows is None:
            continue
        differ = marked_facets(np.asarray(mesh.simplices), rows, len(mesh.points)) != on[triangle]
        text = f"marker {name!r} does not contain exactly the cells that lie on its triangles"
        wrong.append(problem("marker", text, cells=np.flatnonzero(differ)))
    for name, values in given.values.items():
        rows = mesh.markers.get(name)
        if rows is None or rows.ndim != 1:
            wrong.append(Problem("marker", f"the mesh has no marker {name!r} with one number per cell"))
            continue
        text = f"cells whose number in {name!r} is not that of their place on the surface"
        wrong.append(problem("marker", text, cells=np.flatnonzero(rows != values[triangle])))
    for name in given.edges:
        if name not in given.names:
            wrong.append(_edges_named(mesh, given, name, curves, wrong))
    if given.names or given.values or given.edges:
        report.note("named cells and edges are those on what has the name", *wrong)


def _lacks(name: str, rows: np.ndarray | None, width: int, wrong: list[Problem | None]) -> bool:
    if rows is None:
        wrong.append(Problem("marker", f"the mesh has no marker {name!r}"))
    elif rows.ndim != 2 or rows.shape[1] != width:
        wrong.append(Problem("marker", f"marker {name!r} has no rows of {width} vertices"))
    else:
        return False
    return True


def _edges_named(
    mesh: Mesh, given: GivenSurface, name: str, curves: Curves, wrong: list[Problem | None]
) -> Problem | None:
    rows = mesh.markers.get(name)
    if _lacks(name, rows, 2, wrong) or rows is None:
        return None
    support = given.support
    same = same_points(support.points)
    named = among(keys_of(support.features, len(same)), keys_of(same[given.edges[name]], len(same)))
    total = np.append(0, np.cumsum(named))
    first, last = curves.first, curves.last
    begin = np.searchsorted(support.chain, support.chain[first])
    end = np.searchsorted(support.chain, support.chain[first], side="right")
    wraps = last < first  # around a closed curve
    covered = np.where(
        wraps, total[end] - total[first] + total[last + 1] - total[begin], total[last + 1] - total[first]
    )
    length = np.where(wraps, end - first + last + 1 - begin, last + 1 - first)
    own = keys_of(curves.pairs[covered == length], len(mesh.points))
    found = keys_of(rows, len(mesh.points))
    extra, missing = rows[~among(found, own)], curves.pairs[covered == length][~among(own, found)]
    text = f"marker {name!r} does not contain exactly the edges on its curves"
    return problem("marker", text, vertices=np.concatenate([extra, missing]).ravel())
