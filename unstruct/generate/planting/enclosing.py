"""The boundary of what a tree is planted over, as straight pieces, and the root around it.

See the book, chapter 4a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...domain.domain import Domain, as_domain
from ...domain.plane.sample import Sampled
from ...mesh.mesh import Mesh
from ..tree.chords import straightened
from ..tree.contacts import Boundary, boundary_of
from ..tree.growing import as_box

__all__ = ["bounded", "domain_of", "root_of"]

Array = NDArray[np.float64]
ROOT_MARGIN = 1.0 / 64  # of the extent of a domain, between it and the sides of the root


def domain_of(value: Any, d: int) -> Domain | None:
    """The domain that is given; None if a box is."""
    if isinstance(value, Mesh) and value.points.shape[1] == 3 and value.dimension == 2:
        value = Domain.surface(value)
    return as_domain(value, d) if isinstance(value, Domain | Sampled) else None


def root_of(value: Any, domain: Domain | None, box: Any, d: int) -> Array:
    """The root (2, d): the box that is given, or a square or a cube around the domain, with a margin."""
    if domain is None:
        if box is not None:
            raise InputError("box goes with a domain; here the first argument is the box")
        return as_box(value, d)
    low, high = domain.bounds
    if box is None:
        middle, half = low + 0.5 * (high - low), (0.5 + ROOT_MARGIN) * float((high - low).max())
        return np.stack([middle - half, middle + half])
    root = as_box(box, d)
    if not ((low >= root[0]).all() and (high <= root[1]).all()):
        raise InputError(
            f"the box {root.tolist()} does not contain the domain, with bounds {domain.bounds.tolist()}"
        )
    return root


def bounded(domain: Domain, root: Array, deviation: float, turn: float, most: int) -> Boundary:
    """The pieces of the domain's boundary; curves are cut as `chords.straightened` says."""
    if domain.dimension == 3:
        shell = domain.triangulated
        return boundary_of(shell.points, shell.bounding, root, domain.contains)
    if not domain.curves:
        return boundary_of(domain.points, domain.facets, root, domain.contains)
    straight = straightened(domain, deviation, turn, most).domain
    return boundary_of(straight.points, straight.facets, root, straight.contains, deviation)
