"""Points along pieces: none is too near to another one or to an end."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.generate.tree_regions.thinning import thinned

place = st.tuples(st.integers(0, 2), st.integers(0, 64), st.integers(1, 24), st.integers(0, 1))


def run(rows):
    piece, t, spacing, rank = np.array(sorted(rows), dtype=np.int64).reshape(-1, 4).T
    x = np.column_stack([t / 64.0, piece.astype(float)])
    ends = np.array([[0.0, p, 1.0, p] for p in range(3)])
    return piece, t / 64.0, spacing / 64.0, rank, thinned(piece, ends, x, spacing / 64.0, rank)


@settings(max_examples=200, deadline=None)
@given(rows=st.lists(place, min_size=1, max_size=30))
def test_what_stays_has_room_and_what_goes_had_none(rows):
    piece, t, spacing, rank, keep = run(rows)
    for i in range(len(t)):
        here = (piece == piece[i]) & (np.arange(len(t)) != i)
        others = np.concatenate([[0.0, 1.0], t[keep & here & (rank >= rank[i])]])
        first = keep & here & ((rank > rank[i]) | (np.arange(len(t)) < i) & (rank == rank[i]))
        room = np.abs(np.concatenate([[0.0, 1.0], t[first]]) - t[i]).min() >= spacing[i]
        assert keep[i] == room
        if keep[i]:
            assert (others != t[i]).all()


def test_the_higher_rank_stays():
    rows = [(0, 20, 8, 0), (0, 24, 8, 1), (0, 28, 8, 0)]
    assert run(rows)[-1].tolist() == [False, True, False]


def test_none():
    none = np.empty(0, dtype=np.int64)
    assert not len(thinned(none, np.zeros((1, 4)), np.empty((0, 2)), np.empty(0), none))
