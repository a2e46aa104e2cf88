"""Tables of numbers: the fast way and the way line by line agree, and faults are named by their line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import InputError
from unstruct.base.tables import Rows, table

PATH = Path("a.txt")


def read(text: str) -> tuple[list[int], np.ndarray, int]:
    return table(PATH, text, "row", lambda head: 1 + head[1])


@given(
    st.lists(st.lists(st.sampled_from(["0", "1", "-2.5", "1e9"]), min_size=0, max_size=4), max_size=5),
    st.integers(0, 3),
)
def test_rows_of_any_lengths(rows: list[list[str]], columns: int) -> None:
    """Lines that are too short or too few are errors; what is read is what stands in each line."""
    lines = [" ".join([str(i), *row]) for i, row in enumerate(rows)]
    text = "\n".join([f"{len(rows)} {columns}", *lines])
    if any(len(row) < columns for row in rows):
        with pytest.raises(InputError, match=r"a\.txt, line \d+: a row needs"):
            read(text)
        return
    header, found, first = read(text)
    assert header == [len(rows), columns] and first == 0
    assert found.tolist() == [[float(word) for word in row[:columns]] for row in rows]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_comments_blanks_and_line_ends(end: str) -> None:
    text = end.join(["# head", "", "2 1 # two", "5 1", "", "# between", "6 2# last", "# end", ""])
    header, rows, first = read(text)
    assert header == [2, 1] and rows.tolist() == [[1], [2]] and first == 5


def test_large_whole_numbers_stay_what_they_are() -> None:
    assert read("1 1\n0 99999999999999999999\n")[1].tolist() == [[1e20]]


@pytest.mark.parametrize(
    "head", ["999999999 99999999", "999999999 1", "1 999999999", "9999999999999999999 1"]
)
def test_headers_that_announce_more_than_memory_holds(head: str) -> None:
    with pytest.raises(InputError, match=r"a\.txt"):
        read(f"{head}\n0 1\n")


def test_rows_one_by_one() -> None:
    rows = Rows(PATH, "3\n\n1.5 x\n")
    assert rows.count("a count") == [3] and not rows.end()
    row = rows.next(2, "a pair")
    assert rows.number(row[0], "a pair") == 1.5 and rows.place == "a.txt, line 3"
    for call, told in [
        (lambda: rows.whole(row[0], "a pair"), r"line 3: '1\.5' among a pair is no whole number"),
        (lambda: rows.number(row[1], "a pair"), r"line 3: 'x' among a pair is no number"),
        (lambda: rows.number("inf", "a pair"), "'inf' among a pair is not finite"),
        (lambda: rows.next(1, "a pair"), r"a\.txt ends where a pair is expected"),
    ]:
        with pytest.raises(InputError, match=told):
            call()
