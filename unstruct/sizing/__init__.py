"""Size fields: functions that give the wanted edge length at every point.

Everywhere in the library a *size* is the wanted length of an edge. An equilateral triangle with edges of
length h has the circumradius h / sqrt(3), which is the chapter's f. See the book, chapter 2.3.
"""

from .asked import too_large as too_large
from .background_mesh import Background as Background
from .background_mesh import background as background
from .background_mesh import limit_nodes as limit_nodes
from .boundary import FeatureSize as FeatureSize
from .boundary import from_curvature as from_curvature
from .boundary import from_features as from_features
from .boundary import local_feature_size as local_feature_size
from .directions import as_metric as as_metric
from .directions import directional as directional
from .directions import intersection as intersection
from .field import SizeField as SizeField
from .field import as_size as as_size
from .field import clip as clip
from .field import control as control
from .field import maximum as maximum
from .field import minimum as minimum
from .field import product as product
from .limit import LimitedSize as LimitedSize
from .limit import limited as limited
from .metric import Metric as Metric
from .metric_mesh import BackgroundMetric as BackgroundMetric
from .metric_mesh import gradation as gradation
from .metric_mesh import metric_background as metric_background
from .metric_mesh import metric_from_hessian as metric_from_hessian
from .metric_table import MetricTable as MetricTable
from .solution import from_error as from_error
from .solution import from_hessian as from_hessian
from .solution import hessian as hessian
from .solution import mesh_size as mesh_size
from .solution import to_vertices as to_vertices
from .source_sizes import lines as lines
from .source_sizes import points as points
from .source_sizes import polygons as polygons
from .source_sizes import sources as sources
from .space_metric import SpaceMetric as SpaceMetric
from .space_metric import directional_space as directional_space
from .space_metric import intersection_space as intersection_space
from .space_metric_mesh import BackgroundSpaceMetric as BackgroundSpaceMetric
from .surface import from_facets as from_facets
from .table import SizeTable as SizeTable

__all__ = [
    "Background",
    "BackgroundMetric",
    "BackgroundSpaceMetric",
    "FeatureSize",
    "LimitedSize",
    "Metric",
    "MetricTable",
    "SizeField",
    "SizeTable",
    "SpaceMetric",
    "as_metric",
    "as_size",
    "background",
    "clip",
    "control",
    "directional",
    "directional_space",
    "from_curvature",
    "from_error",
    "from_facets",
    "from_features",
    "from_hessian",
    "gradation",
    "hessian",
    "intersection",
    "intersection_space",
    "limit_nodes",
    "limited",
    "lines",
    "local_feature_size",
    "maximum",
    "mesh_size",
    "metric_background",
    "metric_from_hessian",
    "minimum",
    "points",
    "polygons",
    "product",
    "sources",
    "to_vertices",
    "too_large",
]
