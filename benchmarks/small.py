"""The suite ``small``: what a call costs by itself, on the example files that the package ``triangle`` ships.

Files are read beforehand. Timed is what a caller of arrays pays once all is compiled and imported: the
`Domain` with its checks, the meshing, the mesh. Triangle, which checks nothing, gets the same vertices, the
same segments and points in the holes. One more work has no peer: a square with many round holes.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshers import Mesher, find
from .regions import loop
from .run import Workers, measured

ANGLE = 30.0
SIDE = 8  # round holes in a row, and rows
# The files by the number of their points; of a file that has triangles and no segments we take the boundary.
BARE = {"diamond_02_00009": 9, "dots": 100}  # points alone, within their hull
GRAPHS = {
    "box.1": 8, "spiral.1": 13, "double_hex3": 16, "ell": 16, "face": 26, "A": 29, "box.2": 40,
    "double_hex2": 48, "double_hex": 96, "la": 141, "double_hex2.2": 141, "box.3": 142, "double_hex.2": 525,
    "box.4": 531, "square_circle_hole": 826, "la.1": 860, "greenland": 2559,
}  # fmt: skip
SIZED = {"A": (100, 500, 2000, 6000), "double_hex": (500, 2000, 6000)}  # about as many triangles
FILL = 1.6  # the mean triangle under a bound on the area has about 1/FILL of it

# work -> kinds and sizes: points, but for "sized" about as many triangles
PLAN: dict[str, dict[str, tuple[int, ...]]] = {
    "constrained": {name: (n,) for name, n in sorted((BARE | GRAPHS).items(), key=lambda row: row[1])},
    "refined": {name: (n,) for name, n in GRAPHS.items()},
    "sized": SIZED,
    "round holes": {"coarse": (4 * SIDE**2 + 4,), "refined": (4 * SIDE**2 + 4,)},
}


class Example(NamedTuple):
    """What is to be meshed, as plain arrays."""

    points: NDArray[np.float64]
    facets: NDArray[np.int32]  # none: the hull is meshed
    inner: NDArray[np.int32]
    holes: NDArray[np.float64]  # a point in each, for Triangle
    area: float | None  # the greatest area of a triangle


def example(name: str, area: float | None = None) -> Example:
    """The arrays of an example file. Segments between inside and outside are facets, the others inner."""
    from triangle import get_data

    from unstruct import Domain, Mesh

    data, none = get_data(name), np.empty((0, 2), dtype=np.int32)
    spec = find_spec("triangle")
    assert spec is not None and spec.origin is not None
    holes = np.array(data.get("holes", np.empty((0, 2))))
    if name in BARE:
        return Example(data["vertices"].copy(), none, none, holes, area)
    if "segments" in data:
        region = Domain.read(Path(spec.origin).parent / "data" / f"{name}.poly")
        return Example(region.points.copy(), region.facets.copy(), region.inner.copy(), holes, area)
    rim = Mesh(data["vertices"], data["triangles"]).boundary
    used, rows = np.unique(rim, return_inverse=True)
    return Example(
        data["vertices"][used].copy(), rows.reshape(-1, 2).astype(np.int32), none, np.empty((0, 2)), area
    )


def round_holes(side: int = SIDE) -> dict[str, Any]:
    """A square with so many round holes in a row, and rows, as the arguments of a `Domain`."""
    from unstruct import Arc

    middle = (np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) + 0.5) / side
    radius, quarter = 0.3 / side, np.pi / 2
    turn = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    facets = [loop(4 * k, 4) for k in range(1 + len(middle))]
    arcs = [Arc(x, radius, k * quarter, quarter) for x in middle for k in range(4)]
    return {
        "points": np.concatenate([square, (middle[:, None] + radius * turn).reshape(-1, 2)]),
        "facets": np.concatenate(facets),
        "curves": {4 + i: arc for i, arc in enumerate(arcs)},
    }


# ---------------------------------------------------------------------- who takes part


def _constrained() -> Callable[[Any], Any]:
    from unstruct import Domain, constrained_delaunay

    def run(given: Any) -> Any:
        domain = Domain(given.points, given.facets, inner=given.inner)
        mesh = constrained_delaunay(domain, hull=len(given.facets) == 0)
        return mesh.points, mesh.simplices

    return run


def _refined() -> Callable[[Any], Any]:
    from unstruct import Domain, refine

    def run(given: Any) -> Any:
        domain = Domain(given.points, given.facets, inner=given.inner)
        mesh = refine(domain, min_angle=ANGLE, max_area=given.area)
        return mesh.points, mesh.simplices

    return run


def _holed() -> Callable[[Any], Any]:
    from unstruct import Domain, constrained_delaunay, refine

    def run(given: Any) -> Any:
        parts, finer = given
        domain = Domain(**parts)
        mesh = refine(domain, min_angle=ANGLE) if finer else constrained_delaunay(domain)
        return mesh.points, mesh.simplices

    return run


def _triangle(quality: str) -> Callable[[], Callable[[Any], Any]]:
    def prepare() -> Callable[[Any], Any]:
        from triangle import triangulate

        def run(given: Any) -> Any:
            if not len(given.facets):
                made = triangulate({"vertices": given.points}, "c")
                return made["vertices"], made["triangles"]
            graph = {"vertices": given.points, "segments": np.concatenate([given.facets, given.inner])}
            if len(given.holes):
                graph["holes"] = given.holes
            made = triangulate(graph, f"p{quality}" + ("" if given.area is None else f"a{given.area:.12f}"))
            return made["vertices"], made["triangles"]

        return run

    return prepare


MESHERS = [
    Mesher("unstruct", "unstruct", "constrained", _constrained),
    Mesher("Triangle p", "triangle", "constrained", _triangle("")),
    *(
        each
        for work in ("refined", "sized")
        for each in (
            Mesher("unstruct", "unstruct", work, _refined),
            Mesher("Triangle pq30", "triangle", work, _triangle(f"q{ANGLE:.0f}")),
        )
    ),
    Mesher("unstruct", "unstruct", "round holes", _holed),
]


# ---------------------------------------------------------------------- the run


def task(work: str, kind: str, n: int) -> Any:
    """What the meshers of a work are given."""
    if work == "round holes":
        return round_holes(), kind == "refined"
    if work == "sized":
        from unstruct import Domain

        whole = example(kind)
        area = Domain(whole.points, whole.facets, inner=whole.inner).area
        return whole._replace(area=FILL * area / n)
    return example(kind)


def warm_up(work: str) -> Any:
    """A small task of the same kind: compiled code is loaded, lazy imports are done."""
    return (round_holes(1), False) if work == "round holes" else example("face")


def run(workers: Workers, largest: int, repeats: int) -> list[dict[str, Any]]:
    """All rows of the suite, up to ``largest`` points or triangles."""
    rows: list[dict[str, Any]] = []
    for work, kinds in PLAN.items():
        for kind, sizes in kinds.items():
            for n in sizes:
                if n <= largest:
                    case = {"suite": "small", "work": work, "kind": kind, "n": n}
                    expected = {mesher.name: 0.0 for mesher, _ in find(work, MESHERS)}
                    rows += measured(workers, "meshed", case, expected, repeats)
    return rows
