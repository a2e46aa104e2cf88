"""The suite ``layers``: layers along a wing and its flap beside Gmsh, and stretched cells beside MMG.

*Layers.* Both methods get the same points on the walls, the same first height and growth, and the same size
beyond. The time of Gmsh includes that of its geometry and fields, but not that of the points on the walls,
which we compute in ours. Of a mesh the rows have the largest angle, the least angle and the mean of 2 r / R
where there are no layers (for Gmsh, which does not say which triangles are its layers: of triangles that are
not stretched), and the 99 % quantile of the ratio of areas of neighbors.

*Stretched cells.* A square, in a metric whose direction turns, with cells ten times as long as wide. MMG, if
`mmgpy` is installed, remeshes an isotropic mesh once, by the metric at its vertices.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher, find
from .run import Workers, measured

SIZE_GROWTH, FAR, RATIO = 0.25, 1.0, 1.2
STRETCHED = 3.0  # triangles with a larger quotient of circumradius and twice the inradius count as layers
ALONG = 10.0  # times as long as wide are stretched cells
# work -> kind -> the rough number of triangles; kinds of layers: spacing of the walls and first height
PLAN: dict[str, dict[str, int]] = {
    "layers": {
        "1e-2 1e-3": 12_000, "1e-2 1e-4": 19_000, "1e-2 1e-5": 26_000,
        "2e-3 1e-3": 29_000, "2e-3 1e-4": 63_000, "2e-3 1e-5": 96_000,
        "2.5e-4 1e-6": 780_000,
    },
    "stretched": {"turning": 23_000, "turning, finer": 210_000},
}  # fmt: skip
LENGTHS = {"turning": 0.01, "turning, finer": 0.0033}  # the geometric means of the two wanted ones
COARSE_LENGTH = 0.05  # of the tasks that load compiled code

Meshed = tuple[NDArray, NDArray, Any]  # points, triangles, and which of them are no layers (None: not known)
__all__ = ["MESHERS", "PLAN", "measures", "run", "task", "warm_up"]


class Outline(NamedTuple):
    """What Gmsh is given, prepared before its time starts."""

    points: NDArray[np.float64]
    ends: NDArray[np.int32]
    wall: NDArray[np.bool_]
    loops: list[list[tuple[int, int]]]
    sharp: list[int]


def outline(domain: Any, size: Any) -> Outline:
    """The subsegments of the boundary, as `advancing_layers` has them, and which of them are walls."""
    sampled = domain.sampled(size)
    wall = np.isin(sampled.piece, np.concatenate([domain.markers["upper"], domain.markers["lower"]]))
    return Outline(sampled.points, sampled.ends, wall, rings(sampled.ends), trailing(domain, sampled, wall))


def rings(ends: NDArray[np.int32]) -> list[list[tuple[int, int]]]:
    """Closed chains of segments: (segment, direction)."""
    at: dict[int, list[int]] = {}
    for i, pair in enumerate(ends.tolist()):
        for v in pair:
            at.setdefault(v, []).append(i)
    left, found = set(range(len(ends))), []
    while left:
        i, v = min(left), int(ends[min(left), 0])
        loop = []
        while i in left:
            left.remove(i)
            a, b = ends[i].tolist()
            loop.append((i, 1 if a == v else -1))
            v = b if a == v else a
            i = next((j for j in at[v] if j in left), i)
        found.append(loop)
    return found


def trailing(domain: Any, sampled: Any, on_wall: NDArray[np.bool_]) -> list[int]:
    """Vertices of walls where the body is sharper than a right angle."""
    ends = sampled.ends[on_wall]
    found = []
    for v in np.unique(ends).tolist():
        rows = ends[(ends == v).any(axis=1)]
        u = sampled.points[np.where(rows[:, 0] == v, rows[:, 1], rows[:, 0])] - sampled.points[v]
        u /= np.hypot(*u.T)[:, None]
        if len(u) == 2 and u[0] @ u[1] > 0.0:
            found.append(v)
    return found


class Wing(NamedTuple):
    """A task: what is prepared before any time starts."""

    domain: Any
    size: Any
    outline: Outline
    spacing: float
    first: float


def wing(spacing: float, first: float) -> Wing:
    """The wing with its flap. The size is that of sources at the vertices of the walls."""
    from unstruct import examples, sizing

    domain = examples.wing_with_flap()
    sampled = domain.sampled(spacing)
    pieces = np.concatenate([domain.markers["upper"], domain.markers["lower"]])
    sources = sampled.points[sampled.ends[np.isin(sampled.piece, pieces)]]
    size = sizing.sources(sources, spacing, growth=SIZE_GROWTH, far=FAR)
    return Wing(domain, size, outline(domain, size), spacing, first)


def _ours(stop: str) -> Callable[[], Callable[[Wing], Meshed]]:
    def prepare() -> Callable[[Wing], Meshed]:
        from unstruct import Layers, advancing_layers

        def run(given: Wing) -> Meshed:
            layers = Layers(first=given.first, growth=RATIO)
            mesh = advancing_layers(
                given.domain, given.size, layers=layers, walls=["upper", "lower"], stop=stop
            )
            assert mesh.steps is not None
            return mesh.points, mesh.simplices, mesh.steps["cell_layer"] == 0

        return run

    return prepare


def _gmsh() -> Callable[[Wing], Meshed]:
    """Gmsh with a BoundaryLayer field.

    The size is that of `wing`: sources at the vertices of the walls. A Distance field of the lines between
    them, with Sampling 2, would have no point at all, and the rest would be as coarse as ``FAR`` permits.
    """
    import gmsh as peer

    if not peer.isInitialized():
        peer.initialize(interruptible=False)
        peer.option.setNumber("General.Terminal", 0)

    def run(given: Wing) -> Meshed:
        edges, spacing, first = given.outline, given.spacing, given.first
        peer.clear()
        geo, field, used = peer.model.geo, peer.model.mesh.field, np.unique(edges.ends)
        tag = {v: geo.addPoint(*edges.points[v].tolist(), 0) for v in used.tolist()}
        lines = [geo.addLine(tag[a], tag[b]) for a, b in edges.ends.tolist()]
        geo.addPlaneSurface([geo.addCurveLoop([int(s * lines[i]) for i, s in loop]) for loop in edges.loops])
        for line in lines:
            geo.mesh.setTransfiniteCurve(line, 2)
        geo.synchronize()
        for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            peer.option.setNumber(f"Mesh.MeshSize{name}", 0)
        distance, wanted = field.add("Distance"), field.add("Threshold")
        field.setNumbers(distance, "PointsList", [tag[v] for v in np.unique(edges.ends[edges.wall]).tolist()])
        for name, value in (
            ("InField", distance), ("SizeMin", spacing), ("SizeMax", FAR), ("DistMin", 0),
            ("DistMax", (FAR - spacing) / SIZE_GROWTH),
        ):  # fmt: skip
            field.setNumber(wanted, name, value)
        field.setAsBackgroundMesh(wanted)
        layer = field.add("BoundaryLayer")
        field.setNumbers(layer, "CurvesList", [line for line, wall in zip(lines, edges.wall) if wall])
        for name, value in (
            ("Size", first), ("Ratio", RATIO), ("Thickness", spacing * RATIO / (RATIO - 1)), ("Quads", 0),
        ):  # fmt: skip
            field.setNumber(layer, name, value)
        field.setNumbers(layer, "FanPointsList", [tag[v] for v in edges.sharp])
        field.setAsBoundaryLayer(layer)
        peer.option.setNumber("Mesh.Algorithm", 6)
        peer.model.mesh.generate(2)
        tags, coordinates, _ = peer.model.mesh.getNodes()
        place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        place[tags.astype(np.int64)] = np.arange(len(tags))
        kinds, _, nodes = peer.model.mesh.getElements(2)
        triangles = nodes[list(kinds).index(2)].reshape(-1, 3).astype(np.int64)
        return coordinates.reshape(-1, 3)[:, :2], place[triangles], None

    return run


# ---------------------------------------------------------------------- stretched cells


class Square(NamedTuple):
    """A task: the unit square and a metric; and an isotropic mesh of as many triangles, for MMG."""

    domain: Any
    metric: Any
    points: NDArray
    triangles: NDArray


def square(length: float) -> Square:
    """The direction turns; ``length`` is the geometric mean of the two wanted lengths."""
    from unstruct import Domain, advancing_front, sizing

    domain = Domain.rectangle()
    metric = sizing.directional(_direction, length * ALONG**0.5, length / ALONG**0.5)
    mesh = advancing_front(domain, length)
    return Square(domain, metric, mesh.points.copy(), mesh.simplices.copy())


def _direction(x: NDArray) -> NDArray:
    return np.stack([np.ones(len(x)), 0.6 * np.cos(3 * x[:, 0])], axis=1)


def _front() -> Callable[[Square], Meshed]:
    from unstruct import advancing_front

    def run(given: Square) -> Meshed:
        mesh = advancing_front(given.domain, given.metric)
        return mesh.points, mesh.simplices, None

    return run


def _mmg() -> Callable[[Square], Meshed]:
    from mmgpy import MmgMesh2D

    def run(given: Square) -> Meshed:
        mesh = MmgMesh2D(given.points, given.triangles)
        m = given.metric.at(given.points)
        mesh.set_field("tensor", np.column_stack([m[:, 0, 0], m[:, 0, 1], m[:, 1, 1]]))
        mesh.remesh(hgrad=-1.0, verbose=-1)
        return mesh.get_vertices(), mesh.get_triangles(), None

    return run


# ---------------------------------------------------------------------- the run

MESHERS = [
    Mesher("unstruct", "unstruct", "layers", _ours("nearest")),
    Mesher("unstruct, springs", "unstruct", "layers", _ours("spring")),
    Mesher("Gmsh BoundaryLayer", "gmsh", "layers", _gmsh),
    Mesher("unstruct", "unstruct", "stretched", _front),
    Mesher("MMG", "mmgpy", "stretched", _mmg),
]


def task(work: str, kind: str, n: int) -> Any:
    """What the meshers of a work are given."""
    return square(LENGTHS[kind]) if work == "stretched" else wing(*map(float, kind.split()))


def warm_up(work: str) -> Any:
    """A small task of the same kind: compiled code is loaded, lazy imports are done."""
    return square(COARSE_LENGTH) if work == "stretched" else wing(COARSE_LENGTH, COARSE_LENGTH / 10)


def measures(points: NDArray, triangles: NDArray, rest: Any, work: str, given: Any) -> dict[str, Any]:
    """Numbers that tell how good a mesh is; see above."""
    from unstruct import Mesh, check

    mesh = Mesh(points, triangles).oriented()
    found: dict[str, Any] = {"cells": mesh.size, "max_angle": float(mesh.quality("max_angle").max())}
    if work == "stretched":
        from unstruct.assess.statistics import statistics

        seen = statistics(mesh, given.metric)
        metric = {"conforming": float(seen.conforming), "mean_metric": float(seen.mean_metric)}
        return found | metric | {"valid": bool(check(mesh))}
    area, round_ = mesh.volumes, mesh.quality("2r/R")
    rest = round_ > 1 / STRETCHED if rest is None else rest
    t, i = np.nonzero(mesh.neighbors >= 0)
    ratio = area[t] / area[mesh.neighbors[t, i]]
    return found | {
        "layer_cells": int((~rest).sum()),
        "min_angle": float(mesh.quality("min_angle")[rest].min()),
        "mean_2r_R": float(round_[rest].mean()),
        "area_ratio": float(np.quantile(np.maximum(ratio, 1 / ratio), 0.99)),
    }


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` triangles."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, n in kinds.items():
            if n <= largest:
                case = {"suite": "layers", "work": work, "kind": kind, "n": n}
                expected = {mesher.name: 0.0 for mesher, _ in find(work, MESHERS)}
                rows += measured(workers, "meshed", case, expected, repeats)
    return rows
