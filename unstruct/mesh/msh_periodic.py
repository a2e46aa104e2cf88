"""Sides that match in Gmsh's format ``.msh``: its section $Periodic, in versions 2.2 and 4.1.

A link says that one entity of the model is the image of another, by which affine map (slave of master), and
which nodes belong together. So the elements on each side of each motion become entities of their own.
Source: the Gmsh reference manual, chapter "File formats".
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..base.errors import InputError
from ..geometry.motion import Motion
from .exchange import Exchange
from .grouping import group_rows
from .msh_parts import MSH_DIMENSIONS, MshSource
from .periodic import Periodic, facet_images

__all__ = ["Link", "links_of", "periodic_of", "read_links", "read_old_links"]


class Link(NamedTuple):
    """One entity and its image, both of one dimension.

    Attributes
    ----------
    dimension, first, second : int
        The second entity is the image.
    affine : ndarray, shape (16,), or None
    pairs : ndarray of int, shape (k, 2)
        Nodes of the first, and their images.
    """

    dimension: int
    first: int
    second: int
    affine: np.ndarray | None
    pairs: np.ndarray


def links_of(
    other: Exchange, dimension: int, entities: list[np.ndarray], tags: list[np.ndarray]
) -> list[Link]:
    """Give the sides of each motion entities of their own, and say which match.

    Parameters
    ----------
    other : Exchange
    dimension : int
        That of the cells.
    entities : list of ndarray of int
        The entity of each element of each block; those of the sides are changed.
    tags : list of ndarray of int
        Their physical groups: an entity belongs to one.

    Returns
    -------
    list of Link
        One for each motion and pair of physical groups. Pairs of vertices that are on no side, or on a side
        that matches several others, are in links of entities without elements.
    """
    links: list[Link] = []
    fresh = max([int(column.max(initial=0)) for column in (*entities, *tags)], default=0) + 2
    fresh = max([fresh, *(int(tag) + 1 for tag, _ in other.field_data.values())])
    sides = [i for i, block in enumerate(other.cells) if MSH_DIMENSIONS.get(block.type, 3) == dimension - 1]
    taken = [np.zeros(len(block.data), dtype=bool) for block in other.cells]
    for motion, pairs in other.periodic:
        affine = None if motion is None else motion.affine().ravel()
        image = np.full(len(other.points), -1, dtype=np.int64)
        image[pairs[:, 0]] = pairs[:, 1]
        left = image >= 0
        for one, two in _elements_that_match(other, sides, tags, pairs, taken):
            for (block, rows), entity in [(part, fresh) for part in one] + [
                (part, fresh + 1) for part in two
            ]:
                entities[block][rows], taken[block][rows] = entity, True
            nodes = np.unique(np.concatenate([other.cells[block].data[rows].ravel() for block, rows in one]))
            left[nodes] = False
            links.append(
                Link(dimension - 1, fresh, fresh + 1, affine, np.column_stack([nodes, image[nodes]]))
            )
            fresh += 2
        if left.any():
            nodes = np.flatnonzero(left)
            links.append(
                Link(dimension - 1, fresh, fresh + 1, affine, np.column_stack([nodes, image[nodes]]))
            )
            fresh += 2
    return links


Elements = list[tuple[int, np.ndarray]]  # of blocks: (number of a block, some of its rows)


def _elements_that_match(
    other: Exchange, sides: list[int], tags: list[np.ndarray], pairs: np.ndarray, taken: list[np.ndarray]
) -> Iterator[tuple[Elements, Elements]]:
    """Elements of one physical group, and their images in one group, that no motion has taken before."""
    for width in sorted({other.cells[i].data.shape[1] for i in sides}):
        blocks = [i for i in sides if other.cells[i].data.shape[1] == width]
        rows = np.concatenate([other.cells[i].data for i in blocks]).astype(np.int32)
        block = np.repeat(blocks, [len(other.cells[i].data) for i in blocks])
        row = np.concatenate([np.arange(len(other.cells[i].data)) for i in blocks])
        one, two = facet_images(pairs, rows, len(other.points))
        used, tag = (np.concatenate([columns[i] for i in blocks]) for columns in (taken, tags))
        free = ~(used[one] | used[two] | np.isin(one, two) | np.isin(two, one))
        one, two = one[free], two[free]
        kind, heads = group_rows(np.column_stack([tag[one], tag[two]]))
        for k in range(len(heads)):
            first, second = (
                [(int(i), row[f[block[f] == i]]) for i in np.unique(block[f])]
                for f in (one[kind == k], two[kind == k])
            )
            yield first, second


# ---------------------------------------------------------------------- reading


def read_links(source: MshSource) -> list[Link]:
    """The links of version 4.1."""
    found = []
    for _ in range(int(source.sizes(1)[0])):
        dimension, second, first = source.ints(3).tolist()
        values = source.reals(int(source.sizes(1)[0]))
        rows = source.sizes(2 * int(source.sizes(1)[0])).reshape(-1, 2)
        found.append(Link(dimension, first, second, values if len(values) == 16 else None, rows[:, ::-1]))
    return found


def read_old_links(path: Path, data: bytes) -> list[Link]:
    """The links of version 2, which are text in binary files, too."""
    lines = iter(data.decode("latin-1").split("\n"))

    def words() -> list[str]:
        for line in lines:
            if line.strip():
                return line.split()
        raise InputError(f"{path.name}, section $Periodic: it ends too early")

    found = []
    try:
        for _ in range(int(words()[0])):
            dimension, second, first = map(int, words())
            row, affine = words(), None
            if row[0] == "Affine":
                affine, row = np.array(row[1:], dtype=np.float64), words()
            rows = np.array([words() for _ in range(int(row[0]))], dtype=np.int64).reshape(-1, 2)
            whole = affine is not None and len(affine) == 16
            found.append(Link(dimension, first, second, affine if whole else None, rows[:, ::-1]))
    except ValueError as error:
        raise InputError(f"{path.name}, section $Periodic: {error}") from None
    return found


def periodic_of(links: list[Link], d: int) -> tuple[Periodic, ...]:
    """The pairs by motions in d dimensions: links of one map together, no vertex with itself."""
    found: dict[Any, list[np.ndarray]] = {}
    for link in links:
        motion = None if link.affine is None else Motion.of_affine(link.affine, d)
        rows = link.pairs[link.pairs[:, 0] != link.pairs[:, 1]]
        key: Any = motion
        if motion is None:  # without maps, only links of one entity can contradict each other
            key = (link.dimension, link.first, link.second)
        if len(rows):
            found.setdefault(key, []).append(rows)
    result = []
    for key, parts in found.items():
        rows = np.unique(np.concatenate(parts), axis=0)
        rows = rows[np.diff(rows[:, 0], prepend=-1) > 0]
        result.append(Periodic(key if isinstance(key, Motion) else None, rows.astype(np.int32)))
    return tuple(result)
