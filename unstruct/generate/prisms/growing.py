"""Numbers for the vertices of layers, and the layers as `beyond` takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cells import cells_of
from .creases import Fans
from .fans import NO_PYRAMIDS, SOLID_KINDS, cap_of, fan_cells, on_cap
from .records import Walls
from .remainder import Grown, padded_to_four
from .split import tetrahedra

__all__ = ["grown_layers", "in_tetrahedra", "numbers_of_levels"]


def numbers_of_levels(
    base: NDArray[np.integer], level: NDArray[np.integer], most: int, many: int
) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.int64]]:
    """The vertex of each ray at each level.

    Parameters
    ----------
    base : (r,) int
        The vertex of the wall from which each ray starts, one of ``many``.
    level : (r,) int
        How many layers each ray has; above, it keeps its last vertex.
    most : int
        The number of layers.
    many : int

    Returns
    -------
    number : (most + 1, r) int32
        Level by level, after the vertices of the wall.
    ray, step : (n,) int64
        For each vertex its ray and its level; vertices of the wall have level 0, and ray -1 without a ray.
    """
    rays = len(base)
    ray, step = [np.full(many, -1, dtype=np.int64)], [np.zeros(many, dtype=np.int64)]
    ray[0][base[::-1]] = np.arange(rays)[::-1]
    number = np.empty((most + 1, rays), dtype=np.int32)
    number[0] = base
    count = many
    for k in range(1, most + 1):
        rises = np.flatnonzero(level >= k)
        number[k] = number[k - 1]
        number[k, rises] = count + np.arange(len(rises))
        count += len(rises)
        ray.append(rises)
        step.append(np.full(len(rises), k))
    return number, np.concatenate(ray), np.concatenate(step)


def grown_layers(
    walls: Walls,
    base: NDArray[np.integer],
    level: NDArray[np.integer],
    places: NDArray[np.float64],
    columns: NDArray[np.integer],
    fans: Fans | None = None,
    how: str = "whole",
    apexes: NDArray[np.float64] | None = None,
) -> Grown:
    """Layers of wedges, pyramids and tetrahedra.

    Parameters
    ----------
    walls : Walls
    base, level : (r,) int
        Of each ray: the vertex of the wall, and how many layers there are.
    places : (levels + 1, r, 3) float64
    columns : (t, 3) int
        Rows of rays over the triangles of the walls, in their order.
    fans : Fans, optional
        What stands beside these columns over creases. For these, columns follow whose ``base`` is no
        triangle.
    how : "whole", "halves" or "pyramids"
        The form of the cap there; see `cap_of`.
    apexes : (q, 3) float64, optional
        Of the pyramids.
    """
    number, ray, step = numbers_of_levels(base, level, len(places) - 1, len(walls.points))
    points = np.concatenate([walls.points, places[step, ray][len(walls.points) :]])
    found = cells_of(columns.astype(np.int32), number)
    stem = walls.vertex[np.concatenate([np.arange(len(walls.points)), base[ray[len(walls.points) :]]])]
    grown = Grown(
        points,
        found.kinds,
        found.column,
        found.layer.astype(np.int64),
        stem.astype(np.int64),
        step,
        walls.triangles.astype(np.int64),
        walls.piece.astype(np.int64),
        number[-1][columns].astype(np.int64),
    )
    if fans is None or not len(fans.quads):
        return grown
    return _with_fans(grown, fans, number, how, apexes if how == "pyramids" else None)


def _with_fans(
    grown: Grown, fans: Fans, number: NDArray[np.int32], how: str, apexes: NDArray[np.float64] | None
) -> Grown:
    """Layers with the cells of fans, and the apexes of pyramids, which come last among the points."""
    apex = NO_PYRAMIDS if apexes is None else len(grown.points) + np.arange(len(apexes))
    found, many = fan_cells(fans, number, how, apex), len(grown.cap)
    both = (grown.cells, grown.column, grown.layer), (found.kinds, many + found.cap, found.layer)
    parts: dict[str, list[tuple[NDArray, NDArray, NDArray]]] = {kind: [] for kind in SOLID_KINDS}
    for cells, column, layer in both:
        start = 0
        for kind, rows in cells.items():
            stop = start + len(rows)
            parts[kind].append((rows, column[start:stop], layer[start:stop]))
            start = stop
    joined = {
        kind: [np.concatenate(column) for column in zip(*blocks, strict=True)]
        for kind, blocks in parts.items()
        if blocks
    }
    column, layer = (np.concatenate([block[k] for block in joined.values()]) for k in (1, 2))
    cap = cap_of(fans, how, number[-1], apex)
    own = padded_to_four(grown.cap) if cap.shape[1] == 4 else grown.cap
    first = fans.base[fans.quads[: len(apex), 0]]
    below = cap_of(fans, how, fans.base, first)[:, :3]
    return Grown(
        grown.points if apexes is None else np.concatenate([grown.points, apexes]),
        {kind: block[0].astype(np.int32) for kind, block in joined.items()},
        column,
        layer,
        np.concatenate([grown.stem, grown.stem[first]]),
        np.concatenate([grown.level, np.full(len(apex), len(number))]),
        np.concatenate([grown.base, below]),
        np.concatenate([grown.piece, grown.piece[on_cap(fans, how, fans.owner)]]),
        np.concatenate([own, cap]),
    )


def in_tetrahedra(grown: Grown) -> Grown:
    """The same layers with all cells cut into tetrahedra, which are positive unless columns are `twisted`."""
    rows, owner = tetrahedra(grown.cells)
    return grown._replace(cells={"tetra": rows}, column=grown.column[owner], layer=grown.layer[owner])
