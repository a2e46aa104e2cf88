"""Domain: what is to be meshed, bounded by segments and curves in the plane, by polygons in space, even-odd.

See the book, chapters 2.5, 2.6d and 2.8b.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from ..base.arguments import as_flags, positive
from ..base.arrays import as_numbers, as_points, counted_off, frozen, refrozen
from ..base.errors import InputError
from ..geometry.curves import CurveLike
from . import card, derived, making
from .arguments import as_curves, joined, named_parts, refuse_tiny
from .plane.faults import refuse
from .plane.polygons import subtracted
from .plane.prescribed import carried
from .plane.repair import Repair
from .plane.sample import Sampled
from .shaped import Shaped
from .sides import SIDES, Side
from .space.shells import emptied

__all__ = ["Domain", "as_domain"]


NO_SEEDS = frozen(np.empty((0, 2)))


class Domain(Shaped):
    """A region in the plane, or a body in space, that is to be meshed.

    *Facets* and *inner* pieces are called *pieces* and numbered together: facets 0 to f - 1, then inner
    pieces f to f + g - 1. In the plane a piece is straight unless ``curves`` has a curve for it.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
        Vertices. Those that no piece uses are `loose`: they become vertices of the mesh if they lie inside.
    facets : array_like of int, shape (f, 2); in space (f, k), or a list of rows
        Pieces that bound the region. A point is inside if an odd number of them separates it from infinity;
        so chains within chains are holes, islands, and so on, in any order and direction. At every vertex an
        even number of facets must meet; in space, at every edge. In space a facet is a polygon, a row of its
        vertices in order, or a list of rows: its outline and its holes. Vertices must lie in its plane up
        to 1/1000 of its extent; if they do not exactly, the facet is the triangles into which it is cut.
    inner : array_like of int, shape (g, 2), optional; in space a list of rows
        Interfaces, cracks, loose segments. They are edges of the mesh where they lie inside. They may have
        loose ends or be closed, and never make holes. In space they are polygons, and rows of two vertices
        are segments.
    curves : dict of int to curve, optional
        Piece -> `Arc`, `Curve`, `Bezier` or another object with ``point(t)``, from the first vertex of
        the piece to its second. In the plane only.
    markers : dict of str to array_like of int, optional
        Name -> pieces.
    regions : dict of str to array_like, shape (r, d), optional
        Name -> seeds, points inside. A part of the region (as facets and inner pieces divide it) takes the
        name of the seed in it.
    resolve : bool, optional
        Repair what can be repaired instead of raising; `repairs` gives an account. In space all facets are
        turned outward; holes of the surface, and facets that cross each other, remain errors.

    Raises
    ------
    InputError
        For arrays of wrong shape or type, indices out of range, duplicate points, pieces of zero length or
        area, repeated, crossing or overlapping pieces, vertices on pieces, an odd number of facets at a
        vertex (in space at an edge), polygons that are not flat or touch themselves, curves that miss their
        ends, cross or touch, and seeds outside. The message names the first fault, its place, the remedy.

    Attributes
    ----------
    points, facets, inner, curves, markers, regions
        As given (after repairs); the arrays are read-only.
    repairs : list of Repair
        What ``resolve`` has changed; empty without it, and if nothing was wrong.
    max_areas : dict of str to float
        Area bounds of regions by name, as found by `Domain.read`; `refine` accepts them.
    hole_seeds : (h, 2) float64; in space (h, 3)
        Points in holes, as found by `Domain.read`. Facets follow from them; they matter only for
        ``constrained_delaunay(domain, hull="holes")``.
    origin : (n,) int32
        For each point its number in the input, -1 for a crossing. Without ``resolve`` these are 0 to n - 1.
    piece_origin : (f + g,) int32
        The input piece that each piece is part of, -1 for one that closes a gap.

    Notes
    -----
    Faults are found by exact signs in O(n log n), without tolerances. Book: 2.5, 2.6d, 2.8b.
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
            raise InputError(f"points must have shape (n, 2) or (n, 3), not {coordinates.shape}")
        rows, others = SIDES[coordinates.shape[1]].rows(facets, inner)
        if curves is not None and coordinates.shape[1] == 3:
            raise InputError("curves are for planar domains; in space give more facets where a body is round")
        many = len(rows) + len(others)
        super().__init__(
            frozen(coordinates.copy()),  # a copy: later changes of the caller's array must not matter
            rows,
            others,
            {} if curves is None else as_curves(curves, many),
            *named_parts(markers, regions, many, coordinates.shape[1]),
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
            self._side.check_seeds_off_pieces(self, None if self.dimension == 2 else self._coarse)
        if self.curves or self.regions:  # the chords show where curves meet
            self._side.check_seeds(self, self._coarse)

    @property
    def dimension(self) -> int:
        """The number of coordinates: 2 or 3."""
        return self.points.shape[1]

    @property
    def _side(self) -> Side:
        return SIDES[self.dimension]

    @cached_property
    def _coarse(self) -> Any:
        return self._side.coarse(self)

    # ------------------------------------------------------------------ domains and pictures of this one

    simplified = derived.simplified
    spaced = derived.spaced
    matched = derived.matched
    plot = derived.plot
    turned = cached_property(derived.turned)

    # ------------------------------------------------------------------ subsegments

    def sampled(self, size: Any = None, *, step: float = 1.0) -> Sampled:
        """The pieces of a planar domain cut into straight subsegments.

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
        derived.must_be_planar(self, "sampled")
        if size is None:
            return self._coarse
        refuse_tiny(self.points)
        return self._side.sized(self, size, positive(step, "step"))

    @property
    def triangulated(self) -> Any:
        """The pieces of a body in space as triangles and segments, each with its piece: a `Shell`."""
        derived.must_be_spatial(self, "triangles: mesh it, or ask for domain.sampled()")
        return self._coarse

    # ------------------------------------------------------------------ inside and outside

    def contains(self, x: Any) -> np.ndarray:
        """Whether points lie inside, by the even-odd rule.

        Parameters
        ----------
        x : array_like, shape (..., 2); in space (..., 3)

        Returns
        -------
        ndarray of bool, shape (...)
            Exact for straight facets; points on them count as inside. A point that is on a curve, up to
            rounding, may be taken for inside or outside.

        Raises
        ------
        InputError
            For coordinates that are not finite, or as many as the domain does not have.
        """
        queries = as_numbers(x, "x")
        d = self.dimension
        if queries.ndim == 0 or queries.shape[-1] != d:
            raise InputError(f"x must have shape (..., {d}), not {queries.shape}")
        rows = as_points(queries.reshape(-1, d), "x")
        return self._side.contains(self, self._coarse, rows).reshape(queries.shape[:-1])

    @cached_property
    def area(self) -> float:
        """The area inside of a planar domain: correctly rounded for straight facets, nearly so for curves."""
        derived.must_be_planar(self, "measured by an area, but by its volume")
        return self._side.measure(self, self._coarse)

    @cached_property
    def volume(self) -> float:
        """The volume inside of a body in space, correctly rounded."""
        derived.must_be_spatial(self, "a volume, but an area")
        return self._side.measure(self, self._coarse)

    @cached_property
    def bounds(self) -> np.ndarray:
        """((smallest x, ...), (largest x, ...)) of the points and, approximately, of curves: (2, d)."""
        return self._side.bounds(self, self._coarse)

    # ------------------------------------------------------------------ files and differences

    write = derived.write

    def with_holes(self, *others: Domain, resolve: bool = False) -> Self:
        """This domain minus others, which lie inside of it and apart from each other.

        Parameters
        ----------
        *others : Domain
            Markers and regions of equal names are joined. In space, for example, a box around a body: the
            body's facets keep their names and, in `tetrahedralize`, their triangles.
        resolve : bool
            As for `Domain`; the others may then, in the plane, overlap, and lie partly or wholly outside.
        """
        as_flags(resolve=resolve)
        domains: list[Domain] = [self, *(as_domain(other, self.dimension) for other in others)]
        if self.dimension == 3:
            return emptied(partial(making.of, type(self)), joined(domains), domains, resolve=resolve)
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
        self.curves = mended.curves
        many = len(self.facets) + len(self.inner)
        self.markers, _ = named_parts(mended.markers, None, many, self.dimension)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def _repr_html_(self) -> str:
        return card.html(self, len(self.repairs))

    def __repr__(self) -> str:
        curves = f", {len(self.curves)} curved" if self.curves else ""
        inner = f", {len(self.inner)} inner" if len(self.inner) else ""
        loose = f", {len(self.loose)} loose" if len(self.loose) else ""
        return f"<Domain: {len(self.points)} points, {len(self.facets)} facets{inner}{loose}{curves}>"


def as_domain(value: Any, dimension: int | None = 2) -> Domain:
    """The domain itself, that of `Sampled` pieces, or an error that says what was given in its place.

    Parameters
    ----------
    dimension : int or None
        What it must have; None for any.
    """
    if isinstance(value, Sampled):
        old = as_domain(value.outline)
        new = derived.followed(old, Domain(**value.parts()), value.origin, value.piece)
        carried(value, new)
        return new
    if not isinstance(value, Domain):
        raise InputError(f"domain must be a Domain, not {type(value).__name__}")
    if dimension not in (None, value.dimension):
        kind = "planar domains" if dimension == 2 else "bodies in space"
        raise InputError(f"this is for {kind}; the domain has points of {value.dimension} coordinates")
    return value
