"""The marked edges of a mesh as chains between vertices of its domain, and the piece that each chain is.

See the book, chapter 2.6d.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.jit import kernel
from ..base.report import Problem, Report, problem
from ..domain.domain import Domain
from ..geometry.outline_distance import distance_to_piece
from ..geometry.parity import right_parity
from ..mesh.mesh import Mesh

__all__ = ["Chains", "among", "assigned", "chains_of", "keys_of"]


class Chains(NamedTuple):
    """Chains of marked edges, each from one vertex of the domain to another.

    Attributes
    ----------
    start : ndarray of int64, shape (c + 1,)
        Chain i has the vertices ``vertices[start[i] : start[i + 1]]``, in order.
    vertices : ndarray of int64
    piece : ndarray of int64, shape (c,)
        The piece that each chain is, -1 for none.
    """

    start: np.ndarray
    vertices: np.ndarray
    piece: np.ndarray

    def of(self, i: int) -> np.ndarray:
        """The vertices of one chain."""
        return self.vertices[self.start[i] : self.start[i + 1]]

    def owner(self) -> np.ndarray:
        """The chain of each entry of ``vertices``."""
        return np.repeat(np.arange(len(self.piece)), np.diff(self.start))

    def inner(self) -> np.ndarray:
        """The entries of ``vertices`` that are no ends of their chain."""
        between = np.ones(len(self.vertices), dtype=bool)
        between[self.start[:-1]] = between[self.start[1:] - 1] = False
        return np.flatnonzero(between)

    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """All edges (e, 2) of the chains, and the piece of each."""
        ahead = np.ones(len(self.vertices), dtype=bool)
        ahead[self.start[1:] - 1] = False
        rows = np.flatnonzero(ahead)
        return np.column_stack([self.vertices[rows], self.vertices[rows + 1]]), self.piece[self.owner()[rows]]


def keys_of(rows: np.ndarray, n: int) -> np.ndarray:
    """One number for each edge, the same in both directions."""
    low, high = np.sort(rows, axis=1).astype(np.int64).T
    return low * n + high


def among(keys: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Whether each key is among the others. (`numpy.isin` hashes integers, which takes far longer.)"""
    table = np.append(np.sort(others), np.iinfo(np.int64).max)
    return table[np.searchsorted(table, keys)] == keys


# ---------------------------------------------------------------------- from edges to chains


@kernel
def _walk(firsts, slots, at, edges, known, seen, start, vertices):
    """Follow the edges from each vertex of the domain to the next; return how many chains there are.

    The edges at vertex v are ``at[slots[v] : slots[v + 1]]``; a vertex that is not ``known`` has two.
    """
    count = filled = 0
    for first in firsts:
        for slot in range(slots[first], slots[first + 1]):
            edge, v = at[slot], first
            if seen[edge]:
                continue
            vertices[filled] = first
            filled += 1
            while True:
                seen[edge] = True
                v = edges[edge, 1] if edges[edge, 0] == v else edges[edge, 0]
                vertices[filled] = v
                filled += 1
                if known[v]:
                    break
                one, two = at[slots[v]], at[slots[v] + 1]
                edge = two if one == edge else one
            count += 1
            start[count] = filled
    return count


def chains_of(mesh: Mesh, place: np.ndarray, edges: np.ndarray, report: Report) -> Chains | None:
    """The marked edges as chains between domain vertices; a new vertex must be on exactly two of them.

    Parameters
    ----------
    mesh : Mesh
    place : ndarray of int64
        The mesh vertex of each vertex of the domain, -1 for none.
    edges : ndarray of int64, shape (e, 2)
        Each has two different ends, and occurs once.
    report : Report
        Receives what was found.

    Returns
    -------
    Chains or None
        Without their pieces; None if there are edges that no chain contains.
    """
    firsts = np.sort(place[place >= 0])
    known = np.zeros(len(mesh.points), dtype=bool)
    known[firsts] = True
    degree = np.bincount(edges.ravel(), minlength=len(mesh.points))
    loose = (degree > 0) & (degree != 2) & ~known
    text = "new vertices that are not on exactly two marked edges: a segment is missing, or several cross"
    if not report.note("marked edges form chains", problem("chain", text, vertices=np.nonzero(loose)[0])):
        return None
    at = np.argsort(edges.ravel(), kind="stable") // 2
    slots = np.concatenate([[0], np.cumsum(degree)])
    seen = np.zeros(len(edges), dtype=bool)
    start, vertices = np.zeros(len(edges) + 1, dtype=np.int64), np.empty(2 * len(edges), dtype=np.int64)
    count = _walk(firsts, slots, at, edges, known, seen, start, vertices)
    text = "marked edges that lead to no vertex of the domain"
    closed = problem("chain", text, vertices=edges[~seen].ravel())
    if not report.note("chains end at vertices of the domain", closed):
        return None
    return Chains(start[: count + 1], vertices[: start[count]], np.full(count, -1))


# ---------------------------------------------------------------------- from chains to pieces


def assigned(mesh: Mesh, domain: Domain, chains: Chains, facets: np.ndarray, report: Report) -> Chains | None:
    """Find the piece of each chain: by its ends and kind, and by distance where several fit.

    Returns
    -------
    Chains or None
        In the directions of their pieces; None if some chain is no piece, or some piece no chain.
    """
    start, vertices, _ = chains
    n, many = len(mesh.points), len(domain.points)
    origin = np.asarray(mesh.origin, dtype=np.int64)
    ends = np.column_stack([vertices[start[:-1]], vertices[start[1:] - 1]])
    outer = among(keys_of(np.column_stack([ends[:, 0], vertices[start[:-1] + 1]]), n), keys_of(facets, n))
    key = 2 * keys_of(origin[ends], many) + outer
    pieces = 2 * keys_of(domain.pieces, many) + (np.arange(len(domain.pieces)) < len(domain.facets))
    piece = _by_ends(mesh, domain, chains, key, pieces)
    stray = chains.vertices[(piece < 0)[chains.owner()]]
    free = np.ones(len(pieces), dtype=bool)
    free[piece[piece >= 0]] = False
    lost = np.flatnonzero(free)
    missing = lost[_meshed(domain)[lost]].tolist() if len(lost) else []
    text = "chains of marked edges that are no piece of the domain"
    names = ", ".join(f"{domain.name(i)} = {domain.pieces[i].tolist()}" for i in missing[:8])
    absent = Problem("missing piece", f"{names} ({len(missing)} in all; by vertices of the domain)")
    if not report.note(
        "every piece of the domain is a chain of marked edges, and no other edge is marked",
        problem("stray chain", text, vertices=stray),
        absent if missing else None,
    ):
        return None
    turned = (origin[ends[:, 0]] != domain.pieces[piece, 0])[chains.owner()]
    row, first = np.arange(len(vertices)), np.repeat(start[:-1], np.diff(start))
    last = np.repeat(start[1:] - 1, np.diff(start))
    return Chains(start, vertices[np.where(turned, first + last - row, row)], piece)


def _by_ends(mesh: Mesh, domain: Domain, chains: Chains, key: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """The piece of each chain, -1 for none; both are in order where several have the same ends."""
    order = np.argsort(pieces, kind="stable")
    place = np.searchsorted(pieces[order], key)
    count = np.searchsorted(pieces[order], key, side="right") - place
    piece = np.full(len(key), -1)
    # One piece for each pair of ends is the rule; the first chain between them is that piece.
    rows = np.flatnonzero(count == 1)
    rows = rows[np.unique(key[rows], return_index=True)[1]]
    piece[rows] = order[place[rows]]
    left: dict[int, list[int]] = {}
    several = np.flatnonzero(count > 1)
    bare = np.diff(chains.start)[several] == 2  # these fit any piece, so that they take what is left
    for i in several[np.argsort(bare, kind="stable")].tolist():
        fits = left.setdefault(int(key[i]), order[place[i] : place[i] + count[i]].tolist())
        if fits:
            one = fits[0] if len(fits) == 1 else min(fits, key=lambda p: _away(mesh, domain, chains.of(i), p))
            fits.remove(one)
            piece[i] = one
    return piece


def _meshed(domain: Domain) -> np.ndarray:
    """Whether each piece bounds the domain or lies inside; one end decides, since pieces do not cross."""
    sampled = domain.sampled()
    facets = sampled.piece < len(domain.facets)
    first = np.unique(sampled.piece, return_index=True)[1]
    inside = right_parity(sampled.points, sampled.ends[facets], sampled.ends[first])
    return inside | (np.arange(len(domain.pieces)) < len(domain.facets))


def _away(mesh: Mesh, domain: Domain, chain: np.ndarray, piece: int) -> float:
    """The distance of a chain from a piece: of its inner vertices, or of its middle if it has only ends."""
    x = mesh.points[chain]
    inside = x[1:-1] if len(x) > 2 else x.mean(axis=0, keepdims=True)
    away, t = distance_to_piece(domain, piece, inside)
    ends = inside[:, None] - domain.points[domain.pieces[piece]]
    beyond = np.sqrt((ends * ends).sum(axis=2).min(axis=1))  # distances from arcs are those from circles
    return float(np.where((t >= 0.0) & (t <= 1.0), away, np.maximum(away, beyond)).max())
