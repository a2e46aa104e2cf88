"""Meshes of all methods, hashed: for input equal bit for bit they are equal on every processor.

    python tests/helpers/mesh_hashes.py            # print the hashes as JSON
    python tests/helpers/mesh_hashes.py --write    # store them beside it: after a change made on purpose

A hash covers the bytes of the coordinates and of the simplices. Points are drawn by numpy's generator, whose
uniform numbers are integers scaled; regions have straight sides, arcs, splines, Bezier curves, airfoils and
the curves of the examples, all of which the library evaluates itself; sizes are numbers, tables (sources,
features, curvature, limited, interpolated on a mesh) and functions of + - * / and square roots.

Not here, since not promised: sizes from computed solutions (`sizing.hessian`, `from_hessian`, and what is
solved by linear algebra, whose last bits depend on the processor), and functions of the caller that use
numpy's or the C library's sines, exponentials or powers.
"""

from __future__ import annotations

import hashlib
import json
import sys
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from solids import saddle_lines

import unstruct
from unstruct import Arc, Bezier, Curve, Domain, examples, sizing
from unstruct.examples import regions as regions
from unstruct.generate.centers.periodic import periodic_delaunay
from unstruct.generate.centers.worst import PRIORITIES

STORED = Path(__file__).with_suffix(".json")
Arrays = Iterator[Any]
CASES: dict[str, Callable[[], Arrays]] = {}


def case(function: Callable[[], Arrays]) -> Callable[[], Arrays]:
    """Enter a generator of arrays among those that are hashed."""
    CASES[function.__name__.replace("_", " ")] = function
    return function


def of(mesh: Any) -> Arrays:
    """The arrays that make a mesh."""
    yield mesh.points
    yield mesh.simplices
    yield getattr(mesh, "segments", np.empty(0))


def hashed(arrays: Arrays) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        array = np.ascontiguousarray(array)
        kind = np.float64 if array.dtype.kind == "f" else np.int64
        digest.update(str(array.shape).encode() + array.astype(kind).tobytes())
    return digest.hexdigest()[:16]


# ---------------------------------------------------------------------- input


def points(n: int, d: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((n, d))


def lattice(*counts: int) -> np.ndarray:
    return np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, len(counts)) / 8


@cache
def harbor() -> Domain:
    """Straight sides, sharp corners, a hole, an inner segment, a loose point, two regions."""
    outer = [[0, 0], [9, 0], [9, 4], [5, 1], [9, 7], [4, 6.5], [0, 7]]
    hole = [[1, 1], [3, 1.5], [2, 3]]
    corners = np.array([*outer, *hole, [4, 6.5], [4, 3], [1, 5]], dtype=float)
    facets = [[i, (i + 1) % 7] for i in range(7)] + [[7, 8], [8, 9], [9, 7]]
    corners = np.delete(corners, 10, axis=0)
    return Domain(corners, facets, inner=[[5, 10]], markers={"hole": [7, 8, 9]}, regions={"water": [0.5, 6]})


@cache
def curved() -> Domain:
    """Arcs, a Bezier curve and a curve of the caller's that is arithmetic."""
    arc = Arc.through([0, 0], [2, -0.7], [4, 0])
    corners = [[0, 0], [4, 0], [4, 3], [2, 3], [0, 3]]
    bow = Bezier([[4, 3], [3.4, 3.9], [2.6, 2.2], [2, 3]])
    side = Curve(lambda t: np.stack([t * (t - 1) / 3, 3 * (1 - t)], axis=-1))
    outer = Domain(corners, [[i, (i + 1) % 5] for i in range(5)], curves={0: arc, 2: bow, 4: side})
    return outer.with_holes(Domain.disc((1.3, 1.1), 0.45))


@cache
def wing() -> Domain:
    section = Domain.naca("2412", attack=5)
    return Domain.disc((0.5, 0.0), 3).with_holes(section)


@cache
def spline() -> Domain:
    outer = [[0, 0], [2, -0.5], [4, 0], [4.5, 2], [3, 3], [1.5, 2.2], [0, 3]]
    return Domain.smooth(outer, [[[1, 0.7], [2, 0.5], [1.7, 1.4]]])


def graded(x: np.ndarray) -> np.ndarray:
    """A size by arithmetic alone."""
    return 0.1 + 0.08 * np.sqrt((x[:, 0] - 1.0) ** 2 + (x[:, 1] - 0.5) ** 2)


@cache
def shore_size() -> Any:
    chain = wing().sampled(0.2)
    return sizing.sources(chain.points[chain.ends], 0.12, growth=0.2, far=0.8)


# ---------------------------------------------------------------------- Delaunay, its dual, and changes


@case
def quadrilaterals() -> Arrays:
    for domain, size in (
        (spline(), 0.2), (harbor(), graded), (wing(), shore_size()),
    ):  # fmt: skip
        for mesh in (
            unstruct.quadrilaterals(domain, size), unstruct.recombine(unstruct.voronoi_segment(domain, size)),
        ):  # fmt: skip
            yield mesh.points
            yield from mesh.cells.values()


@case
def advancing_layers() -> Arrays:
    domain, layers = examples.wing_with_flap(), unstruct.Layers(first=1e-3, growth=1.25)
    size = sizing.sources([[0.5, 0.0], [1.1, -0.15]], 0.04, growth=0.3, far=1.0)
    for stop in ("nearest", "spring"):
        walls = ["upper", "lower"]
        yield from of(unstruct.advancing_layers(domain, size, layers=layers, walls=walls, stop=stop))


@case
def prismatic_layers() -> Arrays:
    """Straight rays and marched ones, squeezed and stopped, on a rough body with a narrow gap."""
    layers = unstruct.Layers(thickness=0.4, growth=1.15, count=8)
    ball = Domain.ball(size=0.45)
    rough = ball.points * (1 + 0.12 * (points(len(ball.points), 1) - 0.5))
    rows = ball.triangulated.triangles
    two = Domain(
        np.vstack([rough, ball.points + np.array([2.2, 0.1, 0.0])]), np.vstack([rows, rows + len(rough)])
    )
    for options in ({}, {"recompute": True}, {"normals": "staged"}, {"stop": "stop"}, {"side": "inside"}):
        mesh = unstruct.prismatic_layers(two, layers=layers, **options)
        yield mesh.points
        yield from mesh.cells.values()


@case
def several_rays() -> Arrays:
    """Around a sharp rim: hexahedra up to a cap with quadrilaterals, tetrahedra, and pyramids in a box."""
    half = [(4.0, 0.0), (3.0, 3.0), (0.0, 4.0), (-3.0, 3.0)]
    rim = half + [(-x, -y) for x, y in half]
    ends, k, many = [(0.0, 0.0, 0.5), (0.0, 0.0, -0.5)], np.arange(8), np.full(8, 8)
    over, under = np.column_stack([k, (k + 1) % 8, many]), np.column_stack([(k + 1) % 8, k, many + 1])
    body = Domain(np.array([(*p, 0.0) for p in rim] + ends), np.vstack([over, under]))
    box = Domain.box((-9, -9, -9), (9, 9, 9)).with_holes(body)
    layers = unstruct.Layers(thickness=3.0, count=2)
    for domain, options in (
        (body, {}),
        (body, {"cells": "tetrahedron"}),
        (box, {"size": 9.0, "walls": list(range(len(box.facets) - len(body.facets), len(box.facets)))}),
    ):
        mesh = unstruct.prismatic_layers(domain, layers=layers, several=True, **options)
        yield mesh.points
        yield from mesh.cells.values()


@case
def delaunay() -> Arrays:
    for d, n in ((2, 3000), (3, 800), (4, 120), (5, 40)):
        yield from of(unstruct.delaunay(points(n, d)))
    for counts in ((20, 30), (6, 7, 8), (3, 3, 3, 3)):
        yield from of(unstruct.delaunay(lattice(*counts)))
        yield from of(unstruct.delaunay(lattice(*counts) / 3))  # rounded: nearly ties


@case
def gift_wrapping() -> Arrays:
    for d, n in ((2, 200), (3, 80), (4, 25)):
        yield from of(unstruct.gift_wrap(points(n, d, 1)))
    for counts in ((5, 6), (3, 3, 3), (2, 2, 2, 2)):
        yield from of(unstruct.gift_wrap(lattice(*counts)))
        yield from of(unstruct.gift_wrap(lattice(*counts) / 3))  # rounded: nearly ties


@case
def insertion_and_removal() -> Arrays:
    for d in (2, 3):
        t = unstruct.Triangulation(points(200, d, 2))
        t.insert(points(40, d, 3))
        if d == 2:
            t.remove(17)
        yield from of(t.mesh())
        baker = unstruct.studies.Baker(unstruct.delaunay(points(60, d, 4)))
        baker.insert(0.25 + 0.5 * points(40, d, 5))
        yield from of(baker.mesh())


@case
def swaps() -> Arrays:
    yield from of(unstruct.swap_diagonals(examples.sweep_triangulation(points(500, 2, 6))))


@case
def voronoi() -> Arrays:
    for d, n in ((2, 500), (3, 200), (4, 40)):
        cells = unstruct.voronoi(points(n, d, 7))
        yield cells.vertices
        yield cells.nearest(points(100, d, 8))
    yield unstruct.voronoi(lattice(5, 6)).vertices
    yield unstruct.voronoi(points(200, 2, 9)).areas()


@case
def terrain() -> Arrays:
    i, j = np.indices((40, 50))
    heights = (i * i * 7 + j * j * 3 + i * j) % 97
    surface = unstruct.studies.greedy_terrain(heights, count=200)
    yield from of(surface.mesh)
    yield surface.errors


# ---------------------------------------------------------------------- boundaries


@case
def constrained() -> Arrays:
    for domain in (harbor(), curved(), wing(), spline(), regions.plate()):
        yield from of(unstruct.constrained_delaunay(domain))
        yield from of(unstruct.constrained_delaunay(domain, hull=True))
        yield domain.sampled(0.3).points


@case
def conforming() -> Arrays:
    for domain in (harbor(), curved(), wing(), spline()):
        yield from of(unstruct.conforming_delaunay(domain))
        yield from of(unstruct.conforming_delaunay(domain, 0.5, test="gabriel", shells=True))


@case
def recovered() -> Arrays:
    domain = harbor()
    mesh = unstruct.studies.recover_edges(unstruct.delaunay(domain.points), domain.pieces)
    yield from of(mesh)
    yield from of(unstruct.studies.remove_outside(mesh, domain))


@case
def protected() -> Arrays:
    scattered = points(300, 2, 10) * [9, 7]
    yield from of(unstruct.studies.insert_without_breaking(harbor(), scattered, size=0.5).mesh)
    yield unstruct.studies.skeleton_points(harbor(), 0.5).points


@case
def bodies() -> Arrays:
    """Where the recovery has to add points, and where facets are planar up to rounding."""
    stored = np.load(STORED.with_name("near_planar.npz"))
    for name in ("25", "63"):
        yield from of(unstruct.constrained_delaunay(Domain(stored[f"p{name}"], stored[f"t{name}"])))
    lines, segments = saddle_lines(3, 0.0625)
    box = Domain.box(lines.min(axis=0) - 1, lines.max(axis=0) + 1)
    corners = np.concatenate([box.points, lines])
    crossed = Domain(corners, list(box.facets), inner=(segments + 8).tolist())
    yield from of(unstruct.constrained_delaunay(crossed))
    warnings.simplefilter("ignore", unstruct.IncompleteWarning)  # lines are close to each other
    for method in (unstruct.tetrahedralize, unstruct.refine, unstruct.voronoi_segment):
        yield from of(method(crossed, 2.0))
    yield from of(unstruct.circumcenter_insertion(box, 2.0))


# ---------------------------------------------------------------------- refinement and placement


@case
def round_bodies() -> Arrays:
    """Balls, tori, cylinders, and what is swept; meshes of them by sizes from their surfaces."""
    arc = Domain.disc((2.0, 0.3), 0.5)
    bowl = Domain.polygon([(0, 0), (1, 0), (1.3, 0.7), (1.1, 0.8), (0.9, 0.2), (0, 0.2)])
    made = [
        Domain.ball((0.1, 0.2, 0.3), 1.3, size=0.3),
        Domain.torus((0, 0, 0.1), 1.1, 0.3, size=0.2, axis=(1, 2, 3)),
        Domain.cylinder((0, 0, 0), (1, 0.3, 2), 0.6, size=0.2), Domain.revolved(arc, size=0.25),
        Domain.revolved(bowl, 250.0, size=0.25), Domain.extruded(arc, (0.2, 0.1, 1.0), size=0.3),
    ]  # fmt: skip
    for body in made:
        yield body.points
        yield body.triangulated.triangles
    for body in made[:3]:
        yield from of(unstruct.tetrahedralize(body, sizing.from_curvature(body, 20, far=0.5)))
        yield from of(unstruct.tetrahedralize(body, sizing.from_features(body, 0.6, far=0.4)))


@case
def refined_for_angles() -> Arrays:
    for domain in (harbor(), curved(), wing(), spline()):
        for method in ("ruppert", "chew", "off-centers"):
            for angle in (20.7, 30.0):
                yield from of(unstruct.refine(domain, min_angle=angle, method=method))


@case
def refined_for_sizes() -> Arrays:
    yield from of(unstruct.refine(harbor(), 0.4))
    yield from of(unstruct.refine(harbor(), graded, max_area=0.2))
    yield from of(unstruct.refine(curved(), graded, method="ruppert"))
    yield from of(unstruct.refine(wing(), shore_size()))
    yield from of(unstruct.refine(spline(), sizing.minimum(graded, 0.3)))
    yield from of(unstruct.refine(regions.plate(), {"inlay": 0.05, "left": 0.2, "right": 0.15}))
    yield from of(unstruct.refine(unstruct.refine(harbor(), 1.0), 0.5))


@case
def size_tables() -> Arrays:
    places = points(400, 2, 11) * [4, 3]
    coarse = unstruct.refine(curved(), 0.4)
    at_vertices = sizing.limit_nodes(coarse, 0.05 + np.abs(coarse.points[:, 0] - 2) / 4, 0.3)
    for size in (
        sizing.from_features(curved(), 0.5, far=0.6),
        sizing.from_curvature(curved(), 30, far=0.5),
        sizing.limited(graded, 0.05, [0, -1], [4, 4]),
        sizing.background(coarse, at_vertices),
        sizing.product(graded, 1.5),
        sizing.clip(graded, 0.15, 0.3),
    ):
        yield size(places)
        yield from of(unstruct.refine(curved(), size))


@case
def circumcenters() -> Arrays:
    yield from of(unstruct.circumcenter_insertion(points(50, 2, 12), 0.1))
    for priority in (*PRIORITIES, graded):
        yield from of(unstruct.circumcenter_insertion(curved(), 0.25, priority=priority))
    yield from of(unstruct.circumcenter_insertion(harbor(), graded, split_boundary=False))


@case
def torus() -> Arrays:
    grid = (lattice(5, 5) * 8 + 0.6 * points(25, 2, 13)) / 5
    for mesh in (periodic_delaunay(grid), unstruct.studies.periodic_circumcenters(grid, 0.06)):
        yield from of(mesh)
        yield mesh.shifts


@case
def voronoi_segments() -> Arrays:
    for domain, size in ((harbor(), 0.4), (curved(), graded), (wing(), shore_size()), (spline(), 0.15)):
        yield from of(unstruct.voronoi_segment(domain, size))
    yield from of(unstruct.voronoi_segment(harbor(), graded, finish=False, split_boundary=False))
    for order in ("first", "last"):
        yield from of(unstruct.voronoi_segment(curved(), graded, order=order))


@case
def advancing_fronts() -> Arrays:
    for domain, size in ((harbor(), 0.4), (curved(), graded), (wing(), shore_size()), (spline(), 0.15)):
        yield from of(unstruct.advancing_front(domain, size))
    warnings.simplefilter("ignore", unstruct.IncompleteWarning)  # raw fronts have large triangles
    for order in ("widest", "smallest", "shortest", "oldest"):
        options = {"order": order, "placement": "angle", "finish": False}
        yield from of(unstruct.advancing_front(curved(), graded, **options))
    yield from of(unstruct.advancing_front(harbor(), graded, placement="equal sides", finish=False))


@case
def fronts_by_the_empty_circle() -> Arrays:
    for domain, size in ((harbor(), 0.4), (curved(), graded)):
        yield from of(unstruct.front_delaunay(domain, size))
    yield from of(unstruct.front_delaunay(Domain.rectangle(), lattice(9, 9) / 10 + 0.05))


@case
def trees() -> Arrays:
    size = sizing.sources([[0.5, 0.0], [2.0, 3.0]], 0.05, growth=0.3)
    noisy = examples.noisy_ball(1)
    at = sizing.points([[0.2, 0.1, 0.0]], 0.1, growth=0.4)
    for tree in (
        unstruct.quadtree(harbor(), size, turning=40, max_level=9),
        unstruct.quadtree(regions.running_domain(), boundary_size=0.05, growth=0.3),
        unstruct.quadtree([(0, 0), (1, 1)], points=points(500, 2, 8), most_points=3),
        unstruct.octree(Domain.torus(size=0.4), at, boundary_size=0.3, turning=60, max_level=5),
        unstruct.octree(
            noisy.box, divide=lambda x, side: np.abs(noisy(x)) < 0.5 * noisy.change * side, max_level=4
        ),
    ):
        yield tree.keys.astype(np.int64)
        yield tree.states
        yield from of(tree.mesh("conforming"))


@case
def meshes_of_quadtrees() -> Arrays:
    size = sizing.sources([[0.5, 0.0], [2.0, 3.0]], 0.05, growth=0.3)
    for tree in (
        unstruct.quadtree(harbor(), size, turning=40, max_level=9),
        unstruct.quadtree(regions.running_domain(), 0.3, boundary_size=0.05),
        unstruct.quadtree(curved(), 0.2, balance=None),
    ):
        for kind in ("fitted", "warped", "quads"):
            mesh = tree.mesh(kind)
            yield from (mesh.points, mesh.segments, *mesh.cells.values())


@case
def smoothed() -> Arrays:
    mesh = unstruct.refine(harbor(), 0.5)
    for method in ("laplace", "optimal", "centroid", "search"):
        for smart in (True, False):
            yield from of(unstruct.smooth(mesh, method, smart=smart, swap=smart, rounds=3))


@case
def running_examples() -> Arrays:
    outline, _ = examples.running_region(0.1)
    yield outline
    yield examples.running_points(1, scale=0.9)
    yield from of(unstruct.voronoi_segment(regions.running_domain(), examples.running_size))
    yield from of(unstruct.refine(regions.wing_with_flap(), 0.5))


def main(arguments: list[str]) -> None:
    names = [name for name in arguments if not name.startswith("--")] or list(CASES)
    found = {name: hashed(CASES[name]()) for name in names}
    text = json.dumps(found, indent=2)
    if "--write" in arguments:
        STORED.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
