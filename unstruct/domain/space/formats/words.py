"""Rows of words in text files as arrays; a word that is wrong is named with its line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ....base.decimals import numbers_of
from ....base.errors import InputError
from ....geometry.polygons import Polygons

__all__ = ["Line", "coordinates", "finite_rows", "polygons_of", "triangles_at_once", "word_rows"]

Line = tuple[int, list[str]]  # the number of a line, and its words


def word_rows(text: str, comment: str = "#") -> list[Line]:
    """The lines that contain more than a comment."""
    if comment not in text:
        return [(i, words) for i, line in enumerate(text.splitlines(), 1) if (words := line.split())]
    lines = enumerate(text.splitlines(), 1)
    return [(i, words) for i, line in lines if (words := line.split(comment, 1)[0].split())]


def coordinates(path: Path, rows: Sequence[Line], first: int = 0) -> np.ndarray:
    """Three coordinates from each row, (n, 3) float64; they begin with word ``first``."""
    if not rows:
        raise InputError(f"{path.name} has no vertices")
    found = numbers_of(" ".join([" ".join(words[first : first + 3]) for _, words in rows]))
    enough = min((len(words) for _, words in rows), default=3 + first) >= 3 + first
    if enough and found is not None and len(found) == 3 * len(rows) and np.isfinite(found).all():
        return found.reshape(-1, 3)
    for line, words in rows:
        if len(words) < first + 3:
            raise InputError(
                f"{path.name}, line {line}: a vertex needs 3 coordinates, not {' '.join(words)[:60]!r}"
            )
        for word in words[first : first + 3]:
            try:
                good = bool(np.isfinite(float(word)))
            except ValueError:
                raise InputError(
                    f"{path.name}, line {line}: {word[:60]!r} among coordinates is no number"
                ) from None
            if not good:
                raise InputError(f"{path.name}, line {line}: {word!r} among coordinates is not finite")
    raise InputError(f"{path.name}: coordinates cannot be read as numbers")


def triangles_at_once(text: str, points: int, triangles: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Coordinates, then rows "3 a b c", read at once; None if the text has anything else.

    Returns
    -------
    points : (n, 3) float64
    rows : (t, 3) int32
    """
    found = numbers_of(text)
    if found is None or len(found) != 3 * points + 4 * triangles or triangles == 0:
        return None
    rows = found[3 * points :].reshape(-1, 4)
    whole = (rows[:, 0] == 3).all() and (rows == np.floor(rows)).all()
    if not whole or rows.min() < 0 or rows[:, 1:].max() >= points or not np.isfinite(found).all():
        return None
    return found[: 3 * points].reshape(-1, 3), rows[:, 1:].astype(np.int32)


def finite_rows(path: Path, corners: np.ndarray, what: str) -> None:
    """Raise if a row of a binary file has coordinates that are not finite."""
    good = np.isfinite(corners).all(axis=tuple(range(1, corners.ndim)))
    if not good.all():
        row = int(np.argmin(good))
        raise InputError(
            f"{path.name}: {what} {row} has coordinates {corners[row].tolist()}, which are not finite; "
            "is the file whole, and binary as it says?"
        )


def polygons_of(
    path: Path, rows: Sequence[tuple[int, list[int]]], count: int, least: int = 3, first: int = 0
) -> Polygons:
    """Polygons, given with the lines on which they stand; their vertices must be 0, ..., count - 1.

    ``first`` is the number of the first vertex in the file, for messages.
    """
    sizes = np.array([len(row) for _, row in rows], dtype=np.int64)
    try:
        flat = np.array([v for _, row in rows for v in row], dtype=np.int64)
    except OverflowError:
        flat = np.array([min(max(v, -1), count) for _, row in rows for v in row], dtype=np.int64)
    short = np.flatnonzero(sizes < least)
    if len(short):
        line, row = rows[int(short[0])]
        raise InputError(f"{path.name}, line {line}: a facet has {len(row)} vertices, but needs {least}")
    bad = np.flatnonzero((flat < 0) | (flat >= count))
    if len(bad):
        at = int(np.searchsorted(np.cumsum(sizes), bad[0], side="right"))
        line, row = rows[at]
        wrong = next(v for v in row if not 0 <= v < count)
        has = f"{first} to {count - 1 + first}" if count else "none"
        raise InputError(f"{path.name}, line {line}: there is no vertex {wrong + first}; the file has {has}")
    return Polygons(flat.astype(np.int32), np.concatenate([[0], np.cumsum(sizes)]), np.arange(len(rows) + 1))
