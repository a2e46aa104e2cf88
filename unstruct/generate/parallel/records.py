"""One part of a region: what a worker is given, and what it does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import MeshError
from ...domain.derived import held_by
from ...domain.domain import Domain
from ...geometry.curves import CurveLike
from ...mesh.domain_mesh import DomainMesh
from .coarse import WHOLE_PIECE

__all__ = ["Part", "mesh_part"]


@dataclass(frozen=True)
class Part:
    """A part of a region, small enough to be sent to a worker: its boundary, its size, how it is meshed.

    Attributes
    ----------
    number, parts : int
        Which part of how many.
    points : (n, 2) float64
    vertices : (n,) int64
        For each point its number among those that all parts share.
    facets, inner : (f, 2) and (g, 2) int32
        Its pieces.
    rows : (f + g,) int64
        For each piece the subsegment of the whole that it is, -1 for a piece of an interface.
    held : (h,) int64
        Pieces that get no further points: those on interfaces.
    curves : dict of int to curve
    regions : dict of str to (r, 2) float64
        Points inside of each region of the whole, by its number as a text.
    size : size, or dict of str to size
    method : callable
        Takes a domain and a size.
    predicted : float
        How many cells it is expected to have.
    """

    number: int
    parts: int
    points: NDArray[np.float64]
    vertices: NDArray[np.int64]
    facets: NDArray[np.int32]
    inner: NDArray[np.int32]
    rows: NDArray[np.int64]
    held: NDArray[np.int64]
    curves: dict[int, CurveLike]
    regions: dict[str, NDArray[np.float64]]
    size: Any
    method: Callable[..., DomainMesh]
    predicted: float

    @property
    def domain(self) -> Domain:
        """The part as a domain that can be meshed by itself."""
        made = Domain(self.points, self.facets, inner=self.inner, curves=self.curves, regions=self.regions)
        return held_by(made, {int(k): WHOLE_PIECE for k in self.held}, [])

    def __repr__(self) -> str:
        return f"<Part {self.number} of {self.parts}: about {self.predicted:.0f} cells>"


def mesh_part(part: Part) -> DomainMesh:
    """Mesh one part.

    Raises
    ------
    MeshError
        If it cannot be meshed; the message names the part, where it lies, and why.
    """
    try:
        return part.method(part.domain, part.size)
    except Exception as error:
        low, high = part.points.min(axis=0), part.points.max(axis=0)
        where = f"from ({low[0]:.6g}, {low[1]:.6g}) to ({high[0]:.6g}, {high[1]:.6g})"
        raise MeshError(
            f"part {part.number} of {part.parts}, {where}, was not meshed: {type(error).__name__}: {error}"
        ) from error
