"""Functions of the caller's that raise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from unstruct.base.asking import asked_at, first_to_raise
from unstruct.errors import InputError

PLACES = np.arange(20.0).reshape(10, 2)


def _no_sixth(x: Any) -> Any:
    if (x[:, 0] == 10.0).any():
        raise ZeroDivisionError("no sixth")
    return x[:, 0]


def test_the_first_place_concerned() -> None:
    assert first_to_raise(_no_sixth, PLACES) == 5
    message = (
        r"the size raised ZeroDivisionError \(no sixth\) at x\[105\] = \[10\.0, 11\.0\]; it takes places"
    )
    with pytest.raises(InputError, match=message) as caught:
        asked_at(_no_sixth, PLACES, "the size", "places", first=100)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert asked_at(_no_sixth, PLACES[:5], "the size", "places").tolist() == [0, 2, 4, 6, 8]


def test_no_places_at_all() -> None:
    with pytest.raises(InputError, match=r"raised ZeroDivisionError .* for no points; it takes"):
        asked_at(lambda x: 1 / 0, PLACES[:0], "the size", "places")


def test_what_this_package_raises_is_passed_on() -> None:
    def inner(x: Any) -> Any:
        raise InputError("from within")

    with pytest.raises(InputError, match=r"^from within$"):
        asked_at(inner, PLACES, "the size", "places")
