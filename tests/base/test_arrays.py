"""Rows that are surely different."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.base.arrays import surely_different

NUMBERS = st.sampled_from([0.0, -0.0, 1.0, -1.0, 2.0**-60, 5e-324, 1 + 2.0**-52, 1e300])


@given(st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), max_size=8))
def test_points_that_are_equal_are_never_missed(rows: list[tuple[float, float, float]]) -> None:
    points = np.array(rows, dtype=float).reshape(-1, 3)
    assert surely_different(points) == (len({*rows}) == len(rows))


@given(st.lists(st.tuples(*[st.integers(0, 4)] * 3), max_size=8), st.booleans())
def test_rows_of_numbers(rows: list[tuple[int, int, int]], as_sets: bool) -> None:
    array = np.array(rows, dtype=np.int32).reshape(-1, 3)
    keys = {tuple(sorted(row)) for row in rows} if as_sets else {*rows}
    assert surely_different(array, as_sets=as_sets) == (len(keys) == len(rows))


@pytest.mark.parametrize("step", [1.0, 0.1, 2.0**-20, 1e6])
def test_lattices_have_different_keys(step: float) -> None:
    """Multiples of powers of two differ in few bits."""
    lattice = step * np.array([*np.ndindex(40, 40, 40)], dtype=float)
    assert surely_different(lattice)
    assert surely_different(np.array([*np.ndindex(200, 200)], dtype=np.int32))
