"""Vertices on straight edges: dropped, but for those that something needs."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.domain.space.straight import straight_vertices
from unstruct.geometry.polygons import Polygons


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(0, 7), min_size=4, max_size=4), st.integers(0, 10**6))
def test_a_ring_with_parted_sides(parts: list[int], seed: int) -> None:
    """A quadrilateral of which the sides have further vertices, in any numbering."""
    rng = np.random.default_rng(seed)
    corners = np.array([(0, 0, 0), (8, 0, 0), (8, 8, 0), (0, 8, 0)], dtype=float)
    x, corner = [], []
    for k, count in enumerate(parts):
        corner.append(len(x))
        share = np.sort(rng.choice(np.arange(1, 8), size=count, replace=False)) / 8
        x += [corners[k], *(corners[k] + s * (corners[(k + 1) % 4] - corners[k]) for s in share)]
    number = rng.permutation(len(x))
    points = np.empty((len(x), 3))
    points[number] = x
    ring = number.astype(np.int32)
    found = straight_vertices(Polygons.of_rings([[ring]]), points, 0.0)
    assert sorted(found.tolist()) == sorted(set(range(len(x))) - set(number[corner].tolist()))
    needed = int(number[rng.integers(len(x))])
    far = np.concatenate([points, [[4, 4, 4]]])
    other = np.array([needed, len(x)], dtype=np.int32)
    assert needed not in straight_vertices(Polygons.of_rings([[ring], [other]]), far, 0.0)


def test_not_farther_than_the_tolerance() -> None:
    t = np.linspace(0, np.pi, 40)
    arc = np.column_stack([np.cos(t), np.sin(t), 0 * t])
    ring = Polygons.of_rings([[np.arange(40, dtype=np.int32)]])
    for within in (1e-9, 0.01, 0.1):
        kept = np.setdiff1d(np.arange(40), straight_vertices(ring, arc, within))
        assert len(kept) >= 3
        step = np.diff(t[kept])[np.diff(kept) > 1]
        assert (1 - np.cos(step / 2) <= within + 1e-12).all()
