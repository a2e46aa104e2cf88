"""Domains of ready-made shapes: polygons, discs, smooth rings, airfoils, letters, and geometries.

See the book, chapter 2.6d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, TypeVar, Unpack

import numpy as np

from ..base.arguments import as_flag, as_mapping
from ..base.errors import InputError
from ..base.options import named
from ..geometry.polygons import Polygons
from .arguments import DomainOptions, as_segments
from .plane import shapes
from .plane.features import features_of, from_features
from .plane.polygons import polygon as cut_out
from .plane.sources import as_geometry
from .plane.splines import smooth_rings
from .space.rows import as_polygons

__all__ = ["disc", "from_geojson", "letters", "naca", "of", "polygon", "rectangle", "smooth"]

Made = TypeVar("Made")  # `Domain`, or a class that is derived from it


def of(cls: type[Made], parts: shapes.Parts, options: Mapping[str, Any]) -> Made:
    """A domain of ready-made parts and options; curves, markers, regions and inner pieces are joined."""
    options = dict(options)
    for name in {"curves", "markers", "regions"} & set(parts):
        more = options.get(name)
        options[name] = {**parts[name], **as_mapping({} if more is None else more, name)}
    if options.get("inner") is not None and parts.get("inner") is not None:
        options["inner"] = _both(parts["inner"], options["inner"])
    make: Any = cls
    return make(**{**parts, **options})


def _both(ready: Any, given: Any) -> Any:
    """The inner pieces of a ready-made shape, then those that are given."""
    if isinstance(ready, Polygons):
        return Polygons.joined(ready, as_polygons(given, "inner", 2))
    return np.concatenate([as_segments(rows, "inner") for rows in (ready, given)])


@named(DomainOptions, resolve=False)
def polygon(cls: type[Made], outer: Any, holes: Sequence[Any] = (), **options: Unpack[DomainOptions]) -> Made:
    """A polygon with holes.

    Parameters
    ----------
    outer : array_like, shape (k, 2)
        Corners in order, in either direction; a last corner equal to the first is left out.
    holes : sequence of array_like, optional
        Rings of what is removed, inside of outer; they may touch it and each other in points. With
        ``resolve=True`` they may lie anywhere and overlap, and `repairs` has an account.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`; points and pieces are numbered along the rings.
    """
    least = 1 if as_flag(options.get("resolve", False), "resolve") else 3
    return cut_out(partial(of, cls), shapes.rings(outer, holes, least), shapes.ring_names(holes), options)


@named(DomainOptions, resolve=False)
def smooth(
    cls: type[Made],
    outer: Any,
    holes: Sequence[Any] = (),
    *,
    corners: Any = None,
    corner_angle: float | None = None,
    **options: Unpack[DomainOptions],
) -> Made:
    """As `polygon`, with smooth closed curves through the vertices: cubic splines by chord length.

    Parameters
    ----------
    outer, holes
        As for `polygon`.
    corners : array_like of int, optional
        Vertices, numbered along the rings, where the curve may turn sharply (the trailing edge of an
        airfoil): it is smooth between them, and its curvature becomes zero toward them. Between two
        successive corners it is straight.
    corner_angle : float, optional
        Vertices where the polygon turns by more than this angle, in degrees, are corners, too.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`; points and pieces are numbered along the rings.
    """
    return cut_out(
        partial(of, cls), smooth_rings(outer, holes, corners, corner_angle), shapes.ring_names(holes), options
    )


@named(DomainOptions, resolve=False)
def rectangle(
    cls: type[Made], lower: Any = (0.0, 0.0), upper: Any = (1.0, 1.0), **options: Unpack[DomainOptions]
) -> Made:
    """A rectangle by two corners; its pieces and markers are "bottom", "right", "top" and "left".

    Parameters
    ----------
    lower, upper : (2,) array_like
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.
    """
    return of(cls, shapes.rectangle(lower, upper), options)


@named(DomainOptions, resolve=False)
def disc(
    cls: type[Made], center: Any = (0.0, 0.0), radius: float = 1.0, **options: Unpack[DomainOptions]
) -> Made:
    """A disc, bounded by four arcs.

    Parameters
    ----------
    center : (2,) array_like
    radius : float
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.
    """
    return of(cls, shapes.disc(center, radius), options)


@named(DomainOptions, resolve=False)
def naca(
    cls: type[Made],
    digits: str,
    *,
    chord: float = 1.0,
    nose: Any = (0.0, 0.0),
    attack: float = 0.0,
    closed: bool = True,
    **options: Unpack[DomainOptions],
) -> Made:
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
    inner, curves, markers, regions, resolve : optional
        As for `Domain`. Markers are "upper", "lower", and "trailing edge" if that is open.

    Notes
    -----
    E. N. Jacobs, K. E. Ward, R. M. Pinkerton, *The characteristics of 78 related airfoil sections*, NACA
    report 460 (1933).
    """
    return of(cls, shapes.airfoil(digits, chord, nose, attack, closed), options)


@named(DomainOptions, resolve=False)
def letters(
    cls: type[Made],
    text: str,
    *,
    size: float = 1.0,
    font: str = "DejaVu Sans",
    **options: Unpack[DomainOptions],
) -> Made:
    """The outlines of a text as matplotlib sets it, with the font's own Bezier curves; needs matplotlib.

    Parameters
    ----------
    text : str
    size : float
        The size of the font; the line starts at the origin.
    font : str
        A font family that matplotlib knows; DejaVu Sans comes with matplotlib.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.
    """
    return of(cls, shapes.letters(text, size, font), options)


@named(DomainOptions, resolve=False)
def from_geojson(
    cls: type[Made], geometry: Any, *, name: str | None = None, **options: Unpack[DomainOptions]
) -> Made:
    """What GeoJSON mappings cover, or anything with ``__geo_interface__`` such as shapely's geometry.

    Parameters
    ----------
    geometry : mapping, object, or iterable of these; or str or Path
        Also GeoJSON or WKT as a text, or the path of a file of either or of a Shapefile.
        Several polygons cover what each of them covers; common borders are inner segments. Lines become
        inner segments, points loose vertices. Equal coordinates become one vertex, and segments are split
        at vertices that lie on them. With ``resolve=True`` crossings are split, too, the first polygon
        owns what overlaps, and `repairs` has an account.
    name : str, optional
        The property that names features: the regions of polygons, the markers of lines. By default that
        is "name", "NAME" or "id"; without any the number of the feature in its collection is its name.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.
    """
    if name is not None and not isinstance(name, str):
        raise InputError(f"name must be the name of a property, not {name!r:.60}")
    resolve = as_flag(options.get("resolve", False), "resolve")
    found = from_features(features_of(as_geometry(geometry), name), resolve=resolve)
    domain: Any = of(cls, found.parts, options)
    domain.repairs[:0] = found.repairs
    return domain
