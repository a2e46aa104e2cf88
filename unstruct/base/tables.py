"""Tables of numbers in text files: a header, rows, comments; every error names the file and the line."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from math import isfinite
from pathlib import Path

import numpy as np

from .decimals import numbers_of
from .errors import InputError

__all__ = ["Rows", "table", "whole_number"]


class Rows:
    """The lines of a text that contain more than a comment, as words, with their numbers.

    Parameters
    ----------
    path : Path
        Named in errors.
    text : str
    comment : str, optional
        What begins a comment.
    """

    def __init__(self, path: Path, text: str, comment: str = "#"):
        self.path = path
        self.lines = list(_lines(text, comment))
        self.at = 0

    @property
    def place(self) -> str:
        """The file and the line of the last row."""
        return f"{self.path.name}, line {self.lines[self.at - 1][0] if self.at else 1}"

    def next(self, needed: int, what: str) -> list[str]:
        """The next row, of at least so many entries."""
        if self.end():
            raise InputError(f"{self.path.name} ends where {what} is expected")
        row = self.lines[self.at][1]
        self.at += 1
        if len(row) < needed:
            raise InputError(f"{self.place}: {what} needs {needed} entries, not {' '.join(row)!r}")
        return row

    def count(self, what: str) -> list[int]:
        """A row of whole numbers that begins a section."""
        many, *rest = (self.whole(word, what) for word in self.next(1, what))
        if many < 0:
            raise InputError(f"{self.place}: {what} is {many}, but must not be negative")
        return [many, *rest]

    def number(self, word: str, what: str) -> float:
        """A finite number of the last row."""
        try:
            number = float(word)
        except ValueError:
            raise InputError(f"{self.place}: {word!r} among {what} is no number") from None
        if not isfinite(number):  # numpy's takes ten times as long
            raise InputError(f"{self.place}: {word!r} among {what} is not finite")
        return number

    def whole(self, word: str, what: str) -> int:
        """A whole number of the last row."""
        number = self.number(word, what)
        if not number.is_integer():
            raise InputError(f"{self.place}: {word!r} among {what} is no whole number")
        return int(number)

    def end(self) -> bool:
        """Whether the text ends here."""
        return self.at >= len(self.lines)


def _lines(text: str, comment: str) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(text.splitlines(), 1):
        if words := line.split(comment)[0].split():
            yield number, words


def whole_number(value: float) -> bool:
    """Whether a number is whole and small enough to be exact."""
    return value == np.floor(value) and abs(value) < 2**53


def table(
    path: Path, text: str, what: str, width: Callable[[list[int]], int]
) -> tuple[list[int], np.ndarray, int]:
    """A header, and as many numbered rows as it announces; # starts a comment.

    Parameters
    ----------
    path : Path
        Named in errors.
    text : str
    what : str
        What a row describes, for errors.
    width : function (list of int) -> int
        The number of entries of a row, by the entries of the header.

    Returns
    -------
    header : list of int
    rows : ndarray, shape (n, width - 1)
        Without the numbers of the rows; int64 if all are whole numbers, else float64.
    first : int
        The number of the first row.

    Notes
    -----
    O(length of the text), some 10^7 numbers a second; only if something is wrong line by line.
    """
    if "#" in text:
        text = re.sub(r"#[^\r\n]*", "", text)
    start = re.search(r"\S[^\r\n]*", text)
    if start is None:
        raise InputError(f"{path.name} is empty: a header is expected, then a row for each {what}")
    head = Rows(path, text[: start.end()])
    header = head.count(f"the number of rows, each a {what},")
    columns, n = width(header), header[0]
    body = text[start.end() :]
    rows = numbers_of(body, int)
    if rows is None or (len(rows) and not -(2**53) < rows.min() <= rows.max() < 2**53):
        rows = numbers_of(body)
    if rows is not None and len(rows) == n * columns:
        rows = rows.reshape(n, columns)
        first = int(rows[0, 0]) if n and whole_number(float(rows[0, 0])) else 0
        good = np.array_equal(rows[:, 0], np.arange(first, first + n)) and np.isfinite(rows).all()
        if good and _one_row_a_line(body, n, columns):
            return header, rows[:, 1:], first
    return header, *_line_by_line(Rows(path, text), n, columns, what)


def _one_row_a_line(text: str, n: int, columns: int) -> bool:
    """Whether n times ``columns`` words stand in n lines, the same number in each."""
    data = np.frombuffer(text.encode(), dtype=np.uint8)
    word = np.append(False, data > 32)
    starts = np.flatnonzero(word[1:] & ~word[:-1])
    if len(starts) != n * columns:
        return False
    ends = np.flatnonzero((data == 10) | (data == 13))
    first, last = (np.searchsorted(ends, starts[i::columns]) for i in (0, columns - 1))
    return bool((first == last).all() and (first[1:] > last[:-1]).all())


def _line_by_line(rows: Rows, n: int, columns: int, what: str) -> tuple[np.ndarray, int]:
    """The same, with the first line that is wrong named; rows may have more entries than announced."""
    rows.next(1, "a header")
    read: list[list[float]] = []  # no array before its rows are there: n and the columns may be any numbers
    for i in range(n):
        if rows.end():
            raise InputError(f"{rows.path.name} announces {n} rows but contains {i}: each is a {what}")
        words = rows.next(columns, f"a {what}")
        read.append([rows.number(word, f"the entries of a {what}") for word in words[:columns]])
        if i and read[i][0] != read[0][0] + i:
            raise InputError(
                f"{rows.place}: the {what} number {words[0]} follows number {read[i - 1][0]:.0f}; they "
                "must be numbered one by one"
            )
    if not rows.end():
        words = rows.next(1, "nothing")
        raise InputError(
            f"{rows.place}: {' '.join(words)!r} follows the last {what}; the header announces {n} rows"
        )
    values = np.array(read).reshape(n, columns)
    return values[:, 1:], int(values[0, 0]) if n else 0
