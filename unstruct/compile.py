"""``python -m unstruct.compile``: compile all kernels at once, on all cores, with a progress bar.

Kernels are compiled at their first call and kept on disk, once for a machine and a version. This command
makes these calls, on tiny inputs, so that later ones do not wait. What is on disk already is only read.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed

import numpy as np
from tqdm import tqdm

import unstruct

from .connect.planar.renumbering import renumber
from .generate.boundary.constrained import planar_complex

__all__ = ["TASKS", "main"]


def _points(d: int) -> np.ndarray:
    return np.random.default_rng(0).random((30, d))


def _ring() -> unstruct.Domain:
    """A region with a hole, an arc, an inner segment and a name."""
    outer = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    hole = np.array([[1.0, 1.0], [2.0, 1.0], [1.5, 2.0]])
    corners = np.vstack([outer, hole, [[3.0, 1.0], [3.0, 2.0]]])
    facets = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4]]
    bow = unstruct.Arc.through([0, 0], [2, -0.5], [4, 0])
    return unstruct.Domain(corners, facets, inner=[[7, 8]], curves={0: bow}, regions={"all": [0.5, 0.5]})


def _grid(x: np.ndarray) -> np.ndarray:
    return 0.4 + 0.1 * x[:, 0]


def _plane() -> None:
    triangulation = unstruct.Triangulation(_points(2))
    triangulation.insert([[0.5, 0.5]])
    triangulation.remove(3)
    unstruct.check(unstruct.delaunay(_points(2)), delaunay=True)


def _space() -> None:
    mesh = unstruct.delaunay(_points(3))
    unstruct.Triangulation(_points(3)).insert([[0.5, 0.5, 0.5]])
    unstruct.check(mesh, delaunay=True)


def _bodies() -> None:
    body = unstruct.Domain.box((0, 0, 0), (1, 1, 1), regions={"all": [0.5, 0.4, 0.5]})
    unstruct.check(unstruct.constrained_delaunay(body), domain=body)
    unstruct.check(unstruct.tetrahedralize(unstruct.Domain.ball(size=0.9), 0.9))


def _body_points() -> None:
    body = unstruct.Domain.box((0, 0, 0), (1, 1, 1))
    unstruct.refine(body, 0.6, min_dihedral=5)
    unstruct.circumcenter_insertion(body, 0.6)
    unstruct.voronoi_segment(body, 0.6)


def _delaunay_surfaces() -> None:
    surface = unstruct.Mesh(_ball().points, _ball().facets)
    unstruct.check(unstruct.surface_delaunay(surface), domain=surface)
    unstruct.surface_delaunay(surface, 0.5)
    unstruct.curvature(surface)


def _many_dimensions() -> None:
    unstruct.delaunay(_points(4))


def _constrained() -> None:
    mesh = unstruct.constrained_delaunay(_ring())
    unstruct.check(mesh, domain=_ring(), delaunay="constrained")


def _conforming() -> None:
    unstruct.conforming_delaunay(_ring())


def _voronoi() -> None:
    unstruct.voronoi(_points(2)).areas()
    unstruct.voronoi(_points(3))


def _refine() -> None:
    mesh = unstruct.refine(_ring(), 0.5, min_angle=25)
    unstruct.statistics(mesh, 0.5)
    mesh.quality("min_angle")
    unstruct.refine(_ring(), _grid)
    unstruct.refine(mesh, 0.4)


def _segments() -> None:
    unstruct.voronoi_segment(_ring(), 0.5)
    unstruct.voronoi_segment(_ring(), _grid)
    renumber(planar_complex(_ring()), 0)  # as for large meshes


def _in_parts() -> None:
    unstruct.mesh_parts(_ring(), 0.05, 2)


def _fronts() -> None:
    unstruct.advancing_front(_ring(), 0.5)
    unstruct.advancing_front(_ring(), _grid)
    unstruct.front_delaunay(_ring(), 0.5)


def _fronts_in_space() -> None:
    body = unstruct.Domain.box((0, 0, 0), (1, 1, 1))
    unstruct.advancing_front(body, 0.6, method="classical")
    unstruct.advancing_front(body, _grid, method="classical", finish=False)
    unstruct.advancing_front(unstruct.examples.stuck_body(), 2.0, method="classical", finish=False)
    unstruct.front_delaunay(body, [[0.4, 0.5, 0.6], [0.5, 0.3, 0.4]])
    unstruct.advancing_front(body, 0.6)
    unstruct.advancing_front(body, _grid, history=True)
    metric = unstruct.sizing.directional_space([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0.6, 0.6, 0.3])
    mesh = unstruct.advancing_front(body, unstruct.sizing.intersection_space(metric, 0.5))
    at_vertices = unstruct.sizing.metric_background(mesh, metric.at(mesh.points))
    for space in ("metric", "space"):
        at_vertices = unstruct.sizing.gradation(at_vertices, 0.5, space=space)
    unstruct.advancing_front(body, at_vertices)


def _metrics() -> None:
    metric = unstruct.sizing.directional([1, 1], _grid, 0.2)
    mesh = unstruct.advancing_front(_ring(), unstruct.sizing.intersection(metric, 0.5))
    metric.table([0, 0], [1, 1]).inverses([[0.5, 0.5]])
    unstruct.sizing.gradation(unstruct.sizing.metric_background(mesh, metric.at(mesh.points)), 0.5)


def _circumcenters() -> None:
    unstruct.circumcenter_insertion(_ring(), 0.5)


def _smooth() -> None:
    mesh = unstruct.constrained_delaunay(_ring())
    unstruct.smooth(mesh, rounds=1)
    unstruct.swap_diagonals(unstruct.delaunay(_points(2)))


def _gift_wrap() -> None:
    unstruct.gift_wrap(_points(2))
    unstruct.gift_wrap(_points(3))


def _quads() -> None:
    unstruct.quadrilaterals(_ring(), 0.2)
    unstruct.recombine(unstruct.refine(_ring(), 0.3))


def _insert() -> None:
    for d in (2, 3):
        unstruct.insert(unstruct.delaunay(_points(d)), [0.5] * d)


def _trees() -> None:
    for tree in (unstruct.quadtree(_ring(), _grid, turning=60, max_level=6), unstruct.octree(_ball(), 0.5)):
        tree.nearest(tree.centers[:1])
        tree.in_box(*tree.box)
        tree.mesh("conforming")
        len(tree.hanging.vertices)
        for kind in ("fitted", "quads", "warped") if tree.dimension == 2 else ():
            tree.mesh(kind)
    unstruct.octree(_ball(), boundary_size=0.8, growth=0.5, turning=60, points=[[0.5, 0.5, 0.5]])


def _ball() -> unstruct.Domain:
    return unstruct.Domain.ball(size=0.9)


def _surfaces() -> None:
    unstruct.remesh(unstruct.Domain.cylinder(), 0.4)
    unstruct.remesh(unstruct.Domain.ball(), lambda x: 0.5 + 0.1 * x[:, 0])


def _sizes() -> None:
    size = unstruct.sizing.from_features(_ring(), 0.5, far=0.6)
    unstruct.refine(_ring(), size)


# The longest first; what others need before them.
TASKS: dict[str, Callable[[], None]] = {
    "the plane": _plane,
    "space": _space,
    "refine": _refine,
    "bodies": _bodies,
    "points in bodies": _body_points,
    "Voronoi segments": _segments,
    "in parts": _in_parts,
    "advancing fronts": _fronts,
    "advancing fronts in space": _fronts_in_space,
    "metrics": _metrics,
    "insertion": _insert,
    "gift wrapping": _gift_wrap,
    "Voronoi diagrams": _voronoi,
    "constrained triangulation": _constrained,
    "conforming triangulation": _conforming,
    "circumcenters": _circumcenters,
    "smoothing": _smooth,
    "quadrilaterals": _quads,
    "trees": _trees,
    "Delaunay surfaces": _delaunay_surfaces,
    "sizes": _sizes,
    "surfaces": _surfaces,
    "higher dimensions": _many_dimensions,
}


def _run(name: str) -> str:
    TASKS[name]()
    return name


def main(arguments: list[str] | None = None) -> int:
    """Run all tasks, or those that are named; 1 if one failed, which is printed."""
    names = (sys.argv[1:] if arguments is None else arguments) or list(TASKS)
    unknown = [name for name in names if name not in TASKS]
    if unknown:
        print(f"unknown: {', '.join(unknown)}; there are: {', '.join(TASKS)}", file=sys.stderr)
        return 2
    begin, failed = time.perf_counter(), 0
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=fresh) as pool:
        waiting = {pool.submit(_run, name): name for name in names}
        with tqdm(total=len(names), desc="compiling", unit="task", disable=None) as bar:
            for done in as_completed(waiting):
                bar.set_postfix_str(waiting[done])
                bar.update()
                if (error := done.exception()) is not None:
                    failed += 1
                    print(f"{waiting[done]}: {type(error).__name__}: {error}", file=sys.stderr)
    print(f"compiled in {time.perf_counter() - begin:.0f} s, kept on disk")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
