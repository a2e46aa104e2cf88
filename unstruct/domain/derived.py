"""What follows from a domain: pictures of it, and domains of fewer vertices or of subsegments."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..base.arguments import as_mapping, finite
from ..base.arrays import counted_off
from ..base.doors import door
from ..base.errors import InputError
from ..base.files import as_path, suffix_of
from ..geometry.motion import Motion
from .arguments import composed
from .plane import poly
from .plane.account import Repair
from .plane.matching import matching, pieces_of
from .plane.prescribed import Match, Spacing, parameters
from .sides import SIDES
from .space.formats.writing import BODY_FORMATS, write_body
from .space.inside import turned_facets

__all__ = [
    "followed",
    "held_by",
    "matched",
    "must_be_free",
    "must_be_planar",
    "must_be_spatial",
    "plot",
    "simplified",
    "spaced",
    "turned",
    "write",
]

D = TypeVar("D")  # `Domain`, or a class that is derived from it

_plot = door("unstruct.view:plot_domain")
SAME_SPACING = 1e-9  # parameters of matched pieces that differ by less are equal


def simplified(domain: D, tolerance: float | None = None, *, size: Any = None) -> D:
    """The domain with fewer vertices on its straight pieces, in space with fewer facets, and an account.

    Parameters
    ----------
    tolerance : float, optional
        How far old and new pieces may be from each other (Hausdorff distance). As many vertices as
        possible are dropped, those with the least deviation first. In space: how far facets may be from the
        plane of the largest one with which they are joined; by default up to rounding, 16 times 2^-53 of the
        largest coordinate.
    size : number, function (k, 2) -> (k,), or size field, optional
        The wanted edge length: only vertices at pieces shorter than 3/4 of it are dropped. Without a
        tolerance they may be half of it away from the new pieces.

    Returns
    -------
    Domain
        Nothing crosses, and rings keep their nesting; loose vertices and seeds stay on their side, by
        exact signs. Curves, and vertices where pieces branch or change their names, stay. Only rings
        smaller than the tolerance are dropped, unless they enclose anything that stays or are the last
        of a name. `repairs` lists all that was dropped; `origin` and `piece_origin` refer to the input
        of this domain, and a new piece to the first of those that it replaces.

        In space: facets with the same names that lie in a plane and hang together over edges, as the
        triangles of a flat side in a file, are one polygon, and vertices go that are inside of it, or in the
        middle of a straight edge. So methods with a size divide sides anew, without the needles of the file.
        Where inner pieces end, and where a polygon would touch itself, facets stay.

    Raises
    ------
    InputError
        In the plane, without a tolerance or a size, and if the whole region is smaller than the tolerance;
        for a size in space.

    Notes
    -----
    A vertex is dropped if the closed triangle with its neighbors is empty (after M. Visvalingam, J. D.
    Whyatt, *Line generalisation by repeated elimination of points*, 1993). Book: 2.6d.
    """
    old: Any = domain
    must_be_free(old, "simplified")
    coarse = old.sampled() if old.dimension == 2 else old.triangulated
    found = SIDES[old.dimension].simplified(old, coarse, tolerance, size)
    make: Any = type(domain)
    return followed(old, make(**found.parts), found.origin, found.piece_origin, found.repairs)


def spaced(domain: D, spacing: Mapping[Any, Any]) -> D:
    """The planar domain with given points along some pieces: a number of edges, or a grading.

    Parameters
    ----------
    spacing : mapping
        Name of a marker or number of a piece -> a number of edges of equal length, or a `Spacing`. Each
        piece of a marker is spaced by itself, from its first vertex to its second.

    Returns
    -------
    Domain
        Every method puts exactly these points on the pieces, whatever size is asked for, and no others;
        triangles for which that is the reason to miss a limit say so. Only if chords would touch another
        piece is a curve cut further: ``mesh.piece`` tells how many edges each piece has.

    Raises
    ------
    InputError
        For unknown names, spacings that no number of edges fits, and different ones of pieces that match.
    """
    old: Any = domain
    must_be_planar(old, "spaced")
    found = dict(old.spacings)
    for key, value in as_mapping(spacing, "spacing").items():
        one = value if isinstance(value, Spacing) else Spacing(count=value)
        found |= {int(p): parameters(old, int(p), one) for p in pieces_of(old, key, "spacing")}
    return held_by(old, found, old.matches)


def matched(
    domain: D,
    first: Any,
    second: Any,
    *,
    shift: Any = None,
    rotation: float | None = None,
    center: Any = (0.0, 0.0),
    tolerance: float | None = None,
) -> D:
    """The planar domain with two sides that match, for periodic problems: one is the other, moved or turned.

    Parameters
    ----------
    first, second : str, int or list of int
        The names of markers, or pieces: the second ones are the first ones moved by a translation, or
        turned about a point.
    shift : (2,) array_like, optional
        The translation; found from the vertices by default.
    rotation : float, optional
        The angle in degrees, counterclockwise, by which the first pieces are turned: a sector of an annulus
        has 360 divided by the number of sectors.
    center : (2,) array_like, optional
        The point about which they are turned, the origin by default; the two sides may share it.
    tolerance : float, optional
        How far vertices and curves may be from where they match; 2^-36 of the extent by default.

    Returns
    -------
    Domain
        Vertices of the second pieces are moved to match exactly, with an account in `repairs`. Every
        method puts points on the second pieces that are those on the first plus the shift, rounded, bit
        for bit, and no others: both are cut by the finer size. So is it for rotations: all points on the
        second pieces are computed from those on the first by one function, ``match.motion`` of
        ``domain.matches``, which is exact for multiples of 90 degrees and otherwise rounds; calling it
        again gives the same bits. ``mesh.pairs`` has the pairs of vertices, ``mesh.periodic`` the motions,
        too. Triangles that miss a limit because these pieces are not split further say so.

    Raises
    ------
    InputError
        If the pieces do not match, with the place; or if one has an image already.
    """
    old: Any = domain
    must_be_planar(old, "matched")
    slack = None if tolerance is None else finite(tolerance, "tolerance")
    found = matching(old, first, second, _motion(shift, rotation, center), slack)
    new = old
    if len(found.moved):
        make: Any = type(domain)
        far = float(np.hypot(*(found.points - old.points)[found.moved].T).max())
        text = f"moved {len(found.moved)} vertices of {second!r} by up to {far:.3g} to match {first!r}"
        moved = tuple(found.moved.tolist())
        told = Repair("moved to match", text, tuple(found.points[moved[0]].tolist()), (), moved)
        made = make(
            found.points, old.facets, inner=old.inner, curves=old.curves, markers=old.markers,
            regions=old.regions,
        )  # fmt: skip
        every = counted_off(len(old.points)), counted_off(len(old.pieces))
        new = followed(old, made, *every, [told])
    return held_by(new, old.spacings, [*old.matches, *found.matches])


def _motion(shift: Any, rotation: float | None, center: Any) -> Motion | None:
    """The motion that was asked for; None if it is to be found."""
    for name, value in (("shift", shift), ("center", center)):
        if value is not None and not _is_vector(value):
            raise InputError(f"{name} must be two finite numbers, not {value!r:.60}")
    if rotation is None:
        return None if shift is None else Motion.translation(shift)
    if shift is not None:
        raise InputError(
            "give a shift or a rotation, not both: a motion of both is a rotation about some point"
        )
    angle = finite(rotation, "rotation")
    if angle % 360.0 == 0.0:
        raise InputError(f"rotation = {rotation} degrees moves nothing: give the angle between the sides")
    return Motion.rotation(angle, center)


def _is_vector(value: Any) -> bool:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return False
    return array.shape == (2,) and bool(np.isfinite(array).all())


def held_by(domain: Any, spacings: dict[int, np.ndarray], matches: list[Match]) -> Any:
    """The domain with these points along pieces and these matching sides, after a check that they fit."""
    for match in matches:
        one, two = (spacings.get(piece) for piece in match[:2])
        if one is not None and two is not None:
            two = 1.0 - two[::-1] if match.turned else two
            if len(one) != len(two) or np.abs(one - two).max() > SAME_SPACING:
                raise InputError(
                    f"{domain.name(match.first)} and {domain.name(match.second)} match, but have different "
                    "spacings: give one of them"
                )
    new = copy(domain)
    for name in ("_coarse", "area", "bounds"):  # they depend on the points
        new.__dict__.pop(name, None)
    new.spacings, new.matches = dict(spacings), list(matches)
    return new


def must_be_planar(domain: Any, what: str) -> None:
    """Raise if the domain is a body in space."""
    if domain.dimension != 2:
        raise InputError(f"a body in space cannot be {what}; this is for planar domains")


def must_be_spatial(domain: Any, what: str) -> None:
    """Raise if the domain is planar."""
    if domain.dimension != 3:
        raise InputError(f"a planar domain does not have {what}")


def must_be_free(domain: Any, what: str) -> None:
    """Raise if pieces have given points or images, which another domain would not have."""
    if domain.spacings or domain.matches:
        raise InputError(f"a domain with spacings or matching sides cannot be {what}: do that before")


def turned(domain: Any) -> np.ndarray:
    """The facets of a body in space whose normals point into it, by their numbers: (k,) int64.

    Nothing depends on the directions of facets; ``resolve=True`` turns all outward.
    """
    must_be_spatial(domain, "facets with two sides")
    return turned_facets(domain.triangulated)


def followed(domain: Any, new: Any, origin: Any, pieces: Any, repairs: Any = ()) -> Any:
    """A new domain made of parts of this one, with what this one knows about its input.

    Parameters
    ----------
    new : Domain
    origin, pieces : array_like of int
        The vertex and the piece of this domain that each vertex and piece of the new one comes from.
    repairs : sequence of Repair
        What was done.
    """
    new.origin, new.piece_origin = composed(domain.origin, origin), composed(domain.piece_origin, pieces)
    new.hole_seeds = domain.hole_seeds
    new.repairs, new.max_areas = [*domain.repairs, *repairs], dict(domain.max_areas)
    return new


def write(domain: Any, path: str | Path, *, binary: bool | None = None) -> None:
    """Write Triangle's ``.poly``; bodies in space as STL, OFF, PLY, OBJ, or TetGen's files.

    Parameters
    ----------
    path : str or Path
        Planar domains: .poly. Bodies: .stl, .off, .ply, .obj, .smesh, .poly.
    binary : bool, optional
        For .stl, then in single precision, and .ply; both are texts by default.

    Raises
    ------
    InputError
        For other suffixes and options, and if the file cannot be written; the old one is then still there.

    Notes
    -----
    In .poly, curves are written by their coarse chords, holes by seeds. Markers and regions are numbers in
    it, and in .smesh; a name that is not a number is replaced by a free number, and a comment at the head of
    the file says so. A piece has one marker there, and in .stl, the last that names it. Blanks in names are
    single in .stl, and become _ in .obj. Facets of bodies are written so that they point outward. Warnings
    list what a format does not store, and names that it changes.
    """
    target = as_path(path)
    if domain.dimension == 3:
        shell = SIDES[3].coarse(domain)
        write_body(domain, shell, domain.max_areas, domain.hole_seeds, target, binary)
        return
    if suffix_of(target) in BODY_FORMATS and suffix_of(target) != ".poly":
        raise InputError(
            f"a planar region is written as .poly, not as {target.suffix!r}: mesh it, or extrude it "
            "(Domain.extruded)"
        )
    if binary is not None:
        raise InputError("'binary' is for bodies in space; .poly is a text")
    poly.write_poly(domain, domain.sampled(), domain.max_areas, domain.hole_seeds, target)


def plot(
    domain: Any,
    ax: Any = None,
    *,
    numbers: bool | None = None,
    names: bool = True,
    vertices: bool | None = None,
    faults: Any = (),
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Any:
    """Draw with matplotlib what bounds the region or the body, with the names of markers and regions.

    Parameters
    ----------
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    numbers : bool, optional
        Whether to write the numbers of vertices and pieces, as error messages use them ("f3" is facet 3,
        "i0" inner segment 0). By default where there are at most 40 of them.
    names : bool
        Whether to write the names of regions at their seeds, and of markers at their longest piece.
    vertices : bool, optional
        Whether to mark the vertices; by default where there are at most 400. Loose ones are always
        marked.
    faults : sequence of Fault
        Are marked and described at their places; `DomainError.plot` marks those that it reports.
    azimuth, elevation : float, optional
        From where a body in space is seen, in degrees; by default -55 and 22. `view.view3d` lets a reader
        turn it.

    Returns
    -------
    matplotlib.axes.Axes
    """
    view = {"azimuth": azimuth, "elevation": elevation}
    return _plot(domain, ax, numbers=numbers, names=names, vertices=vertices, faults=faults, **view)
