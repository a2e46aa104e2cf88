"""Domain: a planar region to be meshed, bounded by segments, arcs and curves, even-odd.

See the book, chapters 2.5 and 2.6d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Self, Unpack

import numpy as np

from ..base.arguments import as_flags, positive
from ..base.arrays import as_numbers, as_points, counted_off, frozen, refrozen
from ..base.errors import InputError
from ..base.files import as_path
from ..base.options import like, named
from ..geometry.curves import CurveLike
from ..geometry.outline import Outline
from . import card, derived, making
from .arguments import DomainOptions, as_curves, as_markers, as_seeds, as_segments, joined, refuse_tiny
from .plane import poly
from .plane.faults import refuse
from .plane.polygons import subtracted
from .plane.prescribed import carried
from .plane.repair import Repair
from .plane.sample import Sampled
from .plane.sources import read_domain
from .sides import SIDES, Side

__all__ = ["Domain", "as_domain"]


NO_SEEDS = frozen(np.empty((0, 2)))
NO_PIECES = frozen(np.empty((0, 2), dtype=np.int32))


class Domain(Outline):
    """A planar region that is to be meshed.

    *Facets* and *inner segments* are called *pieces* and numbered together: facets 0 to f - 1, then inner
    segments f to f + g - 1. A piece is straight unless ``curves`` has a curve for it.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Vertices. Those that no piece uses are `loose`: they become vertices of the mesh if they lie inside.
    facets : array_like of int, shape (f, 2)
        Pieces that bound the region. A point is inside if an odd number of them separates it from infinity;
        so chains within chains are holes, islands, and so on, in any order and direction. At every vertex an
        even number of facets must meet.
    inner : array_like of int, shape (g, 2), optional
        Interfaces, cracks, loose segments. They are edges of the mesh where they lie inside. They may have
        loose ends or be closed, and never make holes.
    curves : dict of int to curve, optional
        Piece -> `Arc`, `Curve`, `Bezier` or another object with ``point(t)``, from the first vertex of
        the piece to its second.
    markers : dict of str to array_like of int, optional
        Name -> pieces.
    regions : dict of str to array_like, shape (r, 2), optional
        Name -> seeds, points inside. A part of the region (as facets and inner pieces divide it) takes the
        name of the seed in it.
    resolve : bool, optional
        Repair what can be repaired instead of raising; `repairs` gives an account.

    Raises
    ------
    InputError
        For arrays of wrong shape or type, indices out of range, duplicate points, pieces of zero length,
        repeated, crossing or overlapping pieces, vertices on pieces, an odd number of facets at a vertex,
        curves that miss their ends, cross or touch, and seeds outside. The message names the first fault, its
        place and the remedy.

    Attributes
    ----------
    points, facets, inner, curves, markers, regions
        As given (after repairs); the arrays are read-only.
    repairs : list of Repair
        What ``resolve`` has changed; empty without it, and if nothing was wrong.
    max_areas : dict of str to float
        Area bounds of regions by name, as found by `Domain.read`; `refine` accepts them.
    hole_seeds : (h, 2) float64
        Points in holes, as found by `Domain.read`. Facets follow from them; they matter only for
        ``constrained_delaunay(domain, hull="holes")``.
    origin : (n,) int32
        For each point its number in the input, -1 for a crossing. Without ``resolve`` these are 0 to n - 1.
    piece_origin : (f + g,) int32
        The input piece that each piece is part of, -1 for one that closes a gap.

    Notes
    -----
    Faults are found by exact signs in O(n log n), without tolerances. Book: 2.5, 2.6d.
    """

    def __init__(
        self,
        points: Any,
        facets: Any,
        *,
        inner: Any = None,
        curves: Mapping[int, CurveLike] | None = None,
        markers: Mapping[str, Any] | None = None,
        regions: Mapping[str, Any] | None = None,
        resolve: bool = False,
    ):
        as_flags(resolve=resolve)
        coordinates = as_points(points)
        if coordinates.shape[1] not in SIDES:
            raise InputError(f"points must have shape (n, 2), not {coordinates.shape}")
        rows = as_segments(facets, "facets")
        others = NO_PIECES if inner is None else as_segments(inner, "inner")
        many = len(rows) + len(others)
        super().__init__(
            frozen(coordinates.copy()),  # a copy: later changes of the caller's array must not matter
            rows,
            others,
            {} if curves is None else as_curves(curves, many),
            {} if markers is None else as_markers(markers, many),
            {} if regions is None else as_seeds(regions),
        )
        self.repairs: list[Repair] = []
        self.max_areas: dict[str, float] = {}
        self.hole_seeds: np.ndarray = NO_SEEDS
        self.origin: np.ndarray = counted_off(len(self.points))
        self.piece_origin: np.ndarray = counted_off(many)
        if resolve:
            self._resolve()
        refuse(self, self._side.find_faults(self))
        if self.curves:
            self._side.check_ends(self)
        if self.regions:
            self._side.check_seeds_off_pieces(self)
        if self.curves or self.regions:  # the chords show where curves meet
            self._side.check_seeds(self, self._coarse)

    @property
    def dimension(self) -> int:
        """The number of coordinates: 2."""
        return self.points.shape[1]

    @property
    def _side(self) -> Side:
        return SIDES[self.dimension]

    @cached_property
    def _coarse(self) -> Sampled:
        return self._side.coarse(self)

    # ------------------------------------------------------------------ domains of something else than arrays

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
        cls, lower: Any = (0.0, 0.0), upper: Any = (1.0, 1.0), **options: Unpack[DomainOptions]
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
        cls, text: str, *, size: float = 1.0, font: str = "DejaVu Sans", **options: Unpack[DomainOptions]
    ) -> Self:
        return making.letters(cls, text, size=size, font=font, **options)

    @classmethod
    @like(making.from_geojson)
    def from_geojson(
        cls, geometry: Any, *, name: str | None = None, **options: Unpack[DomainOptions]
    ) -> Self:
        return making.from_geojson(cls, geometry, name=name, **options)

    # ------------------------------------------------------------------ domains and pictures of this one

    simplified = derived.simplified
    spaced = derived.spaced
    matched = derived.matched
    plot = derived.plot

    # ------------------------------------------------------------------ subsegments

    def sampled(self, size: Any = None, *, step: float = 1.0) -> Sampled:
        """The pieces cut into straight subsegments.

        Parameters
        ----------
        size : number, function (k, 2) -> (k,), size field, metric, or dict of region name to one, optional
            The wanted edge length; a `sizing.Metric` gives that in the direction of the piece. By regions, a
            piece takes the smaller size of its two sides, and the key None stands for regions that are not
            named. Without it straight pieces stay whole, and curves are cut as coarsely as is safe: the curve
            turns by at most 60 degrees over each chord, no chord meets another, and no vertex lies between a
            chord and its curve.
        step : float, optional
            The wanted length of subsegments, in units of the size.

        Returns
        -------
        Sampled
            With a size, the number of subsegments of a piece is the integral of ds / (step size), rounded to
            a whole number, and they have equal shares of it. They are cut further where they are not safe.

        Raises
        ------
        InputError
            For sizes that are not positive and finite, with the place.
        """
        if size is None:
            return self._coarse
        refuse_tiny(self.points)
        return self._side.sized(self, size, positive(step, "step"))

    # ------------------------------------------------------------------ inside and outside

    def contains(self, x: Any) -> np.ndarray:
        """Whether points lie inside, by the even-odd rule.

        Parameters
        ----------
        x : array_like, shape (..., 2)

        Returns
        -------
        ndarray of bool, shape (...)
            Exact for straight facets; points on them count as inside. A point that is on a curve, up to
            rounding, may be taken for inside or outside.
        """
        queries = as_numbers(x, "x")
        d = self.dimension
        if queries.ndim == 0 or queries.shape[-1] != d:
            raise InputError(f"x must have shape (..., {d}), not {queries.shape}")
        rows = as_points(queries.reshape(-1, d), "x")
        return self._side.contains(self, self._coarse, rows).reshape(queries.shape[:-1])

    @cached_property
    def area(self) -> float:
        """The area inside: correctly rounded for straight facets; for curves with some rounding errors."""
        return self._side.area(self, self._coarse)

    @cached_property
    def bounds(self) -> np.ndarray:
        """((smallest x, smallest y), (largest x, largest y)) of the points and, approximately, of curves."""
        return self._side.bounds(self, self._coarse)

    # ------------------------------------------------------------------ files and differences

    @classmethod
    @named(DomainOptions, resolve=False)
    def read(
        cls,
        source: str | Path,
        *,
        shape: str = "spline",
        name: str | None = None,
        **options: Unpack[DomainOptions],
    ) -> Self:
        """Read .poly, .node, GeoJSON, WKT, a Shapefile (.shp, with pyshp) or an airfoil's .dat.

        Parameters
        ----------
        source : str or Path
            A path, or a text of GeoJSON or WKT itself.
        shape : str
            For .dat, in Selig's or Lednicer's order: "spline" or "polygon". Markers are as in `naca`.
        name : str, optional
            The property that names features; see `from_geojson`.
        inner, curves, markers, regions, resolve : optional
            As for `Domain`; what is given is added to what the file has.

        Returns
        -------
        Domain
            Of .poly the region that Triangle would mesh: without the outside, and without holes from their
            seeds. Segments at what it removes are facets, others inner. Boundary markers other than 0 become
            markers, regional attributes regions, by their number; `max_areas` has their bounds. `origin`,
            `piece_origin`, `repairs` refer to the file, counted from 0. .node is a set of loose points.
        """
        return read_domain(cls, partial(making.of, cls), source, shape=shape, name=name, options=options)

    def write(self, path: str | Path) -> None:
        """Write Triangle's ``.poly``: curves by their coarse chords, holes by seeds.

        Markers and regions are numbers in this format. A name that is not a number is replaced by a free
        number, and a comment at the head of the file says so. A piece has one marker, the last that names it.
        """
        poly.write_poly(self, self._coarse, self.max_areas, self.hole_seeds, as_path(path))

    def with_holes(self, *others: Domain, resolve: bool = False) -> Self:
        """This domain minus others, which lie inside of it and apart from each other.

        Parameters
        ----------
        *others : Domain
            Markers and regions of equal names are joined.
        resolve : bool
            As for `Domain`; the others may then overlap, and lie partly or wholly outside.
        """
        as_flags(resolve=resolve)
        domains: list[Domain] = [self, *map(as_domain, others)]
        for domain in domains:
            derived.must_be_free(domain, "combined")
        group = np.repeat(np.arange(len(domains)), [len(d.facets) for d in domains])
        names = ["the domain", *(f"others[{i}]" for i in range(len(others)))]
        return subtracted(partial(making.of, type(self)), joined(domains), group, names, resolve=resolve)

    # ------------------------------------------------------------------ validation

    def _resolve(self) -> None:
        mended = self._side.repaired(self)
        self.points, self.origin, self.repairs = mended.points, mended.origin, mended.repairs
        self.facets, self.inner, self.piece_origin = mended.facets, mended.inner, mended.piece_origin
        self.curves, self.markers = mended.curves, mended.markers

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def _repr_html_(self) -> str:
        return card.html(self, len(self.repairs))

    def __repr__(self) -> str:
        curves = f", {len(self.curves)} curved" if self.curves else ""
        inner = f", {len(self.inner)} inner" if len(self.inner) else ""
        loose = f", {len(self.loose)} loose" if len(self.loose) else ""
        return f"<Domain: {len(self.points)} points, {len(self.facets)} facets{inner}{loose}{curves}>"


def as_domain(value: Any) -> Domain:
    """The domain itself, that of `Sampled` pieces, or an error that says what was given in its place."""
    if isinstance(value, Sampled):
        old = as_domain(value.outline)
        new = derived.followed(old, Domain(**value.parts()), value.origin, value.piece)
        carried(value, new)
        return new
    if not isinstance(value, Domain):
        raise InputError(f"domain must be a Domain, not {type(value).__name__}")
    return value
