"""Layers along a wing and its flap beside Gmsh's BoundaryLayer field: ``python -m benchmarks.layers``.

Both methods get the same points on the walls, the same first height and growth, and the same size beyond.
Their times are taken in turn in one process, of the processor; the ratio is that of the medians. For each
mesh the table also has the largest angle, the least angle and the mean of 2 r / R where there are no layers
(triangles whose longest side is at most twice the shortest altitude's base, for Gmsh, which does not say
which triangles are its layers), and the 99 % quantile of the ratio of areas of neighbors.
"""

from __future__ import annotations

import statistics
import time
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

SPACINGS, SIZE_GROWTH, FAR, RATIO = (0.01, 0.002), 0.25, 1.0, 1.2  # along the walls, in chords
FIRST = (1e-3, 1e-4, 1e-5)
STRETCHED = 3.0  # triangles with a larger quotient of circumradius and twice the inradius count as layers


class Judged(NamedTuple):
    """What is told of one mesh."""

    cells: int
    largest: float
    least: float
    mean: float
    areas: float


def wing(spacing: float) -> tuple[Any, Any, Any]:
    """The domain, its size, and its sampled walls: the rows of subsegments that belong to the wing."""
    from unstruct import examples, sizing

    domain = examples.wing_with_flap()
    sampled = domain.sampled(spacing)
    pieces = np.concatenate([domain.markers["upper"], domain.markers["lower"]])
    rows = np.isin(sampled.piece, pieces)
    sources = sampled.points[sampled.ends[rows]]
    return domain, sizing.sources(sources, spacing, growth=SIZE_GROWTH, far=FAR), sampled


def ours(domain: Any, size: Any, first: float, stop: str = "nearest") -> Any:
    """The mesh of `advancing_layers`."""
    from unstruct import Layers, advancing_layers

    layers = Layers(first=first, growth=RATIO)
    return advancing_layers(domain, size, layers=layers, walls=["upper", "lower"], stop=stop)


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
    return Outline(
        sampled.points, sampled.ends, wall, rings(sampled.ends), trailing(domain, sampled, wall)
    )


def gmsh(given: Outline, first: float, spacing: float) -> tuple[float, NDArray, NDArray]:
    """The time of Gmsh's mesh with a BoundaryLayer field, its points and triangles.

    The size is that of `wing`: sources at the vertices of the walls. A Distance field of the lines between
    them, with Sampling 2, would have no point at all, and the rest would be as coarse as ``FAR`` permits.
    """
    import gmsh as peer

    if not peer.isInitialized():
        peer.initialize(interruptible=False)
        peer.option.setNumber("General.Terminal", 0)
    before = time.process_time()
    peer.clear()
    geo, field, used = peer.model.geo, peer.model.mesh.field, np.unique(given.ends)
    tag = {v: geo.addPoint(*given.points[v].tolist(), 0) for v in used.tolist()}
    lines = [geo.addLine(tag[a], tag[b]) for a, b in given.ends.tolist()]
    geo.addPlaneSurface([geo.addCurveLoop([int(s * lines[i]) for i, s in loop]) for loop in given.loops])
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    geo.synchronize()
    for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        peer.option.setNumber(f"Mesh.MeshSize{name}", 0)
    distance, wanted = field.add("Distance"), field.add("Threshold")
    field.setNumbers(distance, "PointsList", [tag[v] for v in np.unique(given.ends[given.wall]).tolist()])
    for name, value in (
        ("InField", distance), ("SizeMin", spacing), ("SizeMax", FAR), ("DistMin", 0),
        ("DistMax", (FAR - spacing) / SIZE_GROWTH),
    ):  # fmt: skip
        field.setNumber(wanted, name, value)
    field.setAsBackgroundMesh(wanted)
    layer = field.add("BoundaryLayer")
    field.setNumbers(layer, "CurvesList", [line for line, wall in zip(lines, given.wall) if wall])
    for name, value in (
        ("Size", first), ("Ratio", RATIO), ("Thickness", spacing * RATIO / (RATIO - 1)), ("Quads", 0),
    ):  # fmt: skip
        field.setNumber(layer, name, value)
    field.setNumbers(layer, "FanPointsList", [tag[v] for v in given.sharp])
    field.setAsBoundaryLayer(layer)
    peer.option.setNumber("Mesh.Algorithm", 6)
    peer.model.mesh.generate(2)
    tags, coordinates, _ = peer.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    kinds, _, nodes = peer.model.mesh.getElements(2)
    triangles = nodes[list(kinds).index(2)].reshape(-1, 3).astype(np.int64)
    taken = time.process_time() - before
    return taken, coordinates.reshape(-1, 3)[:, :2], place[triangles]


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


def judged(points: NDArray[np.float64], triangles: NDArray[np.int64], rest: Any = None) -> Judged:
    """Angles, roundness and neighbors of a mesh; ``rest`` says which triangles are no layers."""
    from unstruct import Mesh

    mesh = Mesh(points, triangles).oriented()
    area = mesh.volumes
    x = mesh.points[mesh.simplices]
    sides = [np.hypot(*(x[:, k] - x[:, k - 1]).T) for k in range(3)]
    round_ = 8 * area**2 / (sum(sides) / 2 * sides[0] * sides[1] * sides[2])  # 2 r / R
    rest = round_ > 1 / STRETCHED if rest is None else rest
    t, i = np.nonzero(mesh.neighbors >= 0)
    ratio = area[t] / area[mesh.neighbors[t, i]]
    return Judged(
        mesh.size,
        float(mesh.quality("max_angle").max()),
        float(mesh.quality("min_angle")[rest].min()),
        float(round_[rest].mean()),
        float(np.quantile(np.maximum(ratio, 1 / ratio), 0.99)),
    )


def rows(repeats: int = 5) -> list[dict[str, Any]]:
    """One row for each first height and each method."""
    found = []
    for spacing, first in product(SPACINGS, FIRST):
        domain, size, _ = wing(spacing)
        given = outline(domain, size)
        ours(domain, size, first)  # compiled before it is timed
        times: dict[str, list[float]] = {"nearest": [], "spring": [], "gmsh": []}
        meshes: dict[str, Judged] = {}
        for _ in range(repeats):
            for stop in ("nearest", "spring"):
                before = time.process_time()
                mesh = ours(domain, size, first, stop)
                times[stop].append(time.process_time() - before)
                meshes[stop] = judged(mesh.points, mesh.simplices, mesh.steps["cell_layer"] == 0)
            taken, points, triangles = gmsh(given, first, spacing)
            times["gmsh"].append(taken)
            meshes["gmsh"] = judged(points, triangles)
        peer = statistics.median(times["gmsh"])
        for name, each in times.items():
            own = statistics.median(each)
            row = {"spacing": spacing, "first": first, "method": name, "seconds": own}
            found.append(row | {"times as fast": peer / own} | meshes[name]._asdict())
    return found


def main() -> None:
    """Print the table."""
    for row in rows():
        print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()))


if __name__ == "__main__":
    main()
