"""A diagonal of a room: the panel of 3.1 over its whole range, by another test of crossing."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.diagonal_states import DIAGONAL_ROOMS, DIAGONAL_X, DIAGONAL_Y, diagonal_state


def turn(a: Any, b: Any, c: Any) -> Fraction:
    (p, q), (r, s), (t, v) = (map(Fraction, x) for x in (a, b, c))
    return (r - p) * (v - q) - (s - q) * (t - p)


def meet(a: Any, b: Any, c: Any, d: Any) -> bool:
    """Whether the open segment ab meets the closed segment cd, by parameters along ab."""
    one, two = turn(c, d, a), turn(c, d, b)
    if one == two:
        if one != 0:
            return False
        k = 0 if a[0] != b[0] else 1
        low, high = sorted((Fraction(a[k]), Fraction(b[k])))
        return any(low < Fraction(p[k]) < high for p in (c, d))
    t = one / (one - two)
    p = [Fraction(a[k]) + t * (Fraction(b[k]) - Fraction(a[k])) for k in (0, 1)]
    k = 0 if c[0] != d[0] else 1
    low, high = sorted((Fraction(c[k]), Fraction(d[k])))
    return 0 < t < 1 and low <= p[k] <= high


@pytest.mark.parametrize("room", DIAGONAL_ROOMS)
def test_the_diagonal_meets_nothing(room: str) -> None:
    said: dict[str, int] = {}
    for x in DIAGONAL_X:
        for y in DIAGONAL_Y:
            one = diagonal_state(x, y, room)
            check_frame(one)
            said[one["caption"]] = said.get(one["caption"], 0) + 1
            found = [item for item in one["items"] if item["role"] == "inserted"]
            assert len(found) == ("in the hole" not in one["caption"])
            for item in found:
                ((a, b),) = item["data"]
                walls = next(i["data"] for i in one["items"] if i["role"] == "constrained")
                assert not any(meet(a, b, c, d) for c, d in walls)
                assert turn(a, b, (x, y)) != 0 or not min(a[0], b[0]) < x < max(a[0], b[0])
            numbers = one["number"].removeprefix("distances from uw: ")
            if numbers[:1].isdigit():
                rows = list(map(float, numbers.split(", ")))
                assert rows == sorted(rows, reverse=True)
                u, w, (_, c) = np.array((0.4, 2.6)), np.array((3.0, -0.6)), found[0]["data"][0]
                away = abs(np.linalg.det([w - u, np.array(c) - u])) / np.linalg.norm(w - u)
                assert away == pytest.approx(rows[0], abs=0.006)
    assert len(said) == (3 if room == "with a hole" else 2) and min(said.values()) > 1


def test_unknown_values() -> None:
    with pytest.raises(InputError, match="without a hole"):
        diagonal_state(room="a hall")
    for place in ((0.0, 0.8), (0.8, 2.0), (float("nan"), 0.8)):
        with pytest.raises(InputError, match=r"x =|y ="):
            diagonal_state(*place)
