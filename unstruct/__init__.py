"""Unstructured mesh generation, exact and fast: the library under the book."""

from . import predicates as predicates
from .check import check as check
from .curves import Arc as Arc
from .curves import Bezier as Bezier
from .curves import Curve as Curve
from .delaunay.constrained import constrained_delaunay as constrained_delaunay
from .delaunay.gift_wrapping import gift_wrap as gift_wrap
from .delaunay.insertion import Triangulation as Triangulation
from .delaunay.insertion import delaunay as delaunay
from .delaunay.modernized import Baker as Baker
from .delaunay.modernized import insert as insert
from .delaunay.smoothing import smooth as smooth
from .delaunay.swapping import swap_diagonals as swap_diagonals
from .delaunay.terrain import Terrain as Terrain
from .delaunay.terrain import greedy_terrain as greedy_terrain
from .delaunay.voronoi import Voronoi as Voronoi
from .delaunay.voronoi import voronoi as voronoi
from .delaunay.voronoi_segment import voronoi_segment as voronoi_segment
from .domain import Domain as Domain
from .errors import DegenerateInputError as DegenerateInputError
from .errors import InputError as InputError
from .errors import MeshError as MeshError
from .errors import UnstructError as UnstructError
from .mesh import Mesh as Mesh
from .statistics import compare as compare
from .statistics import statistics as statistics
