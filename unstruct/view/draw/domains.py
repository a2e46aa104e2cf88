"""Pictures of domains: pieces and their numbers, names, regions, and the faults that an error names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from ...base.errors import DomainError, InputError
from ...geometry.outline import Outline
from ...geometry.parity import left_parity
from . import frames as fr
from .bodies import body_parts
from .colors import role
from .items import item3
from .painting import picture
from .strips import draw_items, fit, flat_axes, marks

__all__ = ["plot_domain"]

CURVE_PARTS = 32  # straight parts in which a curve is drawn
FEW_NUMBERS = 40  # with more pieces or vertices than this, numbers would cover the picture
MOST_MARKS = 400  # with more vertices than this, only those that no piece uses are marked


def plot_domain(
    domain: Outline | DomainError,
    ax: Axes | None = None,
    *,
    numbers: bool | None = None,
    names: bool = True,
    vertices: bool | None = None,
    faults: Iterable[Any] = (),
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Axes:
    """Draw what bounds a region or a body: facets, inner pieces, loose vertices, names, seeds and faults.

    Parameters
    ----------
    domain : Domain, Outline or DomainError
        A `Domain` is filled where it is inside. Of an error, the outline that it refused is drawn, which has
        no inside, with the faults.
    ax : matplotlib axes, optional
        Where to draw; by default in a new figure.
    numbers : bool, optional
        Whether to write the numbers of vertices and pieces ("f3" is facet 3, "i0" inner segment 0), as error
        messages use them. By default where there are at most 40 of them.
    names : bool
        Whether to write the names of regions at their seeds, and of markers at their longest piece.
    vertices : bool, optional
        Whether to mark the vertices; by default where there are at most 400. Loose ones are always marked.
    faults : sequence of Fault
        Their pieces and vertices are emphasized, and each is marked and described at its place.
    azimuth, elevation : float, optional
        From where bodies in space are seen, in degrees; by default -55 and 22. `view3d` lets a reader turn
        them.

    Returns
    -------
    matplotlib.axes.Axes
    """
    if isinstance(domain, DomainError):
        return plot_domain(
            domain.outline,
            ax,
            numbers=numbers,
            names=names,
            vertices=vertices,
            faults=[*domain.faults, *faults],
            azimuth=azimuth,
            elevation=elevation,
        )
    given = {"azimuth": azimuth, "elevation": elevation}
    view: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if domain.points.shape[1] == 3:
        parts = body_parts(domain, numbers=numbers, names=names, vertices=vertices, faults=faults)
        return picture([item3(kind, look, *rest, **more) for kind, look, *rest, more in parts], ax, **view)
    if view:
        raise InputError(f"{' and '.join(view)} are options of bodies in space; this domain is planar")
    points, count = domain.points, len(domain.pieces)
    lines = _lines(domain)
    ax = flat_axes(ax)
    fit(ax, np.vstack([points[np.isfinite(points).all(axis=1)], *lines]), 0.08)
    if hasattr(domain, "sampled") and len(domain.facets):
        _fill(ax, domain, lines)
    facets = len(domain.facets)
    items = [
        fr.segments("muted" if facets and count > 10_000 else "constrained", _parts(lines[:facets])),
        fr.segments("front", _parts(lines[facets:])),
    ]
    few = len(points) <= FEW_NUMBERS and count <= FEW_NUMBERS if numbers is None else numbers
    texts = _numbers(domain) if few else {}
    if names:
        items += _seeds(domain)
        for name, piece in _marked(domain, lines).items():
            texts[piece] = f"{texts[piece]}: {name}" if piece in texts else name
    if few:
        items.append(fr.labels("vertex", points, range(len(points))))
    texts = {piece: text for piece, text in texts.items() if len(lines[piece])}
    middles = [_middle(lines[piece]) for piece in texts]
    items.append(fr.labels("inserted", _rows(middles), texts.values()))
    draw_items(ax, items)
    used = np.isin(np.arange(len(points)), domain.pieces)
    if vertices or (vertices is None and len(points) <= MOST_MARKS):
        marks(ax, points[used], "vertex", z=20, scale=0.7)
    if not used.all():
        marks(ax, points[~used], "accepted", z=21)
    _mark_faults(ax, domain, lines, faults)
    return ax


def _rows(values: Any) -> np.ndarray:
    return np.asarray(values, dtype=float).reshape(-1, 2)


def _lines(domain: Outline) -> list[np.ndarray]:
    """Each piece as a line of points, from its first vertex to its second."""
    n = len(domain.points)
    lines = [domain.points[[a, b] if 0 <= a < n and 0 <= b < n else []] for a, b in domain.pieces.tolist()]
    t = np.linspace(0, 1, CURVE_PARTS + 1)
    for piece in domain.curves:
        if len(lines[piece]):
            lines[piece] = domain.points_at(np.full(len(t), piece), t)
    return lines


def _parts(lines: list[np.ndarray]) -> np.ndarray:
    """All lines cut into segments, (s, 2, 2)."""
    cut = [np.stack([line[:-1], line[1:]], axis=1) for line in lines if len(line)]
    return np.concatenate(cut) if cut else np.empty((0, 2, 2))


def _fill(ax: Axes, domain: Any, lines: list[np.ndarray]) -> None:
    """Color the inside: facets are turned so that it lies on their left, and joined into closed lines."""
    chords = domain.sampled()
    rows = np.nonzero(chords.piece < len(domain.facets))[0]
    left = left_parity(chords.points, chords.ends[rows])
    turned = np.zeros(len(domain.facets), dtype=bool)
    turned[chords.piece[rows]] = ~left
    leaving: dict[int, list[int]] = {}
    start = np.where(turned, domain.facets[:, 1], domain.facets[:, 0])
    end = np.where(turned, domain.facets[:, 0], domain.facets[:, 1])
    for piece, vertex in enumerate(start.tolist()):
        leaving.setdefault(vertex, []).append(piece)
    corners: list[np.ndarray] = []
    codes: list[np.ndarray] = []
    for vertex in list(leaving):
        while leaving[vertex]:
            ring, here = [], vertex
            while leaving[here]:  # as many facets end at a vertex as leave it, so the line returns
                piece = leaving[here].pop()
                ring.append(lines[piece][::-1][:-1] if turned[piece] else lines[piece][:-1])
                here = int(end[piece])
            corners.append(np.vstack([*ring, ring[0][:1]]))
            code = np.full(len(corners[-1]), Path.LINETO, dtype=np.uint8)
            code[0], code[-1] = Path.MOVETO, Path.CLOSEPOLY
            codes.append(code)
    look = role("cell")
    path = Path(np.vstack(corners), np.concatenate(codes))
    ax.add_patch(PathPatch(path, facecolor=look.fill, edgecolor="none", zorder=1))


def _middle(line: np.ndarray) -> np.ndarray:
    """A place on the piece for a label; off the middle of straight ones, where diagonals would meet."""
    return line[len(line) // 2] if len(line) > 2 else 0.6 * line[0] + 0.4 * line[1]


def _numbers(domain: Outline) -> dict[int, str]:
    """For each piece its letter and number: "f3" is facet 3, "i0" inner segment 0."""
    facets = len(domain.facets)
    return {k: f"f{k}" if k < facets else f"i{k - facets}" for k in range(len(domain.pieces))}


def _seeds(domain: Outline) -> list[fr.Item]:
    """The seeds of the regions, with their names."""
    seeds, names = [], []
    for name, places in domain.regions.items():
        seeds += [tuple(place) for place in _rows(places)]
        names += [name] * len(_rows(places))
    return [fr.dots("voronoi", _rows(seeds)), fr.labels("voronoi", _rows(seeds), names)]


def _marked(domain: Outline, lines: list[np.ndarray]) -> dict[str, int]:
    """For each marker the longest of its pieces."""
    longest = {}
    for name, pieces in domain.markers.items():
        lengths = [np.linalg.norm(np.diff(lines[k], axis=0), axis=1).sum() for k in pieces]
        if lengths:
            longest[name] = int(pieces[int(np.argmax(lengths))])
    return longest


def _mark_faults(ax: Axes, domain: Outline, lines: list[np.ndarray], faults: Iterable[Any]) -> None:
    items = []
    for fault in faults:
        pieces = [lines[k] for k in fault.pieces if 0 <= k < len(lines)]
        items.append(fr.segments("bad", _parts(pieces)))
        items.append(fr.dots("bad", [p for p in domain.points[list(fault.vertices)] if np.isfinite(p).all()]))
        if np.isfinite(fault.place).all():
            items += [fr.dots("bad", [fault.place]), fr.labels("bad", [fault.place], [fault.kind])]
    draw_items(ax, items)
