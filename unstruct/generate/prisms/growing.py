"""Numbers for the vertices of layers, and the layers as `beyond` takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cells import cells_of
from .creases import Fans
from .fans import SOLID_KINDS, centers_of, fan_cells
from .records import Walls
from .remainder import Grown
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
        What stands beside these columns over creases. On top of them columns follow whose ``base`` is no
        triangle.
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
    return grown if fans is None or not len(fans.quads) else _with_fans(grown, fans, number)


def _with_fans(grown: Grown, fans: Fans, number: NDArray[np.int32]) -> Grown:
    """Layers with the cells of fans, whose top cells are divided from points inside, which come last."""
    found, many = fan_cells(fans, number, len(grown.points)), len(grown.cap)
    caps, owner = fans.caps, fans.cap_owner
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
    middle = centers_of(grown.points, found.centers)
    first = found.centers[:, 0]
    return Grown(
        np.concatenate([grown.points, middle]),
        {kind: block[0].astype(np.int32) for kind, block in joined.items()},
        column,
        layer,
        np.concatenate([grown.stem, grown.stem[first]]),
        np.concatenate([grown.level, np.full(len(middle), len(number) - 1)]),
        np.concatenate([grown.base, fans.base[caps]]),
        np.concatenate([grown.piece, grown.piece[owner]]),
        np.concatenate([grown.cap, number[-1][caps].astype(np.int64)]),
    )


def in_tetrahedra(grown: Grown) -> Grown:
    """The same layers with all cells cut into tetrahedra, which are positive unless columns are `twisted`."""
    rows, owner = tetrahedra(grown.cells)
    return grown._replace(cells={"tetra": rows}, column=grown.column[owner], layer=grown.layer[owner])
