"""Which region each cell belongs to, where some cells are cubes within a strip of tetrahedra.

No piece of the domain passes between cubes that share a face. So cubes that hang together, and all parts of
the strip that they touch, are one part of the body. See the book, chapter 4c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...mesh import topology
from ...mesh.grouping import group_rows
from ...mesh.mesh import Mesh
from ..tree.cells import TreeCells
from .choosing import Kinds
from .pattern import Cubes
from .strip import Strip

__all__ = ["named_parts", "numbered_parts"]


def numbered_parts(
    tree: TreeCells, strip: Strip, cubes: Cubes, kinds: Kinds, number: NDArray[np.int64]
) -> NDArray[np.int32]:
    """The number of each cell, as of `DomainMesh`: first those of regions with names.

    Parameters
    ----------
    tree, strip, cubes, kinds
        See `together`.
    number : (v,) int64
        The numbers in the whole of the vertices of `cubes`.
    """
    mesh = strip.mesh
    own = np.asarray(mesh.markers["region"]).astype(np.int64)
    count = int(own.max(initial=-1)) + 1
    roots, component = np.unique(kinds.root[kinds.root >= 0], return_inverse=True)
    part = np.full(len(kinds.root), -1, dtype=np.int64)
    part[kinds.root >= 0] = count + component
    label = _united(count + len(roots), *_touching(strip, cubes, part, number))
    seeds = np.concatenate([np.empty((0, 3)), *tree.domain.regions.values()])
    found = np.full(len(seeds), -1, dtype=np.int64)
    if len(seeds):
        leaf = np.asarray(tree.locate(seeds))
        found = part[leaf]
        cell = np.asarray(Mesh(mesh.points, mesh.simplices, neighbors=mesh.neighbors).find_simplex(seeds))
        found = np.where((found < 0) & (cell >= 0), own[cell], found)
    of_part = named_parts(tree.domain, label, label[found], found >= 0)
    cells = np.concatenate([part[cubes.leaf], own])
    return of_part[label[cells]].astype(np.int32)


def _touching(
    strip: Strip, cubes: Cubes, part: NDArray[np.int64], number: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of parts, of the kernel and of the strip, with a common face."""
    mesh = strip.mesh
    cell, k = np.nonzero(np.asarray(mesh.neighbors) < 0)
    faces = topology.oriented_facet(mesh.simplices, cell, k)
    group, _ = group_rows(np.sort(np.concatenate([number[cubes.outer], faces]), axis=1))
    of = np.full(int(group.max(initial=-1)) + 1, -1, dtype=np.int64)
    of[group[: len(cubes.outer)]] = part[cubes.outer_leaf]
    other = of[group[len(cubes.outer) :]]
    both = other >= 0
    return other[both], np.asarray(mesh.markers["region"])[cell[both]].astype(np.int64)


def _united(count: int, one: NDArray[np.int64], two: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each part the least of those that it is united with."""
    label = np.arange(count)
    pairs = np.unique(np.stack([one, two], axis=1), axis=0)
    while len(pairs):
        least = label[pairs].min(axis=1)
        before = label.copy()
        for k in range(2):
            np.minimum.at(label, pairs[:, k], least)
        if (label == before).all():
            break
    return label


def named_parts(
    domain: Any, label: NDArray[np.int64], of_seed: NDArray[np.int64], inside: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """The number of each part: that of the name of its seed, or a further one.

    Parameters
    ----------
    domain : Domain
    label : (p,) int64
        For each part the first of those that are one with it.
    of_seed : (s,) int64
        The part of each seed, in the order of the domain's regions.
    inside : (s,) bool
        Whether there is one.
    """
    names = list(domain.regions)
    name = np.repeat(np.arange(len(names)), [len(rows) for rows in domain.regions.values()])
    result = np.full(len(label), -1, dtype=np.int64)
    seeds = np.concatenate([np.empty((0, 3)), *domain.regions.values()])
    for k in np.flatnonzero(inside).tolist():
        before = int(result[of_seed[k]])
        if before not in (-1, name[k]):
            raise InputError(
                f"the seed {seeds[k].tolist()} of region {names[name[k]]!r} is in the same part as one of "
                f"{names[before]!r}; divide the part by inner facets, or give one name"
            )
        result[of_seed[k]] = name[k]
    heads = np.flatnonzero((label == np.arange(len(label))) & (result < 0))
    result[heads] = len(names) + np.arange(len(heads))
    return result[label]
