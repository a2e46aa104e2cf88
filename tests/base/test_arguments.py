"""Single arguments: what is accepted, and errors that name the argument."""

import numpy as np
import pytest

from unstruct import InputError
from unstruct.base.arguments import as_count, as_flag, as_mapping, finite, positive


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int8(2), np.array(2.0)])
def test_numbers_of_any_kind(value):
    assert finite(value, "x") == positive(value, "x") == 2.0
    assert type(finite(value, "x")) is float


@pytest.mark.parametrize("value", ["2", b"2", True, np.True_, None, [2], np.zeros(2), 2j, 10**400, {}])
def test_what_is_no_number(value):
    for check in (finite, positive):
        with pytest.raises(InputError, match=r"^min_angle must be a number, not "):
            check(value, "min_angle")


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite(value):
    for check in (finite, positive):
        with pytest.raises(InputError, match="finite"):
            check(value, "x")


@pytest.mark.parametrize("value", [0, -1.0, -0.0])
def test_numbers_that_are_not_positive(value):
    assert finite(value, "x") == value
    with pytest.raises(InputError, match=r"x = .* must be positive"):
        positive(value, "x")


def test_flags_counts_and_mappings():
    assert as_flag(np.True_, "hull") is True and as_flag(False, "hull") is False
    assert as_count(np.int64(3), "n") == 3 and as_mapping({}, "m") == {}
    for value in ("no", 1, None, [True]):
        with pytest.raises(InputError, match="hull must be True or False"):
            as_flag(value, "hull")
    for value in (True, -1, 2.0, "2"):
        with pytest.raises(InputError, match=r"n = .* whole number"):
            as_count(value, "n")
    with pytest.raises(InputError, match="m must be a dict"):
        as_mapping([], "m")
