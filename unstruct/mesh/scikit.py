"""Meshes as those of scikit-fem: named facets become boundaries, markers of cells subdomains."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..base.errors import MeshError
from ..base.optional import optional
from .accounts import say_lost
from .complex import CellComplex
from .grouping import group_rows
from .naming import names_by_number

__all__ = ["to_skfem"]

SKFEM_HEX = [0, 4, 3, 1, 7, 5, 2, 6]  # the corners of a hexahedron in the order of scikit-fem


def to_skfem(mesh: CellComplex) -> Any:
    """The mesh as a scikit-fem mesh; named facets become boundaries, cell markers subdomains.

    A boolean marker of cells is one subdomain; one of integers has a subdomain for each value: "region 2", or
    the name of that region.

    Warns
    -----
    UserWarning
        Of what has no place there: weights, sides that match, markers with real numbers and of vertices.
    """
    skfem = optional("skfem", "Mesh.to_skfem")
    kinds = {
        ("line", 1): "MeshLine",
        ("triangle", 2): "MeshTri",
        ("quad", 2): "MeshQuad",
        ("tetra", 3): "MeshTet",
        ("hexahedron", 3): "MeshHex",
    }
    name = next(iter(mesh.cells))
    kind = kinds.get((name, mesh.points.shape[1]))
    if len(mesh.cells) > 1 or kind is None:
        what = ", ".join(mesh.cells)
        raise MeshError(
            f"scikit-fem has no mesh for cells of kind {what} in {mesh.points.shape[1]} dimensions"
        )
    if mesh.size == 0:
        raise MeshError("scikit-fem has no mesh without cells")
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.cells[name]] = True
    number = np.cumsum(used) - 1
    number[~used] = -1
    cells = mesh.cells[name][:, SKFEM_HEX] if name == "hexahedron" else mesh.cells[name]
    result = getattr(skfem, kind)(mesh.points[used].T.copy(), number[cells].T.copy())
    boundaries, subdomains = _skfem_facets(mesh, result, number), {}
    lost = [
        marker
        for marker, values in mesh.markers.items()
        if (values.dtype.kind not in "biu" if values.ndim == 1 else marker not in boundaries)
    ]
    say_lost(mesh, "scikit-fem", lost)
    for marker, values in mesh.markers.items():
        if values.ndim == 1 and values.dtype == bool:
            subdomains[marker] = np.nonzero(values)[0]
        elif values.ndim == 1 and values.dtype.kind in "iu":
            order = np.argsort(values, kind="stable")
            different, first = np.unique(values[order], return_index=True)
            called = names_by_number(mesh.regions) if marker == "region" else {}
            for value, part in zip(different.tolist(), np.split(order, first[1:])):
                subdomains[called.get(value, f"{marker} {value}")] = part
    if boundaries:
        result = result.with_boundaries(boundaries)
    return result.with_subdomains(subdomains) if subdomains else result


def _skfem_facets(mesh: CellComplex, theirs: Any, number: np.ndarray) -> dict[str, np.ndarray]:
    """The numbers that scikit-fem gives to the facets of each marker."""
    named = {
        name: number[rows]
        for name, rows in mesh.markers.items()
        if rows.ndim == 2 and rows.shape[1] == len(theirs.facets) and (rows >= 0).all()
    }
    if not named:
        return {}
    wanted = np.concatenate(list(named.values()))
    marked = np.zeros(theirs.p.shape[1] + 1, dtype=bool)  # the last entry belongs to -1, an unused vertex
    marked[wanted] = True
    near = np.flatnonzero(marked[theirs.facets].all(axis=0))  # few, so that nothing large is sorted
    group, first = group_rows(np.sort(np.concatenate([theirs.facets.T[near], wanted]), axis=1))
    place = first[group[len(near) :]]
    lost = place >= len(near)
    if lost.any():
        every = np.concatenate([mesh.markers[name] for name in named])
        raise MeshError(f"{every[int(np.argmax(lost))].tolist()} has a marker, but is not a facet of a cell")
    parts = np.split(near[place], np.cumsum([len(rows) for rows in named.values()])[:-1])
    return dict(zip(named, parts))
