"""matplotlib pictures of meshes: cells, circumcircles, Voronoi diagrams, cavities, qualities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from ...base.errors import DomainError, InputError
from ...base.options import named
from ...geometry.outline import Outline
from ...geometry.simplex import circumcenter, circumradius
from . import frames as fr
from .coloring import COLOR_MAP, Coloring, cell_coloring, legend, value_scale
from .colors import PAPER
from .domains import plot_domain
from .painting import picture
from .strips import draw_items, fit, flat_axes, marks

__all__ = ["dual_segments", "plot", "plot_cavity", "plot_circumcircles", "plot_voronoi"]

FEW = 250  # with more cells than this, lines become thinner, down to 0.3 of their width
CROWD = 400  # with more vertices than this, no markers are drawn, because they would hide the cells


class PlotOptions(TypedDict, total=False):
    """The options of `plot` for planar meshes."""

    role: str
    names: bool
    vertices: bool | None
    values: Any
    label: str


def plot(
    mesh: Any,
    ax: Axes | None = None,
    *,
    role: str = "cell",
    names: bool = False,
    vertices: bool | None = None,
    values: Any = None,
    label: str = "",
    azimuth: float | None = None,
    elevation: float | None = None,
    explode: float | None = None,
    section: Any = None,
    cut: str | None = None,
    together: Any = None,
) -> Axes:
    """Draw a mesh: planar cells of any number of corners, a surface, or the boundary of a solid; or a domain.

    Parameters
    ----------
    mesh : Mesh, Domain or DomainError
        A mesh in one, two or three dimensions. Large solids, and solids with cells other than tetrahedra, are
        shown by their boundary. A domain, or the error that refused one, is passed to `plot_domain`.
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    role : str
        The role whose style the cells have.
    names : bool
        Whether to write the number of each vertex beside it (planar meshes).
    vertices : bool, optional
        Whether to draw the vertices; by default only if there are at most 400.
    values : array (cells,) or (vertices,), or str, optional
        Color the cells by these values, with a color bar called ``label``; the faces of a solid by those of
        its cells, or by the mean at their corners. A string is a marker of cells, such as "region" (then
        colors and a legend with the names), or a quality, such as "min_dihedral".
    label : str
        Of the color bar; by default the name of the values.
    azimuth, elevation : float, optional
        From where solids, surfaces and bodies in space are seen, in degrees; by default -55 and 22.
    explode : float, optional
        How far cells are moved apart, relative to their distance from the middle; by default they are not.
    section : optional
        A plane that cuts solids and surfaces: an axis and an offset, such as ("x", 0.5) or ("-x", 0.5), or a
        point and a normal, two triples. What is on the side of the normal is removed.
    cut : str, optional
        "cells" (default): cells whose middle is beyond the plane are removed, the others are whole. "flat":
        cells are cut by the plane, and one sees their sections in it.
    together : str or array of int (cells,), optional
        What ``explode`` moves as one: cells with the same value of a marker, such as "region", or of the
        array. By default each cell on its own.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        For more than three dimensions, if ``values`` does not have one entry per cell or vertex, and for
        a plane that is none.
    """
    given: dict[str, Any] = {"azimuth": azimuth, "elevation": elevation, "explode": explode}
    given |= {"section": section, "cut": cut, "together": together}
    view: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if isinstance(mesh, Outline | DomainError):
        if role != "cell" or values is not None or label or {*view} - {"azimuth", "elevation"}:
            raise InputError(
                "role, values, label, explode, section, cut and together are options of meshes; "
                "see plot_domain"
            )
        return plot_domain(mesh, ax, numbers=names or None, vertices=vertices, **view)
    if not hasattr(mesh, "points") or not (hasattr(mesh, "cells") or hasattr(mesh, "simplices")):
        raise InputError(f"plot draws a Mesh or a Domain, not a {type(mesh).__name__}")
    points = np.asarray(mesh.points, dtype=float)
    if points.shape[1] == 3:
        return picture(mesh, ax, role=role, values=values, label=label, **view)
    if points.shape[1] > 3 or view:
        raise InputError(
            f"a mesh in {points.shape[1]} dimensions cannot be drawn with the options {sorted(view)}; "
            "plot a projection"
        )
    points = points if points.shape[1] == 2 else np.column_stack([points, np.zeros(len(points))])
    if names not in (True, False) or vertices not in (True, False, None):
        raise InputError("names and vertices are True or False")
    ax = flat_axes(ax)
    cells = planar_cells(mesh)
    wide = [c for c in cells if len(c) > 2]
    used = np.unique(np.concatenate([np.asarray(c) for c in cells])) if cells else np.arange(0)
    if values is not None:
        coloring = cell_coloring(mesh, values, label, count=len(wide))
        if coloring.by_vertex:
            means = np.array([coloring.values[c].mean() for c in wide])
            coloring = coloring._replace(values=means, by_vertex=False)
        _fill_cells(ax, [points[c] for c in wide], coloring)
    else:
        before = len(ax.collections)
        draw_items(ax, [fr.polygons(role, [points[c] for c in wide])])
        thin = min(1.0, max(0.3, (FEW / max(len(wide), 1)) ** 0.5))
        for drawn in ax.collections[before:]:
            drawn.set_linewidth((thin * np.ravel(drawn.get_linewidth())).tolist())
    draw_items(ax, [fr.segments("edge", [points[c] for c in cells if len(c) == 2])])
    if vertices or (vertices is None and len(used) <= CROWD):
        marks(ax, points[used], "vertex", z=5, scale=1.0 if len(used) <= 60 else 0.6)
    if names:
        draw_items(ax, [fr.labels("vertex", points[used], used)])
    fit(ax, points)
    return ax


def color_cells(ax: Axes, corners: Sequence[np.ndarray], values: Any, label: str) -> None:
    """Fill cells by value, with a color bar."""
    values = np.asarray(values, dtype=float)
    if values.shape != (len(corners),):
        raise InputError(f"values must have one entry per cell, shape ({len(corners)},), not {values.shape}")
    _fill_cells(ax, corners, Coloring(values, False, value_scale(values), {}, label))


def _fill_cells(ax: Axes, corners: Sequence[np.ndarray], coloring: Coloring) -> None:
    """Fill cells by one value each, with a color bar or a legend."""
    width = 0.5 if len(corners) < 2000 else 0.0
    collection = PolyCollection(corners, edgecolors=PAPER, linewidths=width, cmap=COLOR_MAP, zorder=2)
    if coloring.regions:
        collection.set_facecolor(coloring.colors(coloring.values))
    else:
        collection.set_array(coloring.values)
    ax.add_collection(collection)
    if coloring.regions:
        legend(ax, coloring)
    else:
        ax.figure.colorbar(collection, ax=ax, shrink=0.75, label=coloring.label, pad=0.02)


def planar_cells(mesh: Any) -> list[np.ndarray]:
    """All cells of a mesh, of any types, as rows of vertices."""
    types = getattr(mesh, "cells", None)
    blocks = list(types.values()) if isinstance(types, Mapping) and types else [mesh.simplices]
    return [np.asarray(row, dtype=int) for block in blocks for row in block if len(row) > 1]


def _planar(mesh: Any, what: str) -> tuple[np.ndarray, np.ndarray]:
    points, cells = np.asarray(mesh.points, dtype=float), np.asarray(mesh.simplices)
    if points.shape[1] != 2 or cells.shape[1] != 3:
        raise InputError(
            f"{what} can be drawn for triangles in the plane, not for cells with {cells.shape[1]} vertices "
            f"in {points.shape[1]} dimensions; see view3d"
        )
    return points, cells


@named(PlotOptions, role="cell", names=False, label="")
def plot_circumcircles(
    mesh: Any,
    cells: Any = None,
    ax: Axes | None = None,
    *,
    centers: bool = True,
    margin: float = 0.06,
    **options: Unpack[PlotOptions],
) -> Axes:
    """Draw a planar triangulation with the circumcircles of some cells, by default of all.

    Parameters
    ----------
    mesh : Mesh
    cells : array_like of int, optional
    ax : matplotlib axes, optional
    centers : bool
        Whether to mark the centers of the circles.
    margin : float
        What stays free around, as a share. The window contains the mesh and circles not much larger than it.
    role, names, vertices, values, label : optional
        As for `plot`.
    """
    points, triangles = _planar(mesh, "circumcircles")
    chosen = triangles if cells is None else triangles[np.atleast_1d(cells)]
    ax = plot(mesh, ax, **options)
    middle, radius = circumcenter(points[chosen]), circumradius(points[chosen])
    solid = np.isfinite(radius)
    items = [fr.circles("circumcircle", middle[solid], radius[solid])]
    shown = solid & (radius < 0.8 * np.linalg.norm(np.ptp(points, axis=0)))
    ends = [middle[shown] + radius[shown, None] * side for side in ([-1, -1], [1, 1])]
    fit(ax, np.vstack([points, *ends]), margin)
    draw_items(ax, [*items, fr.dots("circumcircle", middle[solid])] if centers else items)
    return ax


@named(PlotOptions, role="cell", names=False, label="")
def plot_cavity(
    mesh: Any,
    cells: Any,
    point: Any,
    ax: Axes | None = None,
    *,
    circles: bool = True,
    **options: Unpack[PlotOptions],
) -> Axes:
    """Draw the cavity of a point, which consists of ``cells`` of a planar mesh, with their circumcircles.

    Parameters
    ----------
    mesh : Mesh
    cells : array_like of int
    point : (2,) array_like
    ax : matplotlib axes, optional
    circles : bool
        Whether to draw the circumcircles.
    role, names, vertices, values, label : optional
        As for `plot`.
    """
    points, triangles = _planar(mesh, "cavities")
    chosen = triangles[np.atleast_1d(np.asarray(cells, dtype=int))]
    ax = plot(mesh, ax, **options)
    items = [fr.polygons("cavity", points[chosen])]
    if circles:
        items.append(fr.circles("circumcircle", circumcenter(points[chosen]), circumradius(points[chosen])))
    fit(ax, np.vstack([points, np.reshape(point, (1, 2))]), 0.1)
    draw_items(ax, [*items, fr.dots("inserted", point)])
    return ax


def plot_voronoi(
    diagram: Any,
    ax: Axes | None = None,
    *,
    delaunay: bool = False,
    sites: bool = True,
    vertices: bool = True,
    view: Sequence[float] | None = None,
) -> Axes:
    """Draw a planar Voronoi diagram, with its rays clipped to the window.

    Parameters
    ----------
    diagram : Voronoi or Mesh
        For a mesh, its dual is drawn, which joins the circumcenters of neighbors. It is the Voronoi diagram
        if the mesh is Delaunay.
    delaunay : bool
        Whether to join the sites with a common ridge (or draw the edges of the mesh) underneath.
    sites, vertices : bool
        Whether to mark the sites and the Voronoi vertices.
    view : (xmin, xmax, ymin, ymax), optional
        The window; by default the sites with a margin.
    """
    points = np.asarray(diagram.points, dtype=float)
    if points.shape[1] != 2:
        raise InputError(
            f"only a planar Voronoi diagram can be drawn, not one in {points.shape[1]} dimensions"
        )
    ax = flat_axes(ax)
    fit(ax, points, 0.25)
    if view is not None:
        ax.set(xlim=view[:2], ylim=view[2:])
    lines, nodes, pairs = dual_segments(diagram, reach=4 * _diagonal(ax, points))
    items = [fr.segments("edge", points[pairs])] if delaunay else []
    items += [fr.segments("voronoi", lines)]
    items += [fr.dots("voronoi", nodes)] if vertices else []
    items += [fr.dots("vertex", points)] if sites else []
    draw_items(ax, items)
    return ax


def _diagonal(ax: Axes, points: np.ndarray) -> float:
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    return float(np.hypot(x1 - x0, y1 - y0) + np.ptp(points, axis=0).max())


def dual_segments(diagram: Any, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The ridges as segments ``(r, 2, 2)``, with rays cut beyond ``reach``; the vertices; pairs of sites."""
    points = np.asarray(diagram.points, dtype=float)
    if hasattr(diagram, "ridge_points"):
        nodes = np.asarray(diagram.vertices, dtype=float).reshape(-1, 2)
        pairs, ends = np.asarray(diagram.ridge_points), np.asarray([list(r) for r in diagram.ridge_vertices])
    else:
        nodes, pairs, ends = _dual_of_mesh(diagram)
    middle = points[np.unique(pairs)].mean(axis=0) if len(pairs) else np.zeros(2)
    lines = np.zeros((len(pairs), 2, 2))
    for k, ((p, q), (a, b)) in enumerate(zip(pairs, ends)):
        if a >= 0 and b >= 0:
            lines[k] = nodes[a], nodes[b]
            continue
        along = points[q] - points[p]
        out = np.array([along[1], -along[0]]) / np.hypot(*along)
        center = (points[p] + points[q]) / 2
        if getattr(diagram, "weights", None) is not None:
            center = center + along * (diagram.weights[p] - diagram.weights[q]) / (2 * np.dot(along, along))
        if np.dot(out, center - middle) < 0:  # a ray points away from the sites
            out = -out
        # If the sites are collinear, a ridge is a whole line.
        start = nodes[max(a, b)] if max(a, b) >= 0 else center - reach * out
        lines[k] = start, center + out * max(reach, 2 * abs(np.dot(start - center, out)))
    return lines, nodes, pairs


def _dual_of_mesh(mesh: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Circumcenters, edges, and the two cells at each edge, where −1 stands for the outside of the hull."""
    points, cells = _planar(mesh, "duals")
    neighbors = np.asarray(mesh.neighbors)
    pairs, ends = [], []
    for t, corners in enumerate(cells):
        for k in range(3):
            other = int(neighbors[t, k])
            if other < t:  # so that each edge is listed once
                pairs.append([corners[(k + 1) % 3], corners[(k + 2) % 3]])
                ends.append([t, other])
    return (
        circumcenter(points[cells]),
        np.array(pairs, dtype=int).reshape(-1, 2),
        np.array(ends).reshape(-1, 2),
    )
