"""Simplices, one or many: volumes, circles and spheres, angles, quality."""

from .geometry.simplex import *  # noqa: F403
from .geometry.simplex import __all__ as __all__
