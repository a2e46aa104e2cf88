"""Bodies in space of ready-made shapes: boxes, balls, tori, cylinders, planar domains that are swept, meshes.

See the book, chapter 2.8b.
"""

from __future__ import annotations

from typing import Any, TypeVar, Unpack

from ..base.options import named
from .arguments import DomainOptions
from .making import of
from .space import bodies, surfaces, swept, welding

__all__ = ["ball", "box", "cylinder", "extruded", "revolved", "surface", "torus"]

Body = TypeVar("Body")  # `Domain`, or a class that is derived from it


@named(DomainOptions, resolve=False)
def box(
    cls: type[Body],
    lower: Any = (0.0, 0.0, 0.0),
    upper: Any = (1.0, 1.0, 1.0),
    **options: Unpack[DomainOptions],
) -> Body:
    """A box by two corners: six rectangles, which are the markers.

    Parameters
    ----------
    lower, upper : (3,) array_like
        "left" and "right" are the sides of least and greatest x, "front" and "back" those of y, "bottom" and
        "top" those of z, in this order.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.

    Returns
    -------
    Domain
    """
    return of(cls, bodies.box(lower, upper), options)


@named(DomainOptions, resolve=False)
def ball(
    cls: type[Body],
    center: Any = (0.0, 0.0, 0.0),
    radius: float = 1.0,
    size: float | None = None,
    **options: Unpack[DomainOptions],
) -> Body:
    """A ball, bounded by the triangles of a divided icosahedron with its points on the sphere.

    Parameters
    ----------
    center : (3,) array_like
    radius : float
    size : float, optional
        The wanted edge length, in the unit of the points; a fifth of the radius by default.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.

    Returns
    -------
    Domain
        20 n^2 triangles with edges between .9 and 1.25 of the size, and angles between 54 and 72 degrees.

    Raises
    ------
    InputError
        For a radius or size that is not positive and finite.

    Notes
    -----
    O(k log k) for k points, before the checks of `Domain`.
    """
    return of(cls, bodies.ball(center, radius, size), options)


@named(DomainOptions, resolve=False)
def torus(
    cls: type[Body],
    center: Any = (0.0, 0.0, 0.0),
    radius: float = 1.0,
    tube: float = 0.4,
    size: float | None = None,
    *,
    axis: Any = (0.0, 0.0, 1.0),
    **options: Unpack[DomainOptions],
) -> Body:
    """A torus, bounded by triangles with their vertices on the true surface.

    Parameters
    ----------
    center : (3,) array_like
    radius : float
        Of the circle in the middle of the tube.
    tube : float
        The radius of the tube, less than the other one.
    size : float, optional
        The wanted edge length, a fifth of that of the tube by default, and not more than it.
    axis : (3,) array_like
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.

    Returns
    -------
    Domain
        Edges of about equal length everywhere, angles between 39 and 95 degrees, 55 on average for the
        least of a triangle. Where the hole is narrower than the size, triangles are sharp.

    Raises
    ------
    InputError
        For a tube that is not thinner than the radius; without a size, for one that is very thin.
    """
    return of(cls, bodies.torus(center, radius, tube, size, axis), options)


@named(DomainOptions, resolve=False)
def cylinder(
    cls: type[Body],
    start: Any = (0.0, 0.0, 0.0),
    end: Any = (0.0, 0.0, 1.0),
    radius: float = 0.5,
    size: float | None = None,
    **options: Unpack[DomainOptions],
) -> Body:
    """A cylinder between two points, bounded by triangles with the vertices of its side on the true surface.

    Parameters
    ----------
    start, end : (3,) array_like
        The middles of "bottom" and "top"; the third marker is "side".
    radius : float
    size : float, optional
        The wanted edge length, a fifth of the radius by default, and not more than it.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.

    Returns
    -------
    Domain
        Triangles of the side are equilateral up to rounding of their numbers; those of bottom and top have
        angles between 39 and 93 degrees.

    Raises
    ------
    InputError
        If start and end are equal; without a size, if it is very thin.
    """
    return of(cls, bodies.cylinder(start, end, radius, size), options)


@named(DomainOptions, resolve=False)
def extruded(
    cls: type[Body],
    planar: Any,
    height: Any = 1.0,
    *,
    size: Any = None,
    layers: int | None = None,
    ends: Any = None,
    **options: Unpack[DomainOptions],
) -> Body:
    """What a planar domain sweeps over as it moves along a vector.

    Parameters
    ----------
    planar : Domain
        In the plane z = 0. Its holes become holes, inner pieces inner facets, loose points inner segments,
        and regions regions.
    height : float or (3,) array_like
        How far it moves along z, or the vector.
    size : optional
        The wanted edge length of pieces, as for `sampled`; without it only curves are cut.
    layers : int, optional
        How many quadrilaterals the walls are high; without it as many as a size asks for, or one.
    ends : (str, str), optional
        The names of the lower and the upper end: "bottom" and "top", or "bottom end" and "top end" if the
        planar domain has one of these names for something else.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`. Facets are the walls, piece by piece from below, then the ends.

    Returns
    -------
    Domain
        Markers of planar pieces name their walls. Ends are polygons with holes, cut along inner pieces; where
        these end inside, or at loose points, they are cut further, so that each such point is a corner.

    Raises
    ------
    InputError
        For a height of zero.

    Notes
    -----
    O(k log k) for k points, before the checks of `Domain`.
    """
    return of(cls, swept.extruded(_planar(planar, "extruded"), height, size, layers, ends), options)


@named(DomainOptions, resolve=False)
def revolved(
    cls: type[Body],
    planar: Any,
    angle: float = 360.0,
    *,
    size: Any = None,
    count: int | None = None,
    ends: Any = None,
    **options: Unpack[DomainOptions],
) -> Body:
    """What a planar domain sweeps over as it turns about the y axis of its plane, which becomes the z axis.

    Parameters
    ----------
    planar : Domain
        x is the distance from the axis, so nowhere negative, and y becomes z. Pieces on the axis vanish
        with the points that no other piece has; others become walls, inner pieces inner facets (on the axis
        inner segments), and loose points inner segments (on the axis loose points).
    angle : float
        In degrees, from the half plane of positive x towards y; more than 0, at most 360.
    size : optional
        The wanted edge length of pieces, and at the largest distance from the axis.
    count : int, optional
        The number of steps around the axis; without it as many as a size asks for, or 32 a full turn.
    ends : (str, str), optional
        The names of the two ends if it is no full turn: "start" and "end", or "start end" and "end end".
    inner, curves, markers, regions, resolve : optional
        As for `Domain`.

    Returns
    -------
    Domain
        All points lie on their true circles; walls are trapezoids, which are flat up to rounding, and those
        of pieces at right angles to the axis are one disc, annulus, or part of one. Markers of
        planar pieces name their walls; regions are carried over.

    Raises
    ------
    InputError
        If the domain crosses the axis, with the place.
    """
    return of(cls, swept.revolved(_planar(planar, "revolved"), angle, size, count, ends), options)


@named(DomainOptions, resolve=False)
def surface(
    cls: type[Body], mesh: Any, *, merge: float | None = None, **options: Unpack[DomainOptions]
) -> Body:
    """The body that a mesh of triangles, quadrilaterals or polygons in space encloses.

    Parameters
    ----------
    mesh : Mesh
        Its cells are the facets, in their order. Points that no cell has are left out.
    merge : float, optional
        Points that are not farther apart become one; facets that lose their area are dropped.
    inner, curves, markers, regions, resolve : optional
        As for `Domain`; numbers of points are those of the mesh without the points that are left out.

    Returns
    -------
    Domain
        ``origin`` has the numbers of the points in the mesh. Markers of cells become markers: those that are
        true or false by their names, whole numbers other than 0 as "name 3", and regions by their names.

    Raises
    ------
    InputError
        If the mesh is not a surface in space; `DomainError` if it encloses nothing.
    """
    found = welding.welded(surfaces.parts_of(mesh), welding.merging(merge))
    return surfaces.account(of(cls, found.parts, options), found)


def _planar(domain: Any, what: str) -> Any:
    surfaces.must_be_a_plane(domain, what)
    return domain
