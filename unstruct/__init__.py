"""Unstructured mesh generation, exact and fast: the library under the book.

Points: `delaunay`, `Triangulation`, `gift_wrap`, `insert`, `voronoi`, `Voronoi`, `swap_diagonals`,
`interpolate`.

Regions: `Domain` with `Arc`, `Bezier`, `Curve`, `Spacing`; `constrained_delaunay`, `conforming_delaunay`,
`refine`, `circumcenter_insertion`, `voronoi_segment`, `advancing_front`, `front_delaunay`, `smooth`;
`advancing_layers` with `Layers`; `mesh_parts` with `Parts`. Bodies: `constrained_delaunay`,
`tetrahedralize`, `prismatic_layers`, `improve`. Surfaces: `remesh`, `surface_delaunay`, `curvature` with
`Curvature`.
Trees over boxes, regions and bodies: `quadtree`, `octree`, `Tree`; `isosurface_stuffing`.

Results: `Mesh`, `DomainMesh`, `Report`; `check`, `statistics`, `compare`; `join`; `second_order`,
`CurvedMesh`.

Namespaces: `sizing` (wanted lengths), `predicates` (exact signs), `simplex` and `topology` (single cells and
bare arrays), `examples`, `view` (pictures; needs matplotlib), `plain` (each algorithm once more, to be read),
`studies` (what one studies rather than uses).
"""

from importlib import import_module as _import
from typing import Any as _Any
from warnings import warn as _warn

from . import errors as errors
from . import predicates as predicates
from . import simplex as simplex
from . import sizing as sizing
from . import topology as topology
from .assess.check import check as check
from .assess.statistics import compare as compare
from .assess.statistics import statistics as statistics
from .base.errors import DegenerateInputError as DegenerateInputError
from .base.errors import DomainError as DomainError
from .base.errors import HiddenVertexWarning as HiddenVertexWarning
from .base.errors import IncompleteWarning as IncompleteWarning
from .base.errors import InputError as InputError
from .base.errors import MeshError as MeshError
from .base.errors import UnstructError as UnstructError
from .base.report import Report as Report
from .connect.baker.modernized import insert as insert
from .connect.insertion.delaunay import Triangulation as Triangulation
from .connect.insertion.delaunay import delaunay as delaunay
from .connect.interpolation import interpolate as interpolate
from .connect.surface.curvature import Curvature as Curvature
from .connect.surface.curvature import curvature as curvature
from .connect.swapping import swap_diagonals as swap_diagonals
from .connect.voronoi.diagram import Voronoi as Voronoi
from .connect.voronoi.diagram import voronoi as voronoi
from .connect.wrapping.gift_wrapping import gift_wrap as gift_wrap
from .domain.domain import Domain as Domain
from .domain.plane.prescribed import Spacing as Spacing
from .generate.bodies.tetrahedralize import tetrahedralize as tetrahedralize
from .generate.boundary.conforming import conforming_delaunay as conforming_delaunay
from .generate.boundary.constrained import constrained_delaunay as constrained_delaunay
from .generate.centers.circumcenters import circumcenter_insertion as circumcenter_insertion
from .generate.front.advancing_front import advancing_front as advancing_front
from .generate.front.delaunay_front import front_delaunay as front_delaunay
from .generate.improve.smoothing import smooth as smooth
from .generate.layers.advancing_layers import advancing_layers as advancing_layers
from .generate.parallel.mesh_parts import Parts as Parts
from .generate.parallel.mesh_parts import mesh_parts as mesh_parts
from .generate.planting.planting import octree as octree
from .generate.planting.planting import quadtree as quadtree
from .generate.planting.tree import Tree as Tree
from .generate.prisms.prismatic_layers import prismatic_layers as prismatic_layers
from .generate.quads.quadrilaterals import quadrilaterals as quadrilaterals
from .generate.quads.recombine import recombine as recombine
from .generate.rebay.voronoi_segment import voronoi_segment as voronoi_segment
from .generate.refinement.refine import refine as refine
from .generate.stuffing.stuffing import isosurface_stuffing as isosurface_stuffing
from .generate.surface.remesh import remesh as remesh
from .generate.surface.surface_delaunay import surface_delaunay as surface_delaunay
from .generate.volume.improving import improve as improve
from .geometry.curves import Arc as Arc
from .geometry.curves import Bezier as Bezier
from .geometry.curves import Curve as Curve
from .mesh.curved import CurvedMesh as CurvedMesh
from .mesh.curved import second_order as second_order
from .mesh.domain_mesh import DomainMesh as DomainMesh
from .mesh.joining import join as join
from .mesh.mesh import Mesh as Mesh
from .sizing.stretching import Layers as Layers

__version__ = "0.1.0"

__all__ = [
    "Arc",
    "Bezier",
    "Curvature",
    "Curve",
    "CurvedMesh",
    "DegenerateInputError",
    "Domain",
    "DomainError",
    "DomainMesh",
    "HiddenVertexWarning",
    "IncompleteWarning",
    "InputError",
    "Layers",
    "Mesh",
    "MeshError",
    "Parts",
    "Report",
    "Spacing",
    "Tree",
    "Triangulation",
    "UnstructError",
    "Voronoi",
    "advancing_front",
    "advancing_layers",
    "check",
    "circumcenter_insertion",
    "compare",
    "conforming_delaunay",
    "constrained_delaunay",
    "curvature",
    "delaunay",
    "examples",
    "front_delaunay",
    "gift_wrap",
    "improve",
    "insert",
    "interpolate",
    "isosurface_stuffing",
    "join",
    "mesh_parts",
    "octree",
    "plain",
    "predicates",
    "prismatic_layers",
    "quadrilaterals",
    "quadtree",
    "recombine",
    "refine",
    "remesh",
    "second_order",
    "simplex",
    "sizing",
    "smooth",
    "statistics",
    "studies",
    "surface_delaunay",
    "swap_diagonals",
    "tetrahedralize",
    "topology",
    "voronoi",
    "voronoi_segment",
]

# Imported when they are asked for. `view` is not in `__all__`: it needs matplotlib, the library does not.
_LATER = ("examples", "plain", "studies", "view")

# Where names of earlier versions are now.
_MOVED = {
    **dict.fromkeys(["Baker", "Terrain", "greedy_terrain", "insert_without_breaking"], "studies"),
    **dict.fromkeys(
        ["periodic_circumcenters", "recover_edges", "remove_outside", "skeleton_points"], "studies"
    ),
    **dict.fromkeys(["arrays", "jit", "progress", "report"], "base"),
    **dict.fromkeys(["close", "exact", "filters"], "predicates"),
    **dict.fromkeys(["curves", "edge_vectors", "ordering", "segment_pairs", "sweep"], "geometry"),
    **dict.fromkeys(["card", "cells", "embedding", "files", "locate", "manifold", "measures"], "mesh"),
    **dict.fromkeys(["point_sets", "structured"], "examples"),
    "check_brute": "assess.brute",
    "check_cells": "assess.mixed",
    "check_domain": "assess.region",
    "curve_distance": "geometry.outline_distance",
    "distance": "geometry.segment_tree",
    "domain_corners": "domain.plane.corners",
    "domain_faults": "domain.plane.faults",
    "domain_files": "domain.plane.poly",
    "domain_input": "domain.arguments",
    "domain_inside": "domain.plane.inside",
    "domain_repair": "domain.plane.repair",
    "domain_sample": "domain.plane.sample",
    "domain_shapes": "domain.plane.shapes",
    "example_regions": "examples.regions",
    "gmsh_files": "mesh.gmsh",
    "marked_edges": "mesh.marked",
    "signs": "predicates.kernels",
    "size_background": "sizing.background_mesh",
    "size_sources": "sizing.source_sizes",
    **{f"size_{kind}": f"sizing.{kind}" for kind in ("boundary", "field", "limit", "solution", "table")},
}


def __getattr__(name: str) -> _Any:
    if name in _LATER:
        return _import(f"{__name__}.{name}")
    if name not in _MOVED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    place = _MOVED[name]
    if place.rpartition(".")[2] == name or "." in place:
        here, found = place, _import(f"{__name__}.{place}")
    else:
        here = f"{place}.{name}"
        room = _import(f"{__name__}.{place}")
        found = getattr(room, name, None) or _import(f"{__name__}.{here}")
    _warn(f"unstruct.{name} is now unstruct.{here}", DeprecationWarning, stacklevel=2)
    return found


def __dir__() -> list[str]:
    return sorted([*__all__, "errors", "view"])
