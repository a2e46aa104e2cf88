"""The body between the hexahedra and the surface, filled with tetrahedra. See the book, chapter 4c."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...geometry.polygons import Polygons
from ...mesh.domain_mesh import DomainMesh
from ...sizing.field import SizeField
from ..bodies.dividing import Divided
from ..volume.coarse import coarse_facets
from ..volume.filling import filled
from ..volume.lattice import MOST_INNER, lattice_points
from .pattern import Cubes

__all__ = ["Strip", "strip_of"]


class Strip(NamedTuple):
    """The body between the kernel and the surface, and its mesh.

    Attributes
    ----------
    domain : Domain
        Points and facets of the body, divided by the size, and then those of the kernel.
    mesh : DomainMesh
        Tetrahedra.
    vertex : (k,) int64
        The vertices of the kernel that are its last points.
    points, facets : int
        How many the body has.
    """

    domain: Domain
    mesh: DomainMesh
    vertex: NDArray[np.int64]
    points: int
    facets: int

    @property
    def of_kernel(self) -> NDArray[np.bool_]:
        """Which of the mesh's ``faces`` are at the kernel."""
        piece = np.asarray(self.mesh.face_piece)
        return (piece >= self.facets) & (piece < len(self.domain.facets))

    @property
    def keeps_kernel(self) -> bool:
        """Whether the triangles of the kernel are faces, undivided."""
        own = self.of_kernel
        origin = np.asarray(self.mesh.origin)[self.mesh.faces[own]]
        return int(own.sum()) == len(self.domain.facets) - self.facets and bool((origin >= 0).all())


def strip_of(body: Domain, cubes: Cubes, parts: Divided | None, field: SizeField) -> Strip:
    """Fill what is between the surface of a body and cubes within; names of pieces are those of `parts`."""
    many, facets = len(body.points), len(body.facets)
    vertex = np.flatnonzero(flagged(len(cubes.points), cubes.outer))
    domain = body
    if len(vertex):
        rows = (np.searchsorted(vertex, cubes.outer) + many).astype(np.int32)
        every = Polygons.joined(Polygons.of(body.facets), Polygons.of_rows(rows))
        domain = Domain(np.concatenate([body.points, cubes.points[vertex]]), every, inner=body.inner)

    def name(piece: int) -> str:
        if facets <= piece < facets + len(cubes.outer):
            return "a face of a cube"
        own = piece if piece < facets else piece - len(cubes.outer)
        return body.name(own) if parts is None else parts.name(own)

    lattice = lattice_points(domain, field, MOST_INNER, coarse_facets(domain.triangulated, field))
    mesh = filled(domain, lattice, names=name, optimize=True)
    return Strip(domain, mesh, vertex, many, facets)
