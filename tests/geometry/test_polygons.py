"""Polygons in flat arrays, beside lists of lists."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.geometry.polygons import Polygons

RING = st.lists(st.integers(0, 9), min_size=2, max_size=6)
RINGS = st.lists(st.lists(RING, min_size=1, max_size=3), max_size=7)


def listed(polygons: Polygons) -> list[list[list[int]]]:
    return [[ring.tolist() for ring in polygons.rings(i)] for i in range(len(polygons))]


@given(RINGS, RINGS, st.data())
def test_as_lists_of_lists(one: list, two: list, data: st.DataObject) -> None:
    first, second = Polygons.of_rings(one), Polygons.of_rings(two)
    both = Polygons.joined(first, second)
    assert listed(first) == one and listed(both) == one + two and len(both) == len(one) + len(two)
    assert both.corners.tolist() == [sum(map(len, rings)) for rings in one + two]
    assert [both.vertices_of(i).tolist() for i in range(len(both))] == [
        [v for ring in rings for v in ring] for rings in one + two
    ]
    which = data.draw(st.lists(st.integers(0, len(both) - 1), max_size=8)) if len(both) else []
    assert listed(both.select(np.array(which))) == [(one + two)[i] for i in which]
    assert listed(both.turned(np.array(which))) == [
        [ring[::-1] for ring in rings] if i in which else rings for i, rings in enumerate(one + two)
    ]
    number = np.arange(9, -1, -1, dtype=np.int32)
    assert listed(both.renumbered(number)) == [[[9 - v for v in ring] for ring in r] for r in one + two]
    ends, owner = both.sides
    wanted = [
        (i, ring[k], ring[(k + 1) % len(ring)])
        for i, rings in enumerate(one + two)
        for ring in rings
        for k in range(len(ring) if len(ring) > 2 else 1)
    ]
    assert [*zip(owner.tolist(), *ends.T.tolist())] == wanted
    again = pickle.loads(pickle.dumps(both))
    assert again == both and hash(again) == hash(both)
    assert (first == second) == (one == two)


def test_as_a_sequence() -> None:
    polygons = Polygons.of_rings([[[0, 1, 2]], [[0, 1, 2, 3], [4, 5, 6]]])
    assert polygons[0].tolist() == [0, 1, 2]
    assert [ring.tolist() for ring in polygons[-1]] == [[0, 1, 2, 3], [4, 5, 6]]
    assert len(polygons[:1]) == 1 and [len(item) for item in polygons] == [3, 2]
    with pytest.raises(IndexError, match="but not 2"):
        polygons[2]
    assert polygons.triangles is None and "2 polygons of 10 vertices" in repr(polygons)
    rows = Polygons.of(np.array([[0, 1, 2], [2, 1, 3]]))
    assert rows.triangles is not None and rows.triangles.tolist() == [[0, 1, 2], [2, 1, 3]]
    assert Polygons.of(rows) is rows and len(Polygons.of_rings([])) == 0
    with pytest.raises(ValueError, match="read-only"):
        rows.vertices[0] = 5
