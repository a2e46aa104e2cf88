"""Zeros on edges: within the tolerance for hard functions too."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct.generate.stuffing.sampling import LevelSet

BOX = np.array([[-10.0] * 3, [10.0] * 3])
FUNCTIONS = {
    "linear": lambda s, r: r - s,
    "cubic": lambda s, r: (r - s) ** 3,
    "step": lambda s, r: np.where(s < r, 1.0, -1.0),
    "steep": lambda s, r: np.arctan(1e8 * (r - s)),
    "flat": lambda s, r: np.sign(r - s) * np.abs(r - s) ** 9,
    "one-sided": lambda s, r: np.where(s < r, 1e-200, -1e200),
}


@pytest.mark.parametrize("kind", FUNCTIONS)
@given(root=st.floats(1e-6, 1 - 1e-6))
def test_zeros(kind: str, root: float) -> None:
    body = LevelSet(lambda x: FUNCTIONS[kind](x[:, 0], root), BOX)
    inner, outer = np.zeros((1, 3)), np.array([[1.0, 0.3, -0.2]])
    found = body.zeros(inner, outer, body(inner), body(outer), 1e-10)
    assert abs(found[0] - root) <= 1e-10
    assert body.called < 80


def test_without_tolerance_nothing_is_asked() -> None:
    body = LevelSet(lambda x: 1 - x[:, 0], BOX)
    found = body.zeros(np.zeros((1, 3)), np.ones((1, 3)), np.array([1.0]), np.array([-3.0]), None)
    assert found[0] == 0.25
    assert body.called == 0


def test_many_points_in_few_calls() -> None:
    calls = []
    body = LevelSet(lambda x: calls.append(len(x)) or x[:, 0], BOX)
    body(np.zeros((600_000, 3)))
    assert calls == [262_144, 262_144, 75_712]


def test_beyond_the_box() -> None:
    body = LevelSet(lambda x: x.max(axis=1), BOX)
    assert body(np.array([[11.0, 0, 0]]))[0] == 10.0
    capped = LevelSet(lambda x: x.max(axis=1), BOX, capped=True)
    assert capped(np.array([[11.0, 0, 0], [9.5, 0, 0]])).tolist() == [-1.0, 0.5]
