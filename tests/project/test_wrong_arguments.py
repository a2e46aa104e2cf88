"""Wrong values for every argument of every public function: an `UnstructError`, and nothing else.

Some wrong values have a meaning for some arguments, such as 0 for a count; what must never be accepted is
listed by kinds of arguments.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import unstruct as u
from unstruct import UnstructError, sizing, studies

BOX = u.Domain.box()
SQUARE = u.Domain(
    np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float), [(0, 1), (1, 2), (2, 3), (3, 0)],
    markers={"a": [0], "c": [2]}, regions={"r": (0.3, 0.35)},
)  # fmt: skip
CORNER = u.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)])
SURFACE = u.Mesh([(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
CLOUD = np.random.default_rng(0).random((30, 2))
LAYERS = u.Layers(first=0.02, growth=1.3, count=2)
# wrong for almost every argument, and never the cause of a long run
WRONG = {
    "text": "x", "bytes": b"x", "none": None, "nan": np.nan, "minus": -1, "half": 2.5, "object": object(),
    "list": [], "zero": 0, "one": 1, "inf": np.inf, "dict": {"q": 1}, "texts": np.array(["a", "b"]),
    "complex": 1j, "function": lambda *_: "no", "large": 10**400,
}  # fmt: skip
FLAGS = {"history", "progress", "finish", "smart", "swap", "cap", "graded", "reduce", "resolve", "largest"}
COUNTS = {"budget", "rounds", "count", "min_level", "max_level", "most_points"}
# too large a number takes for ever, or means as many as there may be
ANY = {("relax", "iterations"), ("insert_without_breaking", "size"), ("sources", "name")}


def _calls() -> dict[str, tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]]:
    mesh, points = u.refine(SQUARE, 0.3), SQUARE.points
    delaunay, diagram = u.delaunay(CLOUD), u.voronoi(CLOUD)
    eyes = np.broadcast_to(np.eye(2), (len(mesh.points), 2, 2))
    shape = {"type": "Polygon", "coordinates": [[(0, 0), (1, 0), (1, 1), (0, 0)]]}
    hole = u.Domain.polygon([(0.1, 0.1), (0.2, 0.1), (0.2, 0.2)])
    path = np.array([(0, 0), (1, 1.0)])
    tree = u.quadtree([(0, 0), (1, 1)], 0.3)
    return {
        "delaunay": (u.delaunay, (CLOUD,), {}),
        "Triangulation": (u.Triangulation, (CLOUD,), {}),
        "gift_wrap": (u.gift_wrap, (CLOUD,), {}),
        "insert": (u.insert, (delaunay, np.array([0.5, 0.5])), {}),
        "voronoi": (u.voronoi, (CLOUD,), {}),
        "Voronoi": (u.Voronoi, (delaunay,), {}),
        "areas": (diagram.areas, (), {}),
        "clip": (diagram.clip, (((0, 0), (1, 1)),), {}),
        "relax": (diagram.relax, (), {}),
        "swap_diagonals": (u.swap_diagonals, (mesh,), {}),
        "join": (u.join, (mesh,), {}),
        "interpolate": (u.interpolate, (delaunay, CLOUD[:, 0], CLOUD[:5]), {}),
        "Domain": (u.Domain, (points, SQUARE.facets), {}),
        "polygon": (u.Domain.polygon, (points,), {}),
        "Domain.smooth": (u.Domain.smooth, (points,), {}),
        "from_geojson": (u.Domain.from_geojson, (shape,), {}),
        "sampled": (SQUARE.sampled, (0.2,), {}),
        "simplified": (SQUARE.simplified, (0.01,), {}),
        "spaced": (SQUARE.spaced, ({"a": 3},), {}),
        "matched": (SQUARE.matched, ("a", "c"), {}),
        "with_holes": (SQUARE.with_holes, (hole,), {}),
        "contains": (SQUARE.contains, (CLOUD,), {}),
        "constrained_delaunay": (u.constrained_delaunay, (SQUARE,), {}),
        "conforming_delaunay": (u.conforming_delaunay, (SQUARE, 0.3), {}),
        "refine": (u.refine, (SQUARE, 0.3), {}),
        "refine of a mesh": (u.refine, (mesh, 0.2), {}),
        "refine of a body": (u.refine, (BOX, 0.6), {}),
        "circumcenters in a body": (u.circumcenter_insertion, (BOX, 0.6), {}),
        "Voronoi segments in a body": (u.voronoi_segment, (BOX, 0.6), {}),
        "circumcenter_insertion": (u.circumcenter_insertion, (SQUARE, 0.3), {}),
        "voronoi_segment": (u.voronoi_segment, (SQUARE, 0.3), {}),
        "recombine": (u.recombine, (delaunay,), {}),
        "quadrilaterals": (u.quadrilaterals, (SQUARE, 0.3), {}),
        "advancing_front": (u.advancing_front, (SQUARE, 0.3), {}),
        "classical front": (u.advancing_front, (SQUARE, 0.3), {"method": "classical"}),
        "classical front in space": (u.advancing_front, (BOX, 0.6), {"method": "classical"}),
        "front_delaunay in space": (u.front_delaunay, (BOX, [[0.4, 0.5, 0.3]]), {}),
        "stuck_body": (u.examples.stuck_body, (), {"name": "convex"}),
        "front in space": (u.advancing_front, (u.Domain.box(), 0.6), {}),
        "front in a metric": (u.advancing_front, (SQUARE, sizing.directional((1.0, 0.0), 0.3, 0.2)), {}),
        "front in a metric in space": (
            u.advancing_front, (BOX, sizing.directional_space(np.eye(3), [0.9, 0.9, 0.5])), {},
        ),
        "directional_space": (sizing.directional_space, (np.eye(3), [0.1, 0.2, 0.3]), {}),
        "intersection_space": (sizing.intersection_space, (0.5,), {}),
        "metric_background in space": (sizing.metric_background, (CORNER, [np.eye(3)] * 4), {}),
        "gradation in space": (
            sizing.gradation, (sizing.metric_background(CORNER, [np.eye(3)] * 4), 0.3), {"space": "space"},
        ),
        "metric_from_hessian in space": (
            sizing.metric_from_hessian, (CORNER, [np.eye(3)] * 4, 0.1), {"lower": 0.1, "upper": 1.0},
        ),
        "front_delaunay": (u.front_delaunay, (SQUARE, 0.3), {}),
        "advancing_layers": (u.advancing_layers, (SQUARE, 0.2), {"layers": LAYERS, "walls": ["a"]}),
        "mesh_parts": (u.mesh_parts, (SQUARE, 0.1, 2), {}),
        "Parts.join": (u.mesh_parts(SQUARE, 0.1, 2, join=False).join, (), {}),
        "surface_delaunay": (u.surface_delaunay, (SURFACE,), {}),
        "curvature": (u.curvature, (SURFACE,), {}),
        "surface_criteria": (studies.surface_criteria, (SURFACE,), {}),
        "restricted_delaunay": (studies.restricted_delaunay, (SURFACE.points, SURFACE), {}),
        "feature_sizes": (studies.feature_sizes, (SURFACE.points,), {}),
        "sampling_density": (studies.sampling_density, (SURFACE.points, SURFACE, 1.0), {}),
        "IntrinsicTriangulation": (studies.IntrinsicTriangulation, (SURFACE,), {}),
        "prismatic_layers": (u.prismatic_layers, (BOX,), {"layers": LAYERS, "side": "inside"}),
        "remesh": (u.remesh, (u.Domain.box(), 0.5), {}),
        "smooth": (u.smooth, (mesh,), {}),
        "improve": (u.improve, (u.delaunay(np.random.default_rng(0).random((20, 3))),), {}),
        "tetrahedralize": (u.tetrahedralize, (u.Domain.ball(size=1.0), 1.0), {}),
        "quadtree": (u.quadtree, (SQUARE, 0.3), {"boundary_size": 0.2}),
        "quadtree of a box": (u.quadtree, ([(0, 0), (1, 1)],), {"max_level": 4}),
        "octree": (u.octree, (BOX, 0.5), {"max_level": 3}),
        "locate": (tree.locate, (CLOUD,), {}),
        "in_box": (tree.in_box, ((0, 0), (1, 1)), {}),
        "nearest": (tree.nearest, (CLOUD,), {}),
        "neighbors": (tree.neighbors, (), {}),
        "refined": (tree.refined, ([0],), {}),
        "coarsened": (tree.coarsened, ([0],), {}),
        "balanced": (tree.balanced, (), {}),
        "union": (tree.union, (tree,), {}),
        "intersection": (tree.intersection, (tree,), {}),
        "prefix": (tree.prefix, (1,), {}),
        "mesh of a tree": (tree.mesh, ("cells",), {}),
        "isosurface_stuffing": (u.isosurface_stuffing, (u.examples.sphere(), 0.5), {}),
        "stuffing of a body": (u.isosurface_stuffing, (BOX, 0.4), {}),
        "stuffing_bounds": (studies.stuffing_bounds, (), {"stencils": "+---"}),
        "check": (u.check, (mesh,), {}),
        "statistics": (u.statistics, (mesh,), {}),
        "compare": (u.compare, ({"m": mesh},), {}),
        "second_order": (u.second_order, (mesh,), {}),
        "Mesh": (u.Mesh, (CLOUD, delaunay.simplices), {}),
        "quality": (mesh.quality, ("min_angle",), {}),
        "select": (mesh.select, ([0, 1],), {}),
        "find_simplex": (mesh.find_simplex, (CLOUD,), {}),
        "Layers": (u.Layers, (), {"first": 0.02, "growth": 1.3, "count": 2}),
        "Spacing": (u.Spacing, (), {"count": 4}),
        "Arc": (u.Arc, ((0, 0), 1, 0, 1), {}),
        "Bezier": (u.Bezier, ([(0, 0), (1, 0)],), {}),
        "Curve": (u.Curve, (lambda t: np.column_stack([t, t]),), {}),
        "insert_without_breaking": (studies.insert_without_breaking, (SQUARE, CLOUD), {}),
        "skeleton_points": (studies.skeleton_points, (SQUARE, 0.3), {}),
        "from_features": (sizing.from_features, (SQUARE,), {}),
        "from_curvature": (sizing.from_curvature, (SQUARE,), {"far": 0.3}),
        "sources": (sizing.sources, (path, 0.1), {}),
        "points": (sizing.points, (path, 0.1), {}),
        "lines": (sizing.lines, (path, 0.1), {}),
        "polygons": (sizing.polygons, ([CLOUD[:3]], 0.1), {}),
        "sizing.clip": (sizing.clip, (0.1, 0.05, 0.2), {}),
        "from_error": (sizing.from_error, (mesh, np.ones(len(mesh.points)), 0.1), {}),
        "from_hessian": (sizing.from_hessian, (mesh, eyes, 0.1), {"lower": 0.1, "upper": 0.2}),
        "metric_from_hessian": (sizing.metric_from_hessian, (mesh, eyes, 0.1), {"lower": 0.1, "upper": 0.2}),
        "gradation": (sizing.gradation, (sizing.metric_background(mesh, eyes), 0.2), {}),
        "to_vertices": (sizing.to_vertices, (mesh, np.ones(mesh.size)), {}),
        "directional": (sizing.directional, ((1.0, 0.0), 0.1, 0.2), {}),
    }  # fmt: skip


CALLS = _calls()


def _must_be_refused(name: str, default: Any, label: str) -> bool:
    """Whether this kind of argument has no use for such a value."""
    if name in FLAGS:
        return True
    if name in COUNTS:
        return label not in ("zero", "one", "large", "none")
    chosen = "method", "order", "evaluate", "search", "cells", "stop", "space", "placement", "test"
    if name in chosen and (default is None or isinstance(default, str)):
        return not (label == "none" and default is None) and label != "function"
    return label in ("object", "complex") and name not in ("name", "size")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("called", CALLS)
def test_wrong_arguments(called: str) -> None:
    function, given, options = CALLS[called]
    function(*given, **options)
    for i, parameter in enumerate(inspect.signature(function).parameters.values()):
        if parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
            continue
        if (called, parameter.name) in ANY or parameter.name.startswith("_"):
            continue
        for label, value in WRONG.items():
            if value is parameter.default:
                continue
            arguments, named = list(given), dict(options)
            if i < len(given) and parameter.kind is not parameter.KEYWORD_ONLY:
                arguments[i] = value
            else:
                named[parameter.name] = value
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    function(*arguments, **named)
            except UnstructError:
                continue
            except Exception as error:
                raise AssertionError(f"{called}({parameter.name}={label})") from error
            assert not _must_be_refused(parameter.name, parameter.default, label), (parameter.name, label)


def test_every_public_function_is_called() -> None:
    functions = {name for name in u.__all__ if inspect.isfunction(getattr(u, name))}
    assert functions <= set(CALLS)
