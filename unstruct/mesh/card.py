"""The picture of a mesh in a notebook: counts and a small inline SVG, without matplotlib."""

from __future__ import annotations

import numpy as np

from ..base.card import card, to_pixels
from .cells import CELL_TYPES
from .complex import CellComplex

__all__ = ["html"]

MOST_CELLS = 400  # the largest number of cells that are drawn


def html(mesh: CellComplex) -> str:
    """An HTML card: a picture of at most a few hundred cells, and the counts."""
    rows = [("points", len(mesh.points)), *((name, len(block)) for name, block in mesh.cells.items())]
    rows += [("edges", len(mesh.edges)), ("dimensions", mesh.points.shape[1])]
    if len(mesh.duplicates):
        rows.append(("duplicates", len(mesh.duplicates)))
    segments, shown = _segments(mesh)
    label = f"Mesh of {mesh.size} cells" + ("" if shown == mesh.size else f", {shown} of them drawn")
    lines = " ".join(f"M{a:g} {b:g}L{c:g} {d:g}" for (a, b), (c, d) in segments.tolist())
    return card(label, f"<path d='{lines}' stroke='#333333' stroke-width='0.7' fill='none'/>", rows)


def _segments(mesh: CellComplex) -> tuple[np.ndarray, int]:
    """Edges to draw, in pixels, and the number of cells that they belong to.

    If there are too many cells, only some of them are drawn, at even steps of their numbers, and for cells of
    dimension two also some edges of the boundary.
    """
    number = np.arange(mesh.size)
    pairs: set[tuple[int, int]] = set()
    if len(number) > MOST_CELLS:
        number = np.linspace(0, len(number) - 1, MOST_CELLS).astype(int)
        if mesh.dimension == 2:  # the outline shows the region to which the scattered cells belong
            outline = mesh.boundary[:: 1 + len(mesh.boundary) // (2 * MOST_CELLS)]
            pairs |= {(min(a, b), max(a, b)) for a, b in outline.tolist()}
    start = 0
    for name, block in mesh.cells.items():
        for i in number[(start <= number) & (number < start + len(block))]:
            pairs |= {(min(a, b), max(a, b)) for a, b in _edges_of(name, block[i - start].tolist())}
        start += len(block)
    ends = _project(mesh.points)[np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)]
    if len(ends) == 0:
        return np.empty((0, 2, 2)), 0
    return np.round(to_pixels(ends), 1), len(number)


def _edges_of(name: str, row: list[int]) -> list[tuple[int, int]]:
    if name in CELL_TYPES:
        return [(row[i], row[j]) for i, j in CELL_TYPES[name][2]]
    if name == "polygon":
        return list(zip(row, [*row[1:], row[0]]))
    return [(a, b) for i, a in enumerate(row) for b in row[i + 1 :]]


def _project(points: np.ndarray) -> np.ndarray:
    """Points of any dimension in the plane: space in an oblique view, without any further axes.

    They are first scaled so that nothing overflows.
    """
    largest = np.abs(points).max(initial=0.0)
    points = points / largest if largest > 0 else points
    if points.shape[1] == 1:
        return np.column_stack([points[:, 0], np.zeros(len(points))])
    if points.shape[1] == 2:
        return points
    x, y, z = points[:, :3].T
    return np.column_stack([0.866 * (x - y), z + 0.35 * (x + y)])
