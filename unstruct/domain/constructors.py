"""Ways to make a `Domain`: shapes, files, other libraries' geometry, several domains in one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from ..base.arguments import as_mapping
from ..base.arrays import frozen, refrozen
from .arguments import as_domain, as_segments, joined
from .plane import shapes as shapes
from .plane.shapes import Parts

if TYPE_CHECKING:
    from .domain import Domain
    from .plane.repair import Repair

__all__ = ["Constructors"]


class Constructors:
    """The class methods by which a `Domain` is made."""

    max_areas: dict[str, float]
    repairs: list[Repair]
    origin: np.ndarray
    piece_origin: np.ndarray

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    @classmethod
    def _of(cls, parts: Parts, options: Mapping[str, Any]) -> Self:
        """A domain of ready-made parts and the caller's options; curves, markers, regions, inner joined."""
        options = dict(options)
        for name in {"curves", "markers", "regions"} & set(parts):
            options[name] = {**parts[name], **as_mapping(options.get(name) or {}, name)}
        if options.get("inner") is not None and parts.get("inner") is not None:
            both = [as_segments(rows, "inner") for rows in (parts["inner"], options["inner"])]
            options["inner"] = np.concatenate(both)
        make: Any = cls
        return make(**{**parts, **options})

    @classmethod
    def polygon(cls, outer: Any, holes: Sequence[Any] = (), **options: Any) -> Self:
        """A polygon with holes.

        Parameters
        ----------
        outer : array_like, shape (k, 2)
            Corners in order, either way round; a last corner equal to the first is left out.
        holes : sequence of array_like, optional
            Rings; by the even-odd rule a ring within a hole is an island.
        **options
            As for `Domain`; piece numbers run along the rings.
        """
        return cls._of(shapes.rings(outer, holes), options)

    @classmethod
    def smooth(cls, outer: Any, holes: Sequence[Any] = (), **options: Any) -> Self:
        """The same with smooth closed curves through the corners: periodic cubic splines by chord length."""
        return cls._of(shapes.smooth_rings(outer, holes), options)

    @classmethod
    def rectangle(cls, lower: Any = (0.0, 0.0), upper: Any = (1.0, 1.0), **options: Any) -> Self:
        """A rectangle by two corners; pieces bottom, right, top, left, which are also its markers."""
        return cls._of(shapes.rectangle(lower, upper), options)

    @classmethod
    def disc(cls, center: Any = (0.0, 0.0), radius: float = 1.0, **options: Any) -> Self:
        """A disc, bounded by four arcs."""
        return cls._of(shapes.disc(center, radius), options)

    @classmethod
    def naca(
        cls,
        digits: str,
        *,
        chord: float = 1.0,
        nose: Any = (0.0, 0.0),
        attack: float = 0.0,
        closed: bool = True,
        **options: Any,
    ) -> Self:
        """A NACA four-digit airfoil section, as true curves.

        Parameters
        ----------
        digits : str
            Camber in percent of the chord, its place in tenths, thickness in percent: "0012", "2412".
        chord : float
        nose : (2,) array_like
            Where the leading edge lies.
        attack : float
            Angle of attack in degrees: the tail is turned down by it.
        closed : bool
            Whether the trailing edge is sharp (last coefficient 0.1036 instead of 0.1015).
        **options
            As for `Domain`. Markers are "upper", "lower", and "trailing edge" where that is open.

        Notes
        -----
        E. N. Jacobs, K. E. Ward, R. M. Pinkerton, *The characteristics of 78 related airfoil sections*, NACA
        report 460 (1933).
        """
        return cls._of(shapes.airfoil(digits, chord, nose, attack, closed), options)

    @classmethod
    def letters(cls, text: str, *, size: float = 1.0, font: str = "DejaVu Sans", **options: Any) -> Self:
        """The outlines of a text as matplotlib sets it, with the font's own Bezier curves; needs matplotlib.

        Parameters
        ----------
        text : str
        size : float
            The size of the font; the line starts at the origin.
        font : str
            A family that matplotlib knows; DejaVu Sans comes with it.
        """
        return cls._of(shapes.letters(text, size, font), options)

    @classmethod
    def from_geojson(cls, geometry: Any, **options: Any) -> Self:
        """Rings of a GeoJSON mapping, or of anything with ``__geo_interface__`` such as shapely's geometry.

        Parameters
        ----------
        geometry : mapping or object
            Rings of polygons become facets (even-odd: the order of rings does not matter), lines inner
            segments, points loose vertices; equal coordinates one vertex. Polygons that share a side need
            ``resolve=True``: the side cancels then.
        """
        return cls._of(shapes.outlines(geometry), options)

    @classmethod
    def read(cls, path: str | Path, **options: Any) -> Self:
        """Read Triangle's ``.poly`` (with its ``.node`` where it has no vertices itself).

        Parameters
        ----------
        path : str or Path
        **options
            As for `Domain`.

        Returns
        -------
        Domain
            What Triangle would mesh: the outside is eaten away from beyond as far as segments do not stop it,
            and so are holes from their seeds. Segments between inside and outside are facets, the others
            inner. Boundary markers other than 0 become markers named by their number, regional attributes
            regions named by their value; `max_areas` keeps the area bounds of regions by these names.
            `origin`, `piece_origin` and `repairs` refer to the vertices and segments of the file, counted
            from 0 (-1 for pieces that ``options`` add).
        """
        from .plane.poly import read_poly

        poly = read_poly(Path(path), resolve=bool(options.get("resolve")))
        domain = cls._of(poly.parts, options)
        domain.max_areas.update(poly.areas)
        domain.repairs[:0] = poly.walls.repairs
        domain.origin = _composed(poly.walls.origin, domain.origin)
        domain.piece_origin = _composed(poly.piece_origin, domain.piece_origin)
        return domain

    def write(self, path: str | Path) -> None:
        """Write Triangle's ``.poly``: curves as their coarse chords, holes by seeds.

        Markers and regions are numbers there: names that are none get free ones, which a comment at the
        head of the file explains. A piece has one marker: the last of those that name it.
        """
        from .plane.poly import write_poly

        write_poly(cast("Domain", self), Path(path))

    def with_holes(self, *others: Domain, resolve: bool = False) -> Self:
        """All pieces together: by the even-odd rule, what lies inside becomes a hole.

        Parameters
        ----------
        *others : Domain
            Their markers and regions of equal name are joined with those here.
        resolve : bool
            As for `Domain`.
        """
        make: Any = type(self)
        return make(**joined([cast("Domain", self), *map(as_domain, others)]), resolve=resolve)


def _composed(first: np.ndarray, then: np.ndarray) -> np.ndarray:
    """``first[then]``, -1 where there is none."""
    known = (then >= 0) & (then < len(first))
    return frozen(
        np.where(known, first[np.where(known, then, 0)], -1).astype(np.int32) if len(first) else then
    )
