"""STL: triangles with three corners each, as text or binary; equal corners become one point.

Several solids are several names. A binary file is told from a text by its length, which follows from the
number of triangles, because binary files may begin with the word "solid", too.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ....base.decimals import numbers_of
from ....base.errors import InputError
from ....base.files import bytes_of
from ..surfaces import Found, groups, merged
from .words import finite_rows

__all__ = ["STL_TRIANGLE", "read_stl"]

STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
STL_HEAD = 84  # bytes before the first triangle: 80 of any text, then the number of triangles
FACET = "facet normal # # # outer loop vertex # # # vertex # # # vertex # # # endloop endfacet".split()
NUMBERS = [i for i, word in enumerate(FACET) if word == "#"][3:]  # those of the corners, not of the normal
LINES = ("facet normal", "outer loop", "vertex", "vertex", "vertex", "endloop", "endfacet")
SOLID_LINE = re.compile(r"^[ \t]*(end)?solid\b[ \t]*(.*?)[ \t]*\r?$", re.IGNORECASE | re.MULTILINE)


def read_stl(path: Path) -> Found:
    """Read a file: triangles, and the names of its solids."""
    data = bytes_of(path)
    if not data.strip():
        raise InputError(f"{path.name} is empty: an STL file has at least one triangle")
    plain = data.removeprefix(b"\xef\xbb\xbf")
    named = plain.lstrip()[:5].lower() == b"solid"
    if _is_binary(data) or not named or b"\0" in data[:STL_HEAD]:
        runs = _binary(path, data)
    else:
        runs = _text(path, plain.decode("utf-8", errors="replace"))
    corners = np.concatenate([part for _, part in runs]).reshape(-1, 3)
    if len(corners) == 0:
        raise InputError(f"{path.name} has no triangles")
    points, number, origin, repairs = merged(corners, f"{len(corners) // 3} triangles")
    names, sizes = [name for name, _ in runs], [len(part) for _, part in runs]
    facets = number.reshape(-1, 3)
    parts = {"points": points, "facets": facets, "markers": groups(names, sizes)}
    return Found(parts, origin=origin, repairs=repairs)


def _is_binary(data: bytes) -> bool:
    return len(data) >= STL_HEAD and len(data) == STL_HEAD + STL_TRIANGLE.itemsize * _count(data, 0)


def _count(data: bytes, start: int) -> int:
    return int.from_bytes(data[start + STL_HEAD - 4 : start + STL_HEAD], "little")


def _binary(path: Path, data: bytes) -> list[tuple[str, np.ndarray]]:
    """The names and the corners (t, 3, 3) of the solids: mostly one, but files may be joined."""
    start = 0
    found: list[tuple[str, np.ndarray]] = []
    while start < len(data):
        rest = len(data) - start
        if rest < STL_HEAD:
            those = f"the {rest} bytes after the last triangle" if start else f"its {rest} bytes"
            raise InputError(
                f"{path.name}: {those} are neither a text that begins with 'solid', nor the head of a binary "
                "STL file, which has 84 bytes; is it whole?"
            )
        many = _count(data, start)
        if many == 0 and rest > STL_HEAD and start == 0:
            raise InputError(
                f"{path.name} announces 0 triangles, but has {rest - STL_HEAD} bytes after its head, as of "
                f"{(rest - STL_HEAD) // STL_TRIANGLE.itemsize} triangles: write it anew, with their number"
            )
        needed = STL_HEAD + STL_TRIANGLE.itemsize * many
        if rest < needed:
            raise InputError(
                f"{path.name} announces {many} triangles, which take {needed} bytes, but has {rest}: it is "
                "truncated, or not an STL file"
            )
        rows = np.frombuffer(data, STL_TRIANGLE, many, start + STL_HEAD)
        corners = rows["corners"].astype(np.float64)
        finite_rows(path, corners, "triangle")
        head = data[start : start + 80].split(b"\0")[0].decode("ascii", errors="ignore").strip()
        found.append((head.removeprefix("solid").strip() or f"solid {len(found) + 1}", corners))
        start += needed
    if len(found) == 1:  # the head of a single one says only which program wrote it
        return [("", found[0][1])]
    return found


def _text(path: Path, text: str) -> list[tuple[str, np.ndarray]]:
    """The same from a text."""
    found, start, name = [], 0, None
    for match in SOLID_LINE.finditer(text):
        body = text[start : match.start()]
        ends = match[1] is not None
        if (name is None) == ends or (name is None and body.strip()):
            word = "endsolid" if ends else "solid"
            raise InputError(
                f"{path.name}, line {_line(text, match.start())}: {word!r} is not expected here; each solid "
                "begins with 'solid' and ends with 'endsolid'"
            )
        if ends:
            assert name is not None
            found.append((name, _facets(path, text, start, body)))
            name = None
        else:
            name = match[2]
        start = match.end()
    if name is not None:
        _facets(path, text, start, text[start:])
        raise InputError(f"{path.name} ends without 'endsolid': it is truncated")
    if text[start:].strip():
        raise InputError(
            f"{path.name}, line {_line(text, start) + 1}: there is something after the last 'endsolid'"
        )
    return found


def _line(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1


def _facets(path: Path, text: str, start: int, body: str) -> np.ndarray:
    """The corners (t, 3, 3) of one solid."""
    words = body.lower().split()
    width = len(FACET)
    if not words:
        return np.empty((0, 3, 3))
    if len(words) % width == 0 and all(
        words[i::width].count(word) == len(words) // width for i, word in enumerate(FACET) if word != "#"
    ):
        values = numbers_of(" ".join([" ".join(words[i::width]) for i in NUMBERS]))
        if values is not None and len(values) == len(NUMBERS) * (len(words) // width):
            if np.isfinite(values).all():
                return np.ascontiguousarray(values.reshape(len(NUMBERS), -1).T).reshape(-1, 3, 3)
    first = _line(text, start)
    rows = [(first + i, line.split()) for i, line in enumerate(body.split("\n"))]
    _find_wrong(path, [(i, row) for i, row in rows if row])
    raise InputError(
        f"{path.name}, from line {first} on: this is not a sequence of 'facet normal', 'outer loop', three "
        "times 'vertex', 'endloop', 'endfacet'"
    )


def _find_wrong(path: Path, rows: list[tuple[int, list[str]]]) -> None:
    """Raise at the first line that is not as it should be."""
    for i, (line, words) in enumerate(rows):
        wanted = LINES[i % len(LINES)]
        given = " ".join(words).lower()
        if not (given == wanted or given.startswith(f"{wanted} ")):
            raise InputError(f"{path.name}, line {line}: {wanted!r} is expected, not {given[:60]!r}")
        numbers = words[len(wanted.split()) :]
        if wanted != "vertex":
            continue
        if len(numbers) != 3:
            raise InputError(f"{path.name}, line {line}: a vertex needs 3 coordinates, not {given[:60]!r}")
        for word in numbers:
            try:
                good = bool(np.isfinite(float(word)))
            except ValueError:
                raise InputError(f"{path.name}, line {line}: {word!r} is no number") from None
            if not good:
                raise InputError(f"{path.name}, line {line}: {word!r} among coordinates is not finite")
    if len(rows) % len(LINES):
        line = rows[-1][0]
        raise InputError(
            f"{path.name}, line {line}: {LINES[len(rows) % len(LINES)]!r} is expected after this line; the "
            "file is truncated"
        )
