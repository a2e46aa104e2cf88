"""The contestants of the planar suite. Each mesher takes plain data and gives (points, triangles) as arrays.

There are four kinds of work: "constrained" (a graph of segments), "refined" (minimum angle and maximum area,
the same flags for all), "uniform" and "graded" (the square with the round hole, a wanted edge length).
Meshers that are not installed are skipped; the library itself never imports any of its peers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .contestants import installed
from .regions import CENTER, FINEST, GROWTH, RADIUS, Graph, graded

Meshed = tuple[NDArray[np.float64], NDArray[np.integer]]
ANGLE = 30.0


class Mesher(NamedTuple):
    """A library, the name of its package, the work that it does, and how to call it."""

    name: str
    package: str
    work: str
    prepare: Callable[[], Callable[[Any], Meshed]]


def several(run: Callable[[Any], Any]) -> Callable[[], Callable[[Any], Any]]:
    """What prepares a contestant that also takes a list of tasks; the result of the last one counts."""

    def every(given: Any) -> Any:
        return [run(one) for one in (given if isinstance(given, list) else [given])][-1]

    return lambda: every


# ---------------------------------------------------------------------- ours


def _constrained() -> Callable[[Graph], Meshed]:
    from unstruct import Domain, constrained_delaunay

    def run(graph: Graph) -> Meshed:
        domain = Domain(graph.points, np.empty((0, 2), dtype=np.int32), inner=graph.segments)
        mesh = constrained_delaunay(domain, hull=True)
        return mesh.points, mesh.simplices

    return run


def _refine() -> Callable[[tuple[Graph, float]], Meshed]:
    from unstruct import Domain, refine

    def run(work: tuple[Graph, float]) -> Meshed:
        graph, area = work
        mesh = refine(Domain(graph.points, graph.segments), min_angle=ANGLE, max_area=area)
        return mesh.points, mesh.simplices

    return run


def holed_square() -> Any:
    """The unit square with a hole that is a true circle, as a `Domain`."""
    from unstruct import Domain
    from unstruct.geometry.curves import Arc

    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    circle = CENTER + RADIUS * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    facets = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]])
    curves = {4 + k: Arc(CENTER, RADIUS, k * np.pi / 2, np.pi / 2) for k in range(4)}
    return Domain(np.concatenate([square, circle]), facets, curves=curves)


def _segment(finish: bool) -> Callable[[], Callable[[float | None], Meshed]]:
    def prepare() -> Callable[[float | None], Meshed]:
        from unstruct import voronoi_segment

        def run(edge: float | None) -> Meshed:
            mesh = voronoi_segment(holed_square(), graded if edge is None else edge, finish=finish)
            return mesh.points, mesh.simplices

        return run

    return prepare


# ---------------------------------------------------------------------- peers


def _triangle(flags: str) -> Callable[[], Callable[[Any], Meshed]]:
    def prepare() -> Callable[[Any], Meshed]:
        from triangle import triangulate

        def run(work: Any) -> Meshed:
            graph, area = work if isinstance(work, tuple) and not isinstance(work, Graph) else (work, None)
            given = {"vertices": graph.points, "segments": graph.segments}
            if graph.hole is not None:
                given["holes"] = graph.hole[None]
            made = triangulate(given, flags if area is None else f"{flags}a{area:.12f}")
            return made["vertices"], made["triangles"]

        return run

    return prepare


def _meshpy() -> Callable[[tuple[Graph, float]], Meshed]:
    from meshpy.triangle import MeshInfo, build

    def run(work: tuple[Graph, float]) -> Meshed:
        graph, area = work
        info = MeshInfo()
        info.set_points(graph.points)
        info.set_facets(graph.segments)
        if graph.hole is not None:
            info.set_holes([graph.hole])
        mesh = build(info, max_volume=area, min_angle=ANGLE)
        return np.array(mesh.points), np.array(mesh.elements)

    return run


def _pythoncdt() -> Callable[[Graph], Meshed]:
    import pythoncdt as cdt

    def run(graph: Graph) -> Meshed:
        made = cdt.Triangulation(
            cdt.VertexInsertionOrder.AUTO, cdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
        )
        made.insert_vertices(graph.points)
        made.insert_edges(graph.segments.astype(np.uint32))
        made.erase_super_triangle()
        return graph.points, made.triangles_array()["vertices"]

    return run


def _gmsh(algorithm: int) -> Callable[[], Callable[[float | None], Meshed]]:
    def prepare() -> Callable[[float | None], Meshed]:
        import gmsh

        if not gmsh.isInitialized():
            gmsh.initialize(interruptible=False)
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)

        def run(edge: float | None) -> Meshed:
            gmsh.clear()
            geo = gmsh.model.geo
            corner = [geo.addPoint(x, y, 0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
            sides = [geo.addLine(corner[k], corner[(k + 1) % 4]) for k in range(4)]
            center = geo.addPoint(*CENTER, 0)
            ring = [geo.addPoint(0.5 + RADIUS * x, 0.5 + RADIUS * y, 0)
                    for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]  # fmt: skip
            arcs = [geo.addCircleArc(ring[k], center, ring[(k + 1) % 4]) for k in range(4)]
            geo.addPlaneSurface([geo.addCurveLoop(sides), geo.addCurveLoop(arcs)])
            geo.synchronize()
            for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
                gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
            field = gmsh.model.mesh.field
            number = field.add("MathEval")
            distance = f"Fabs(Sqrt((x-0.5)*(x-0.5)+(y-0.5)*(y-0.5))-{RADIUS})"
            field.setString(number, "F", f"{FINEST}+{GROWTH}*{distance}" if edge is None else f"{edge:.12f}")
            field.setAsBackgroundMesh(number)
            gmsh.option.setNumber("Mesh.Algorithm", algorithm)
            gmsh.model.mesh.generate(2)
            tags, coordinates, _ = gmsh.model.mesh.getNodes()
            (cells,) = gmsh.model.mesh.getElements(2)[2]
            place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
            place[tags] = np.arange(len(tags))
            return coordinates.reshape(-1, 3)[:, :2].copy(), place[cells].reshape(-1, 3)

        return run

    return prepare


def _netgen() -> Callable[[float | None], Meshed]:
    from netgen.geom2d import SplineGeometry
    from netgen.meshing import Element2D  # noqa: F401 (registers the array views)

    def run(edge: float | None) -> Meshed:
        geometry = SplineGeometry()
        geometry.AddRectangle((0, 0), (1, 1), leftdomain=1, rightdomain=0)
        geometry.AddCircle(tuple(CENTER), RADIUS, leftdomain=0, rightdomain=1)
        mesh = geometry.GenerateMesh(maxh=edge)
        cells = mesh.Elements2D().NumPy()["nodes"][:, :3].astype(np.int64) - 1
        return mesh.Coordinates()[:, :2].copy(), cells

    return run


MESHERS = [
    Mesher("unstruct", "unstruct", "constrained", _constrained),
    Mesher("Triangle p", "triangle", "constrained", _triangle("pc")),
    Mesher("CDT (C++)", "pythoncdt", "constrained", _pythoncdt),
    Mesher("unstruct", "unstruct", "refined", _refine),
    Mesher("Triangle pq30a", "triangle", "refined", _triangle(f"pq{ANGLE:.0f}")),
    Mesher("MeshPy's Triangle", "meshpy", "refined", _meshpy),
    *(
        Mesher(name, package, work, prepare)
        for work in ("uniform", "graded")
        for name, package, prepare in (
            ("unstruct", "unstruct", _segment(True)),
            ("unstruct, unfinished", "unstruct", _segment(False)),
            ("Gmsh 6", "gmsh", _gmsh(6)),
            ("Gmsh 5", "gmsh", _gmsh(5)),
        )
    ),
    Mesher("Netgen", "netgen-mesher", "uniform", _netgen),
]


def find(work: str, meshers: list[Mesher] = MESHERS) -> list[tuple[Mesher, str]]:
    """The meshers that do this work and are installed, with their versions."""
    there = installed(each.package for each in meshers)
    return [(m, there[m.package]) for m in meshers if m.package in there and m.work == work]
