"""Functions for studying the methods, which the chapters of the book need; applications do not.

There are Baker's insertion with fixed cells, recovery of edges and in space what it did, insertion that
breaks no boundary edge, points along the skeleton of a boundary, meshes of the torus, greedy terrain, a
proof of the angles of `isosurface_stuffing`, what is Delaunay on a surface (criteria, intrinsic flips,
restricted to it), an advancing front on a surface, and the steps by which `swap_diagonals` and
`voronoi_segment` reach their results. This module only imports them.
"""

from .assess.statistics import angle_histogram as angle_histogram
from .connect.baker.fixed import boundary_facets as boundary_facets
from .connect.baker.fixed import cavities as cavities
from .connect.baker.fixed import held_by as held_by
from .connect.baker.fixed import hidden_facets as hidden_facets
from .connect.baker.modernized import Baker as Baker
from .connect.spatial.journal import replay_recovery as replay_recovery
from .connect.surface.criteria import SurfaceCriteria as SurfaceCriteria
from .connect.surface.criteria import surface_criteria as surface_criteria
from .connect.surface.density import feature_sizes as feature_sizes
from .connect.surface.density import sampling_density as sampling_density
from .connect.surface.intrinsic import IntrinsicTriangulation as IntrinsicTriangulation
from .connect.surface.restricted import RestrictedDelaunay as RestrictedDelaunay
from .connect.surface.restricted import restricted_delaunay as restricted_delaunay
from .connect.swapping import replay as replay
from .connect.terrain import Terrain as Terrain
from .connect.terrain import greedy_terrain as greedy_terrain
from .connect.terrain import grid_surface as grid_surface
from .generate.boundary.edge_recovery import recover_edges as recover_edges
from .generate.boundary.edge_recovery import remove_outside as remove_outside
from .generate.boundary.protection import insert_without_breaking as insert_without_breaking
from .generate.boundary.protection import skeleton_points as skeleton_points
from .generate.centers.periodic import periodic_delaunay as periodic_delaunay
from .generate.centers.torus import periodic_circumcenters as periodic_circumcenters
from .generate.centers.worst import judge as judge
from .generate.rebay.voronoi_segment import CASES as CASES
from .generate.rebay.voronoi_segment import epsilon_chains as epsilon_chains
from .generate.stuffing.bounds import StuffingBounds as StuffingBounds
from .generate.stuffing.bounds import stuffing_bounds as stuffing_bounds
from .generate.surface.front import surface_front as surface_front
from .geometry.segment_tree import SegmentTree as SegmentTree

__all__ = [
    "CASES",
    "Baker",
    "IntrinsicTriangulation",
    "RestrictedDelaunay",
    "SegmentTree",
    "StuffingBounds",
    "SurfaceCriteria",
    "Terrain",
    "angle_histogram",
    "boundary_facets",
    "cavities",
    "epsilon_chains",
    "feature_sizes",
    "greedy_terrain",
    "grid_surface",
    "held_by",
    "hidden_facets",
    "insert_without_breaking",
    "judge",
    "periodic_circumcenters",
    "periodic_delaunay",
    "recover_edges",
    "remove_outside",
    "replay",
    "replay_recovery",
    "restricted_delaunay",
    "sampling_density",
    "skeleton_points",
    "stuffing_bounds",
    "surface_criteria",
    "surface_front",
]
