"""The contestants of the suite ``prisms``: the triangles of a closed surface in, points and wedges out.

All are given the same points, triangles and heights of layers. Gmsh extrudes a discrete surface; it limits no
height and looks for no collision. Ours does both. The library itself imports no peer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher

Made = tuple[NDArray[np.float64], dict[str, NDArray[np.integer]], Any]  # points, cells by kind, our mesh
GMSH_KINDS = {4: ("tetra", 4), 6: ("wedge", 6), 7: ("pyramid", 5)}


class Given(NamedTuple):
    """A body with a good surface, layers, and what is needed for a mesh beyond them."""

    domain: Any
    layers: Any
    heights: list[float]  # the total heights after 1, 2, ... layers
    walls: list[str] | None = None
    size: Any = None


def _cells(mesh: Any) -> dict[str, NDArray]:
    return {kind: np.asarray(rows) for kind, rows in mesh.cells.items() if len(rows)}


def _ours(checked: bool) -> Callable[[], Callable[[Any], Any]]:
    def prepare() -> Callable[[Any], Any]:
        import warnings

        from unstruct import Domain, prismatic_layers

        def run(given: Given) -> Made:
            domain = given.domain
            if checked:
                domain = Domain(domain.points, domain.facets, markers=domain.markers)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                mesh = prismatic_layers(domain, given.size, layers=given.layers, walls=given.walls)
            return mesh.points, _cells(mesh), mesh

        return run

    return prepare


def _gmsh() -> Callable[[Any], Any]:
    import gmsh

    if not gmsh.isInitialized():
        gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)

    def run(given: Given) -> Made:
        gmsh.clear()
        model, domain = gmsh.model, given.domain
        points, shell = domain.points, domain.triangulated
        triangles = shell.triangles
        walls = np.concatenate(
            [domain.markers[name] for name in given.walls or []] or [np.arange(len(triangles))]
        )
        on_wall = np.isin(shell.piece, walls)
        surfaces = [_surface(gmsh, points, triangles[rows]) for rows in (on_wall, ~on_wall) if rows.any()]
        gmsh.option.setNumber("Geometry.ExtrudeReturnLateralEntities", 0)
        made = model.geo.extrudeBoundaryLayer(
            [(2, surfaces[0])], [1] * len(given.heights), given.heights, True
        )
        if given.size is not None:
            caps = [tag for dimension, tag in made if dimension == 2]
            loops = [model.geo.addSurfaceLoop(rows) for rows in (surfaces[1:], caps)]
            model.geo.addVolume(loops)
        model.geo.synchronize()
        if given.size is not None:
            for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
                gmsh.option.setNumber(f"Mesh.MeshSize{name}", int(name == "ExtendFromBoundary"))
        model.mesh.generate(3)
        tags, coordinates, _ = model.mesh.getNodes()
        place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        place[tags.astype(np.int64)] = np.arange(len(tags))
        kinds, _, nodes = model.mesh.getElements(3)
        cells = {}
        for kind, rows in zip(kinds, nodes):
            name, corners = GMSH_KINDS[int(kind)]
            cells[name] = place[rows.reshape(-1, corners).astype(np.int64)]
        return coordinates.reshape(-1, 3).copy(), cells, None

    return run


def _surface(gmsh: Any, points: NDArray, triangles: NDArray) -> int:
    """A discrete surface, with the numbers of its points plus 1 as tags."""
    tag = gmsh.model.addDiscreteEntity(2)
    used = np.unique(triangles)
    gmsh.model.mesh.addNodes(2, tag, used + 1, points[used].ravel())
    gmsh.model.mesh.addElementsByType(tag, 2, [], (triangles + 1).ravel())
    return int(tag)


MESHERS = [
    *(Mesher("unstruct", "unstruct", work, _ours(False)) for work in ("layers", "growth", "joined")),
    Mesher("unstruct, checks of the surface", "unstruct", "layers", _ours(True)),
    *(Mesher("Gmsh extrudeBoundaryLayer", "gmsh", work, _gmsh) for work in ("layers", "growth", "joined")),
]
