"""Functions that are written into kernels at once do what numba's own do, for all types."""

from __future__ import annotations

from pathlib import Path

import pytest
from alone import run

import unstruct.base.jit
from unstruct.base.inside_builtins import direct
from unstruct.base.inside_numba import KNOWN

SAME = """
import itertools
import numba, numpy as np
from unstruct.base.jit import kernel

def three(a, b, c):
    return min(a, b), max(a, b), min(a, b, c), max(c, b, a), min(3, a), max(b, 2.5), max((a, b, c))

def whole(x):
    return int(x), int(abs(x)), int(x > 0)

def arrays(n, few):
    one, two = np.empty(n, dtype=np.float64), np.empty((n, 2), dtype=np.int32)
    three, four, five = np.empty(few, np.bool_), np.empty(n), np.empty((2, n, 3), dtype=np.uint8)
    one[:], two[:], three[:], four[:], five[:] = 1.5, -2, True, 0.5, 255
    return one, two, three, four, five

def negative(n):
    return np.empty(n, dtype=np.int64)

ours, theirs = ([k(f) for f in (three, whole, arrays)] for k in (kernel, numba.njit))
nasty = [0.0, -0.0, 1.0, np.nan, np.inf, -np.inf, 5e-324]
cases = [*itertools.product(nasty, nasty, nasty), (1, 2, -3), (1, 2.5, -1), (1.0, 7, 7), (True, 2, 1)]
cases += [(np.uint8(200), np.int32(-1), 5), (np.int32(4), np.int32(4), np.int32(-2))]
cases += [(np.float32(0.1), 0.1, 1)]
for case in cases:
    assert repr(ours[0](*case)) == repr(theirs[0](*case)), case
for x in (0.0, -0.7, 2.9, -3.5, 1e15, 7, True, np.int32(-2)):
    assert repr(ours[1](x)) == repr(theirs[1](x)), x
for n, few in ((0, 0), (3, 2), (np.int32(4), np.uint8(1))):
    for one, other in zip(ours[2](n, few), theirs[2](n, few)):
        assert one.dtype == other.dtype and one.shape == other.shape and (one == other).all()
        assert one.flags.owndata == other.flags.owndata and one.flags.c_contiguous
try:
    kernel(negative)(-1)
except ValueError as error:
    print(error)
"""


@pytest.mark.skipif(
    unstruct.base.jit.numba is None or not KNOWN, reason="numba is not installed, or another one"
)
def test_functions_that_are_written_in_place_agree_with_those_of_numba(tmp_path: Path) -> None:
    """Signed zeros, NaN, mixed types, several dimensions, and the error for a negative length."""
    (tmp_path / "same.py").write_text(SAME)
    found = run("import same", tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert found.strip() == "negative dimensions not allowed"


def test_other_functions_are_left_to_numba() -> None:
    assert direct(sum) is None
    assert direct([]) is None
