"""isosurface_stuffing: tetrahedra with bounded dihedral angles in what a function bounds.

See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arguments import as_count, as_flag, positive
from ...base.errors import InputError
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh
from ...mesh.mesh import Mesh
from ...sizing.field import as_size
from ..tree.growing import MOST_LEAVES, as_box
from .filling import background_of, filled_background
from .laying import laid_in_level_set
from .sampling import LevelSet
from .surfaces import laid_in_surface

__all__ = ["isosurface_stuffing"]

Array = NDArray[np.float64]
TOLERANCE = 1e-10  # of the zeros on edges, as a share of the edge


def isosurface_stuffing(
    body: Any,
    size: Any,
    *,
    box: ArrayLike | None = None,
    graded: bool = False,
    tolerance: float | None = TOLERANCE,
    budget: int = MOST_LEAVES,
    progress: bool = False,
) -> DomainMesh:
    """Fill what a function bounds with tetrahedra whose dihedral angles are bounded."""
    field, budget = as_size(size), as_count(budget, "budget")
    graded, progress = as_flag(graded, "graded"), as_flag(progress, "progress")
    if tolerance is not None:
        tolerance = positive(tolerance, "tolerance")
    limits = (budget, progress)
    if isinstance(body, Mesh) and body.points.shape[1] == 3 and body.dimension == 2:
        body = Domain.surface(body)
    if isinstance(body, Domain):
        laid = laid_in_surface(as_domain(body, 3), field, graded, limits)
        level_set = None
    else:
        level_set = LevelSet(body, as_box(box, 3))
        laid = laid_in_level_set(level_set, field, graded, tolerance, limits)
    background = background_of(laid.grid, laid.vertices, laid.sign)
    filling = filled_background(background, laid.shares)
    return DomainMesh(
        filling.points,
        filling.cells,
        counts={"moved": filling.moved, "cut points": filling.cut, "values": level_set.called if level_set else 0},
    )
