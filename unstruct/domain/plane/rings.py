"""Rings that are smaller than a tolerance and enclose nothing that stays: `simplified` drops them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...base.jit import kernel
from ...geometry.boxes import BoxTree
from ...predicates.kernels import orient2
from .collapse import Chains

__all__ = ["Rings", "small_rings"]


@dataclass(frozen=True)
class Rings:
    """Closed chains of free vertices.

    Attributes
    ----------
    chain : (r,) int64
        Their numbers among the chains.
    begin : (r + 1,) int64
    order : (k,) int64
        Ring i has the vertices order[begin[i]], ..., order[begin[i + 1] - 1], one after the other.
    label : (r,) int64
        The number of the names of its pieces.
    """

    chain: np.ndarray
    begin: np.ndarray
    order: np.ndarray
    label: np.ndarray

    @classmethod
    def of(cls, chains: Chains, label: np.ndarray) -> Rings:
        """The rings among chains whose straight pieces have these labels."""
        chain = np.nonzero(chains.tips[:, 0] < 0)[0]
        place = np.full(len(chains.tips), -1)
        place[chain] = np.arange(len(chain))
        mine = np.nonzero(place[chains.chain] >= 0)[0]
        first = np.full(len(chain), -1)
        some = np.full(len(chain), 0)
        first[place[chains.chain[mine]]] = chains.ends[mine, 0]
        some[place[chains.chain[mine]]] = label[mine]
        begin = np.concatenate([[0], np.cumsum(chains.left[chain])])
        order = np.empty(begin[-1], dtype=np.int64)
        _list(first, begin, chains.after, order)
        return cls(chain, begin, order, some)

    def vertices(self, ring: int) -> np.ndarray:
        """The vertices of one ring, in order."""
        return self.order[self.begin[ring] : self.begin[ring + 1]]


@kernel
def _list(first, begin, after, order):
    for r in range(first.shape[0]):
        v = first[r]
        for k in range(begin[r], begin[r + 1]):
            order[k] = v
            v = after[v]


@kernel
def _inside(xy, ring, begin, order, x, inside):
    """Whether points lie in the rings given for them, by exact signs; points are not on the rings."""
    for q in range(x.shape[0]):
        first, last = begin[ring[q]], begin[ring[q] + 1]
        before = order[last - 1]
        px, py = x[q, 0], x[q, 1]
        for k in range(first, last):
            a, b = before, order[k]
            before = b
            if (xy[a, 1] <= py) != (xy[b, 1] <= py):
                if xy[a, 1] > xy[b, 1]:
                    a, b = b, a
                inside[q] ^= orient2(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) > 0


def small_rings(
    xy: np.ndarray,
    rings: Rings,
    tolerance: np.ndarray,
    seeds: np.ndarray,
    sets: list[frozenset[str]],
    markers: Mapping[str, np.ndarray],
) -> np.ndarray:
    """Which rings to drop: (r,) bool.

    The diagonal of such a ring's box is at most the tolerance. It encloses no seed, and no vertex but those
    of other rings that are dropped. Of each name at least one piece stays.
    """
    many = len(rings.chain)
    gone = np.zeros(many, dtype=bool)
    if many == 0:
        return gone
    at = xy[rings.order]
    low, high = (f.reduceat(at, rings.begin[:-1], axis=0) for f in (np.minimum, np.maximum))
    across = np.hypot(*(high - low).T)
    small = np.nonzero(across <= np.minimum.reduceat(tolerance[rings.order], rings.begin[:-1]))[0]
    if len(small) == 0:
        return gone
    owner = np.full(len(xy) + len(seeds), -1)
    owner[rings.order] = np.repeat(np.arange(many), np.diff(rings.begin))
    items = np.concatenate([xy, seeds])
    item, hit = BoxTree(low[small], high[small]).pairs(items, items)
    ring = small[hit]
    other = owner[item] != ring
    item, ring = item[other], ring[other]
    inside = np.zeros(len(item), dtype=bool)
    _inside(xy, ring, rings.begin, rings.order, items[item], inside)
    within: dict[int, set[int]] = {}
    for one, two in zip(ring[inside].tolist(), owner[item[inside]].tolist()):
        within.setdefault(one, set()).add(two)
    left = {name: len(pieces) for name, pieces in markers.items()}
    for one in small[np.argsort(across[small], kind="stable")].tolist():
        length = int(rings.begin[one + 1] - rings.begin[one])
        names = sets[rings.label[one]]
        if all(two >= 0 and gone[two] for two in within.get(one, ())) and all(
            left[name] > length for name in names
        ):
            gone[one] = True
            for name in names:
                left[name] -= length
    return gone
