"""Size fields: how one says which edge length is wanted where. All that belongs to them, in one place.

Everywhere in the library a *size* is the wanted length of an edge. A triangle that is equilateral with
edges of length h has the circumradius h / sqrt(3): that is the chapter's f. See the book, chapter 2.3.
"""

from .size_background import Background as Background
from .size_background import background as background
from .size_background import limit_nodes as limit_nodes
from .size_boundary import FeatureSize as FeatureSize
from .size_boundary import from_curvature as from_curvature
from .size_boundary import from_features as from_features
from .size_boundary import local_feature_size as local_feature_size
from .size_field import SizeField as SizeField
from .size_field import as_size as as_size
from .size_field import clip as clip
from .size_field import control as control
from .size_field import maximum as maximum
from .size_field import minimum as minimum
from .size_field import product as product
from .size_limit import LimitedSize as LimitedSize
from .size_limit import limited as limited
from .size_solution import from_error as from_error
from .size_solution import from_hessian as from_hessian
from .size_solution import hessian as hessian
from .size_solution import mesh_size as mesh_size
from .size_solution import to_vertices as to_vertices
from .size_sources import lines as lines
from .size_sources import points as points
from .size_sources import polygons as polygons
from .size_sources import sources as sources
from .size_table import SizeTable as SizeTable

__all__ = [
    "Background",
    "FeatureSize",
    "LimitedSize",
    "SizeField",
    "SizeTable",
    "as_size",
    "background",
    "clip",
    "control",
    "from_curvature",
    "from_error",
    "from_features",
    "from_hessian",
    "hessian",
    "limit_nodes",
    "limited",
    "lines",
    "local_feature_size",
    "maximum",
    "mesh_size",
    "minimum",
    "points",
    "polygons",
    "product",
    "sources",
    "to_vertices",
]
