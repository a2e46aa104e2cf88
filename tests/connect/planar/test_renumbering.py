"""Renumbering: the same triangulation, in another order."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain
from unstruct.connect.insertion.engine import FREE
from unstruct.connect.planar.complex import PlanarComplex
from unstruct.connect.planar.renumbering import renumber
from unstruct.generate.boundary.constrained import planar_complex


def pictured(c: PlanarComplex) -> set[tuple]:
    """All triangles by coordinates: corners, region, marks of the edges, and the apexes beyond them."""
    found = set()
    x = [*map(tuple, c.xy[: c.size].tolist()), ("ghost",)]
    for t in range(c.triangles):
        edges = []
        for e in range(3 * t, 3 * t + 3):
            assert c.twin[c.twin[e]] == e
            edges.append((x[c.vertex[e]], int(c.mark[e]), x[c.vertex[c.twin[e]]]))
        first = min(range(3), key=lambda k: str(edges[k]))  # a triangle may be turned
        found.add((int(c.region[t]), *edges[first:], *edges[:first]))
    return found


def example(seed: int) -> tuple[PlanarComplex, int]:
    """A triangulation of a square with a hole, a crack and loose vertices, and the number of the first."""
    rng = np.random.default_rng(seed)
    domain = Domain(
        np.concatenate([[[0, 0], [4, 0], [4, 4], [0, 4], [1, 1], [2, 1], [1, 2], [3, 3], [3.5, 2]],
                        rng.random((40, 2)) * 0.9 + [2.0, 0.05]]),
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4]], inner=[[7, 8]],
    )  # fmt: skip
    return planar_complex(domain), 9


@pytest.mark.parametrize("seed", range(3))
def test_the_triangulation_is_the_same(seed: int) -> None:
    c, first = example(seed)
    before, ends, old = pictured(c), c.xy[c.ends[: c.segments]].copy(), c.xy[: c.size].copy()
    number, slot = renumber(c, first)
    assert pictured(c) == before
    assert np.array_equal(c.xy[number], old) and np.array_equal(number[:first], np.arange(first))
    assert sorted(slot) == list(range(c.triangles))
    assert np.array_equal(c.xy[c.ends[: c.segments]], ends)
    assert np.array_equal(c.mark[c.where[: c.segments]], np.arange(c.segments))
    lowest = np.where(c.vertex < 0, c.size, c.vertex)[: 3 * c.triangles].reshape(-1, 3).min(axis=1)
    assert (np.diff(lowest) >= 0).all()


def test_with_free_slots_nothing_changes() -> None:
    c, first = example(0)
    before, c.state[FREE] = c.vertex.copy(), 3
    assert renumber(c, first) is None and np.array_equal(c.vertex, before)
