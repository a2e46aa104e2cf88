"""Facets and inner pieces with the same vertices, and which of them stay."""

from __future__ import annotations

from collections import Counter

import numpy as np

from ...geometry.polygons import Polygons

__all__ = ["same_facets"]

Edge = tuple[int, int]


def same_facets(polygons: Polygons, facet: np.ndarray) -> list[tuple[list[int], int]]:
    """Groups of pieces with the same sides, and the one of each that stays; -1 if none does.

    An odd number of facets is one facet. An even number cancels; but if the edges around are open without
    it, and closed with it, one stays, as where a facet of a closed surface is there twice.
    """
    groups = _groups(polygons)
    if not groups:
        return []
    facets = [[r for r in rows if facet[r]] for rows in groups]
    doubtful = [k for k, rows in enumerate(facets) if rows and len(rows) % 2 == 0]
    closing = _closing(polygons, facet, facets, doubtful)
    result = []
    for k, rows in enumerate(groups):
        inner = [r for r in rows if not facet[r]]
        stays = facets[k] if len(facets[k]) % 2 or k in closing else inner
        result.append((rows, stays[0] if stays else -1))
    return result


def _groups(polygons: Polygons) -> list[list[int]]:
    """Rows with the same sides, in groups of two and more."""
    corners = polygons.corners
    # sums that equal pieces have in common leave few to compare
    total = np.zeros(len(polygons), dtype=np.int64)
    owner = np.repeat(np.arange(len(polygons)), corners)
    vertex = polygons.vertices.astype(np.int64)
    np.add.at(total, owner, (vertex * 0x5BD1E995) ^ (vertex << 20))
    _, group, count = np.unique(
        np.column_stack([corners, total]), axis=0, return_inverse=True, return_counts=True
    )
    found: dict[frozenset[Edge], list[int]] = {}
    for i in np.flatnonzero(count[group.ravel()] > 1).tolist():
        found.setdefault(frozenset(_sides(polygons, i)), []).append(i)
    return [rows for rows in found.values() if len(rows) > 1]


def _sides(polygons: Polygons, i: int) -> list[Edge]:
    sides = []
    for ring in polygons.rings(i):
        row = ring.tolist()
        pairs = zip(row, row[1:] + row[:1])
        sides += [(min(pair), max(pair)) for pair in pairs][: len(row) - (len(row) == 2)]
    return sides


def _closing(polygons: Polygons, facet: np.ndarray, facets: list[list[int]], doubtful: list[int]) -> set[int]:
    """Those of the doubtful groups of which one facet closes the surface, patch by patch."""
    if not doubtful:
        return set()
    ends, owner = polygons.sides
    odd: Counter[Edge] = Counter()
    double = np.zeros(len(polygons), dtype=bool)
    double[[r for k in doubtful for r in facets[k]]] = True
    around: dict[Edge, list[int]] = {}
    for k in doubtful:
        for edge in _sides(polygons, facets[k][0]):
            around.setdefault(edge, []).append(k)
    low, high = np.sort(ends, axis=1).T
    near = np.isin(low, [a for a, _ in around]) & facet[owner] & ~double[owner]
    for edge in zip(low[near].tolist(), high[near].tolist()):
        if edge in around:
            odd[edge] ^= 1
    patch = {k: k for k in doubtful}

    def root(k: int) -> int:
        while patch[k] != k:
            patch[k] = patch[patch[k]]
            k = patch[k]
        return k

    for rows in around.values():
        for k in rows[1:]:
            patch[root(k)] = root(rows[0])
    bounded, wrong = set(), set()
    for edge, rows in around.items():
        own = len(rows) % 2
        if own:
            bounded.add(root(rows[0]))
        if own != odd[edge]:
            wrong.add(root(rows[0]))
    return {k for k in doubtful if root(k) in bounded and root(k) not in wrong}
