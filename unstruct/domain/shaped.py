"""Domains of something else than arrays: ready-made shapes and bodies, geometries, meshes, files.

See the book, chapters 2.6d and 2.8b.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, Self, Unpack

from ..base.options import like, named
from ..geometry.outline import Outline
from . import bodies, making
from .arguments import DomainOptions
from .reading import read

__all__ = ["Shaped"]


class Shaped(Outline):
    """The class methods of a `Domain` that make one of something else than arrays."""

    # ------------------------------------------------------------------ in the plane

    @classmethod
    @like(making.polygon)
    def polygon(cls, outer: Any, holes: Sequence[Any] = (), **options: Unpack[DomainOptions]) -> Self:
        return making.polygon(cls, outer, holes, **options)

    @classmethod
    @like(making.smooth)
    def smooth(
        cls,
        outer: Any,
        holes: Sequence[Any] = (),
        *,
        corners: Any = None,
        corner_angle: float | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return making.smooth(cls, outer, holes, corners=corners, corner_angle=corner_angle, **options)

    @classmethod
    @like(making.rectangle)
    def rectangle(
        cls,
        lower: Any = (0.0, 0.0),
        upper: Any = (1.0, 1.0),
        **options: Unpack[DomainOptions],
    ) -> Self:
        return making.rectangle(cls, lower, upper, **options)

    @classmethod
    @like(making.disc)
    def disc(cls, center: Any = (0.0, 0.0), radius: float = 1.0, **options: Unpack[DomainOptions]) -> Self:
        return making.disc(cls, center, radius, **options)

    @classmethod
    @like(making.naca)
    def naca(
        cls,
        digits: str,
        *,
        chord: float = 1.0,
        nose: Any = (0.0, 0.0),
        attack: float = 0.0,
        closed: bool = True,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return making.naca(cls, digits, chord=chord, nose=nose, attack=attack, closed=closed, **options)

    @classmethod
    @like(making.letters)
    def letters(
        cls,
        text: str,
        *,
        size: float = 1.0,
        font: str = "DejaVu Sans",
        **options: Unpack[DomainOptions],
    ) -> Self:
        return making.letters(cls, text, size=size, font=font, **options)

    @classmethod
    @like(making.from_geojson)
    def from_geojson(
        cls,
        geometry: Any,
        *,
        name: str | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return making.from_geojson(cls, geometry, name=name, **options)

    # ------------------------------------------------------------------ bodies in space

    @classmethod
    @like(bodies.box)
    def box(
        cls,
        lower: Any = (0.0, 0.0, 0.0),
        upper: Any = (1.0, 1.0, 1.0),
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.box(cls, lower, upper, **options)

    @classmethod
    @like(bodies.ball)
    def ball(
        cls,
        center: Any = (0.0, 0.0, 0.0),
        radius: float = 1.0,
        size: float | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.ball(cls, center, radius, size, **options)

    @classmethod
    @like(bodies.torus)
    def torus(
        cls,
        center: Any = (0.0, 0.0, 0.0),
        radius: float = 1.0,
        tube: float = 0.4,
        size: float | None = None,
        *,
        axis: Any = (0.0, 0.0, 1.0),
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.torus(cls, center, radius, tube, size, axis=axis, **options)

    @classmethod
    @like(bodies.cylinder)
    def cylinder(
        cls,
        start: Any = (0.0, 0.0, 0.0),
        end: Any = (0.0, 0.0, 1.0),
        radius: float = 0.5,
        size: float | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.cylinder(cls, start, end, radius, size, **options)

    @classmethod
    @like(bodies.extruded)
    def extruded(
        cls,
        planar: Any,
        height: Any = 1.0,
        *,
        size: Any = None,
        layers: int | None = None,
        ends: Any = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.extruded(cls, planar, height, size=size, layers=layers, ends=ends, **options)

    @classmethod
    @like(bodies.revolved)
    def revolved(
        cls,
        planar: Any,
        angle: float = 360.0,
        *,
        size: Any = None,
        count: int | None = None,
        ends: Any = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        return bodies.revolved(cls, planar, angle, size=size, count=count, ends=ends, **options)

    @classmethod
    @like(bodies.surface)
    def surface(cls, mesh: Any, *, merge: float | None = None, **options: Unpack[DomainOptions]) -> Self:
        return bodies.surface(cls, mesh, merge=merge, **options)

    # ------------------------------------------------------------------ files

    @classmethod
    @named(DomainOptions, resolve=False)
    def read(
        cls,
        source: str | Path,
        *,
        shape: str = "spline",
        name: str | None = None,
        merge: float | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        """Read .poly, .node, GeoJSON, WKT, a Shapefile (.shp, with pyshp), an airfoil's .dat, or a body.

        Parameters
        ----------
        source : str or Path
            A path, or a text of GeoJSON or WKT itself. Bodies: .stl, .off, .ply, .obj, TetGen's .smesh, .poly
            and .node, and meshes of surfaces in space that `Mesh.read` reads.
        shape : str
            For .dat, in Selig's or Lednicer's order: "spline" or "polygon". Markers are as in `naca`.
        name : str, optional
            The property that names features; see `from_geojson`.
        merge : float, optional
            Of surfaces in space, points that are not farther apart become one, as where the triangles of an
            .stl do not quite fit; facets that lose their area are dropped.
        inner, curves, markers, regions, resolve : optional
            As for `Domain`; what is given is added to what the file has.

        Returns
        -------
        Domain
            Of .poly the region that Triangle would mesh: without the outside, and without holes from their
            seeds. Segments at what it removes are facets, others inner; so it is with TetGen's files.
            Boundary markers other than 0 become markers, regional attributes regions, by their number;
            `max_areas` has their bounds. Solids of .stl, groups and objects of .obj are markers. Equal
            corners of .stl are one point, and `repairs` says how many. `origin`, `piece_origin`, `repairs`
            refer to the file, counted from 0. .node, and other files without facets, are sets of loose
            points.
        """
        return read(
            cls, partial(making.of, cls), source, shape=shape, name=name, merge=merge, options=options
        )
