"""The contestants of the suite ``volume``: points and triangles of a closed surface in, points and cells out.

All keep the surface if they can (TetGen by ``Y``, Gmsh by a discrete surface). For a size that varies, Gmsh
is given the same formula as text; its callback in Python would be slower. The library itself imports no peer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher

EQUAL_EDGES = np.sqrt(2) / 12  # the volume of a regular tetrahedron; unit: its edge cubed
Meshed = tuple[NDArray[np.float64], NDArray[np.integer]]


class Given(NamedTuple):
    """A surface, the wanted length of edges inside (None: no points but those that must be), as a formula."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    size: Any
    formula: str


# ---------------------------------------------------------------------- ours


def _ours(optimize: bool) -> Callable[[], Callable[[Given], Meshed]]:
    def prepare() -> Callable[[Given], Meshed]:
        import warnings

        from unstruct import Domain, tetrahedralize

        def run(given: Given) -> Meshed:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                mesh = tetrahedralize(Domain(given.points, given.triangles), given.size, optimize=optimize)
            return mesh.points, mesh.simplices

        return run

    return prepare


# ---------------------------------------------------------------------- peers


def _tetgen(quality: str) -> Callable[[], Callable[[Given], Meshed]]:
    """TetGen by its wheel, which prints on its own: the output of the process is silenced meanwhile."""

    def prepare() -> Callable[[Given], Meshed]:
        import os

        from tetgen import TetGen

        def run(given: Given) -> Meshed:
            flags = f"pYQ{quality}"
            if given.size is not None:
                flags += f"a{EQUAL_EDGES * float(given.size) ** 3:.12f}"
            kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, 1)
            try:
                made = TetGen(np.array(given.points), np.array(given.triangles, dtype=np.int32))
                points, cells = made.tetrahedralize(switches=flags)[:2]
            finally:
                os.dup2(kept, 1)
                os.close(kept)
                os.close(nowhere)
            return points, cells

        return run

    return prepare


def gmsh_in_space(algorithm: int, netgen: int) -> Callable[[], Callable[[Given], Meshed]]:
    def prepare() -> Callable[[Given], Meshed]:
        import gmsh

        if not gmsh.isInitialized():
            gmsh.initialize(interruptible=False)
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)

        def run(given: Given) -> Meshed:
            gmsh.clear()
            model = gmsh.model
            surface = model.addDiscreteEntity(2)
            model.mesh.addNodes(2, surface, np.arange(1, len(given.points) + 1), given.points.ravel())
            model.mesh.addElementsByType(surface, 2, [], (given.triangles + 1).ravel())
            model.geo.addVolume([model.geo.addSurfaceLoop([surface])])
            model.geo.synchronize()
            number = model.mesh.field.add("MathEval")
            model.mesh.field.setString(number, "F", given.formula)
            model.mesh.field.setAsBackgroundMesh(number)
            options = {"MeshSizeExtendFromBoundary": 0, "MeshSizeFromPoints": 0, "Algorithm3D": algorithm}
            options |= {"Optimize": 1, "OptimizeNetgen": netgen}
            for name, value in options.items():
                gmsh.option.setNumber(f"Mesh.{name}", value)
            model.mesh.generate(3)
            tags, coordinates, _ = model.mesh.getNodes()
            kinds, _, nodes = model.mesh.getElements(3)
            place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
            place[tags.astype(np.int64)] = np.arange(len(tags))
            cells = nodes[list(kinds).index(4)].reshape(-1, 4).astype(np.int64)
            return coordinates.reshape(-1, 3).copy(), place[cells]

        return run

    return prepare


def netgen_in_space() -> Callable[[Given], Meshed]:
    from netgen.meshing import FaceDescriptor, Mesh, MeshingParameters

    def run(given: Given) -> Meshed:
        mesh = Mesh(dim=3)
        mesh.AddPoints(np.array(given.points))
        index = mesh.Add(FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
        mesh.AddElements(dim=2, index=index, data=np.array(given.triangles, dtype=np.int32), base=0)
        mesh.GenerateVolumeMesh(mp=MeshingParameters(maxh=float(given.size)))
        cells = mesh.Elements3D().NumPy()["nodes"][:, :4].astype(np.int64) - 1
        return np.array(mesh.Coordinates()), cells

    return run


MESHERS = [
    *(
        Mesher(name, package, work, prepare)
        for work in ("good", "parts", "graded")
        for name, package, prepare in (
            ("unstruct", "unstruct", _ours(True)),
            ("TetGen pYq1.2a", "tetgen", _tetgen("q1.2")),
            ("Gmsh Delaunay", "gmsh", gmsh_in_space(1, 0)),
            ("Gmsh HXT", "gmsh", gmsh_in_space(10, 0)),
            ("Gmsh + Netgen", "gmsh", gmsh_in_space(1, 1)),
            ("Netgen", "netgen-mesher", netgen_in_space),
        )
        if work != "graded" or package in ("unstruct", "gmsh")  # the others take no formula
    ),
    *(
        Mesher(name, package, work, prepare)
        for work in ("bare", "CAD")
        for name, package, prepare in (
            ("unstruct", "unstruct", _ours(False)),
            ("unstruct, made rounder", "unstruct", _ours(True)),
            ("TetGen pY", "tetgen", _tetgen("")),
        )
    ),
]
