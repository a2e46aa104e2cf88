"""Adjacency of bare arrays of simplices: neighbors, faces, boundary, stars."""

from .mesh.topology import *  # noqa: F403
from .mesh.topology import __all__ as __all__
