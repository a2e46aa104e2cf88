"""Rows of numbers as text: the digits of Python's own repr, at every scale."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from unstruct.base import decimals
from unstruct.base.decimals import numbers_of, rows_as_text


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decimals, "FEW_ROWS", 100)


def plain(integers: np.ndarray, reals: np.ndarray) -> bytes:
    rows = zip(integers.tolist(), reals.tolist())
    return "".join(f"{' '.join([*map(str, a), *map(repr, b)])}\n" for a, b in rows).encode()


def numbers() -> np.ndarray:
    rng = np.random.default_rng(5)
    bits = rng.integers(0, 2**64, 60_000, dtype=np.uint64).view(np.float64)
    powers = [np.ldexp(1.0, np.arange(-1074, 1024)), [float(f"1e{k}") for k in range(-323, 309)]]
    around = np.concatenate([np.nextafter(x, side) for x in powers for side in (-np.inf, np.inf)])
    short = np.round(rng.normal(size=20_000), 3) * 10.0 ** rng.integers(-8, 20, 20_000)
    whole = rng.integers(-(2**60), 2**60, 10_000) * 1.0
    limits = [
        0.0,
        -0.0,
        5e-324,
        2.2250738585072014e-308,
        1.7976931348623157e308,
        9007199254740993.0,
        1e16,
        1e-4,
    ]
    found = np.concatenate([bits, *powers, around, short, whole, limits, rng.random(20_000)])
    return found[np.isfinite(found)]


def test_the_kernel_writes_what_python_writes() -> None:
    reals = numbers()
    reals = reals[: len(reals) // 2 * 2].reshape(-1, 2)
    integers = (
        np.random.default_rng(0).integers(-(2**62), 2**62, (len(reals), 2))
        >> np.arange(len(reals))[:, None] % 62
    )
    assert len(reals) > decimals.FEW_ROWS
    assert rows_as_text(integers, reals) == plain(integers, reals)
    assert rows_as_text(integers) == plain(integers, reals[:, :0])
    few = slice(0, 7)
    assert rows_as_text(integers[few], reals[few]) == plain(integers[few], reals[few])


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=8))
def test_hypothesis_finds_no_other_digits(values: list[float]) -> None:
    reals = np.resize(np.array(values), (decimals.FEW_ROWS, 1))
    text = rows_as_text(None, reals).decode().split("\n")
    assert text[: len(values)] == [repr(x) for x in values]


@pytest.mark.parametrize("n", [0, 3, 5000])
def test_what_is_written_is_read(n: int) -> None:
    rows = np.random.default_rng(n).normal(size=(n, 3))
    assert np.array_equal(numbers_of(rows_as_text(None, rows)), rows.ravel())
    whole = np.arange(2 * n).reshape(-1, 2)
    assert np.array_equal(numbers_of(rows_as_text(whole), int), whole.ravel())
    assert rows_as_text(np.empty((n, 0), dtype=int)) == b""


def test_what_is_no_number_is_told() -> None:
    assert numbers_of("1 2 three") is None and numbers_of("1 2.5", int) is None
    assert numbers_of("1e3 -2\n\t0x") is None and numbers_of("").tolist() == []
