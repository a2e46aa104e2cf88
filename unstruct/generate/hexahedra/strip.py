"""The body between the hexahedra and the surface, filled with tetrahedra. See the book, chapter 4c."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...geometry.polygons import Polygons
from ...mesh.domain_mesh import DomainMesh
from ...sizing.field import SizeField
from ..bodies.covering import Cover
from ..bodies.dividing import Divided, Pieces, divided_around
from ..volume.coarse import coarse_facets
from ..volume.filling import filled
from ..volume.lattice import MOST_INNER, lattice_points
from .pattern import Cubes

__all__ = ["Strip", "strip_around", "strip_of"]

Numbers = NDArray[np.int64]


class Strip(NamedTuple):
    """The body between the kernel and the surface, and its mesh.

    Attributes
    ----------
    domain : Domain
        Facets of the body, divided by the size, and then those of the kernel.
    mesh : DomainMesh
        Tetrahedra.
    core : (n,) int64
        The vertex of the kernel at each of its points, or -1.
    given : (n,) int64
        The point of the body at each of its points, or -1.
    facets : int
        How many facets are not the kernel's.
    parts : Divided, Pieces or None
        What these, and inner pieces, are parts of.
    """

    domain: Domain
    mesh: DomainMesh
    core: Numbers
    given: Numbers
    facets: int
    parts: Divided | Pieces | None

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


def strip_of(body: Domain, cubes: Cubes, parts: Divided | None, field: SizeField, given: int) -> Strip:
    """Fill what is between the surface of a body and cubes within.

    The first ``given`` points of `body` are those of the domain; names of pieces are those of `parts`.
    """
    many, facets = len(body.points), len(body.facets)
    vertex = np.flatnonzero(flagged(len(cubes.points), cubes.outer))
    domain = body
    if len(vertex):
        rows = (np.searchsorted(vertex, cubes.outer) + many).astype(np.int32)
        every = Polygons.joined(Polygons.of(body.facets), Polygons.of_rows(rows))
        domain = Domain(np.concatenate([body.points, cubes.points[vertex]]), every, inner=body.inner)
    core, own = np.full(many + len(vertex), -1), np.full(many + len(vertex), -1)
    core[many:], own[:given] = vertex, np.arange(given)
    name = body.name if parts is None else parts.name
    return _filled(Strip(domain, None, core, own, facets, parts), field, name)  # type: ignore[arg-type]


def strip_around(
    domain: Domain, cubes: Cubes, cover: tuple[Cover, Numbers], field: SizeField, everything: bool
) -> Strip:
    """The same where cubes end at facets: `cover` has what they cover, and the numbers of vertices."""
    around, place = cover
    made = divided_around(domain, field, everything, around)
    outer = place[cubes.outer]
    used = flagged(
        len(made.points), made.facets, outer, *([np.concatenate(made.inner)] if made.inner else [])
    )
    used[domain.loose] = True
    number = np.cumsum(used) - 1
    rows = np.concatenate([made.facets, outer])
    inner = [number[row] for row in made.inner]
    body = Domain(made.points[used], number[rows].astype(np.int32), inner=inner or None)
    core, own = np.full(len(made.points), -1), np.full(len(made.points), -1)
    own[: len(domain.points)] = np.arange(len(domain.points))
    ends = np.flatnonzero(place >= 0)  # also those at which the strip only touches the kernel
    core[place[ends]] = ends

    def name(piece: int) -> str:
        return domain.name(int(made.parent[piece]))

    strip = Strip(body, None, core[used], own[used], len(made.facets), made)  # type: ignore[arg-type]
    return _filled(strip, field, name)


def _filled(strip: Strip, field: SizeField, names: Any) -> Strip:
    domain, facets = strip.domain, strip.facets
    outer = len(domain.facets) - facets

    def name(piece: int) -> str:
        if facets <= piece < facets + outer:
            return "a face of a cube"
        return names(piece if piece < facets else piece - outer)

    lattice = lattice_points(domain, field, MOST_INNER, coarse_facets(domain.triangulated, field))
    return strip._replace(mesh=filled(domain, lattice, names=name, optimize=True))
