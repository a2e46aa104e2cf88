"""Gmsh's format ``.msh``: the numbers of a section, and sections of data. `msh` reads whole files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..base.decimals import numbers_of
from ..base.errors import InputError

__all__ = ["MSH_DIMENSIONS", "MshSource", "msh_data", "values_of_cells"]


MSH_DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}  # all others: 3


class MshSource:
    """The contents of a section, read number by number."""

    def __init__(self, path: Path, name: str, data: bytes, order: str):
        self.path, self.name, self.data, self.order, self.at = path, name, data, order, 0
        self.flat: Any = None
        if not order:
            self.flat = numbers_of(data, int) if name == "Elements" else None
            if self.flat is None:
                self.flat = numbers_of(data)
            if self.flat is None:
                raise self.error(f"{_no_number(data)!r} is no number")

    def error(self, what: str) -> InputError:
        """An error that names the file and the section."""
        return InputError(f"{self.path.name}, section ${self.name}: {what}")

    def _take(self, count: int, kind: str) -> np.ndarray:
        count = int(count)
        if self.flat is not None:
            found = self.flat[self.at : self.at + count]
            self.at += count
        else:
            size = np.dtype(kind).itemsize * count
            found = np.frombuffer(self.data[self.at : self.at + size], self.order + kind) if size else []
            self.at += size
        if len(found) < count:
            raise self.error("it ends too early")
        return np.asarray(found)

    def ints(self, count: int) -> np.ndarray:
        """So many integers of 32 bits."""
        return self._take(count, "i4").astype(np.int64)

    def sizes(self, count: int) -> np.ndarray:
        """So many integers of 64 bits."""
        return self._take(count, "u8").astype(np.int64)

    def reals(self, count: int) -> np.ndarray:
        """So many doubles."""
        return self._take(count, "f8").astype(np.float64)

    def line(self) -> int:
        """A number on a line of its own, which is text in binary files, too."""
        if self.flat is not None:
            return int(self.ints(1)[0])
        end = self.data.find(b"\n", self.at)
        text = self.data[self.at : end].strip()
        if end < 0 or not text.isdigit():
            raise self.error(f"{text[:40]!r} is no count")
        self.at = end + 1
        return int(text)


def _no_number(data: bytes) -> str:
    for word in data.split():
        try:
            float(word)
        except ValueError:
            return word.decode("utf-8", "replace")[:40]
    return ""


def msh_data(path: Path, section: str, data: bytes, order: str) -> tuple[str, np.ndarray, np.ndarray]:
    """The name, the numbers and the values (k, c) of a section of data."""
    lines: list[bytes] = []
    at = 0

    def line() -> str:
        nonlocal at
        end = data.find(b"\n", at)
        if end < 0:
            raise InputError(f"{path.name}, section ${section}: it ends too early")
        lines.append(data[at:end])
        at = end + 1
        return lines[-1].decode("utf-8", "replace").strip()

    try:
        strings = [line() for _ in range(int(line()))]
        _ = [line() for _ in range(int(line()))]
        whole = [int(line()) for _ in range(int(line()))]
        width, n = whole[1], whole[2]
    except (ValueError, IndexError):
        raise InputError(f"{path.name}, section ${section}: {lines[-1][:40]!r} is no count") from None
    name = strings[0].strip('"') if strings else section
    if order:
        kind = np.dtype([("tag", order + "i4"), ("value", order + "f8", width)])
        if len(data) - at < n * kind.itemsize:
            raise InputError(f"{path.name}, section ${section}: it ends too early")
        rows = np.frombuffer(data[at : at + n * kind.itemsize], kind)
        return name, rows["tag"].astype(np.int64), rows["value"].astype(np.float64).reshape(n, width)
    table = MshSource(path, section, data[at:], "").reals(n * (1 + width)).reshape(n, 1 + width)
    return name, table[:, 0].astype(np.int64), table[:, 1:]


def values_of_cells(rows: np.ndarray, values: np.ndarray, counts: list[np.ndarray]) -> list[np.ndarray]:
    """Values by the numbers of elements, distributed to the blocks; zero where there is none."""
    order = np.argsort(rows, kind="stable")
    known = rows[order]
    found = []
    for numbers in counts:
        column = np.zeros((len(numbers), values.shape[1]))
        if len(known):
            place = np.minimum(np.searchsorted(known, numbers), len(known) - 1)
            some = known[place] == numbers
            column[some] = values[order[place[some]]]
        found.append(column[:, 0] if values.shape[1] == 1 else column)
    return found
