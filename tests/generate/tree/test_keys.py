"""Morton keys, against bits taken one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.generate.tree.keys import DEEPEST_LEVEL, coordinates_of, keys_of
from unstruct.plain.tree import key


@pytest.mark.parametrize("d", [2, 3])
@given(data=st.data())
def test_keys_interleave_bits(d: int, data: st.DataObject) -> None:
    level = data.draw(st.integers(0, DEEPEST_LEVEL[d]))
    number = st.integers(0, (1 << level) - 1)
    rows = data.draw(st.lists(st.tuples(*[number] * d), max_size=8))
    keys = keys_of(np.array(rows, dtype=np.int64).reshape(-1, d))
    assert keys.dtype == np.uint64 and keys.tolist() == [key((level, *row), level) for row in rows]
    assert coordinates_of(keys, d).tolist() == [list(row) for row in rows]


@pytest.mark.parametrize("d", [2, 3])
def test_the_last_cell_of_the_deepest_level(d: int) -> None:
    last = (1 << DEEPEST_LEVEL[d]) - 1
    keys = keys_of(np.array([[0] * d, [last] * d]))
    assert keys.tolist() == [0, (1 << d * DEEPEST_LEVEL[d]) - 1]
    assert coordinates_of(keys, d).tolist() == [[0] * d, [last] * d]
