"""OFF and OBJ: points, and polygons by the numbers of their points; OBJ has groups and objects, too."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ....base.files import text_of
from ....geometry.polygons import Polygons
from ..surfaces import Found, free_name
from .words import Line, coordinates, polygons_of, triangles_at_once, word_rows

__all__ = ["read_obj", "read_off"]

IGNORED_LINES = set("vt vn vp mtllib usemtl s mg shadow_obj trace_obj lod bevel c_interp d_interp".split())
CURVED_PARTS = set("curv curv2 surf cstype deg bmat step parm trim hole scrv sp con".split())


def read_off(path: Path) -> Found:
    """Read a file; colors and normals are left out."""
    text = text_of(path)
    start = re.match(r"OFF\s+(\d+)\s+(\d+)\s+\d+[ \t]*\r?\n", text)
    if start:
        known = triangles_at_once(text[start.end() :], int(start[1]), int(start[2]))
        if known:
            return Found({"points": known[0], "facets": known[1]})
    rows = word_rows(text)
    if not rows:
        raise InputError(f"{path.name} is empty: the word OFF and three counts are expected")
    head = re.fullmatch(r"(ST)?(C)?(N)?(4)?(n)?OFF", rows[0][1][0], re.IGNORECASE)
    at = 0
    if head:
        if head[4] or head[5]:
            raise InputError(f"{path.name} has points of 4 or n coordinates ({head[0]}), not of 3")
        if rows[0][1][1:2] == ["BINARY"]:
            raise InputError(f"{path.name} is a binary OFF file, which is not read: write it as text")
        rest = rows[0][1][1:]
        rows = [(rows[0][0], rest), *rows[1:]] if rest else rows[1:]
    if not rows:
        raise InputError(f"{path.name} ends where the numbers of vertices and faces are expected")
    line, counts = rows[at]
    try:
        n, f = (int(word) for word in counts[:2])
        if min(n, f) < 0:
            raise ValueError
    except ValueError:
        raise InputError(
            f"{path.name}, line {line}: the numbers of vertices, faces and edges are expected, not "
            f"{' '.join(counts)[:60]!r}"
        ) from None
    rows = rows[1:]
    if len(rows) < n + f:
        what = "vertices" if len(rows) < n else "faces"
        raise InputError(
            f"{path.name} announces {n} vertices and {f} faces, but has {len(rows)} lines for them: "
            f"it is truncated in the {what}"
        )
    if len(rows) > n + f:
        raise InputError(
            f"{path.name}, line {rows[n + f][0]}: {' '.join(rows[n + f][1])[:60]!r} follows the last of {f} "
            "faces that are announced"
        )
    points = coordinates(path, rows[:n])
    return Found({"points": points, "facets": _off_faces(path, rows[n:], n)})


def _off_faces(path: Path, rows: list[Line], count: int) -> Polygons:
    found = []
    for line, words in rows:
        try:
            size = int(words[0])
            row = [int(word) for word in words[1 : 1 + max(size, 0)]]
        except ValueError:
            raise InputError(
                f"{path.name}, line {line}: a face is the number of its vertices, then they, not "
                f"{' '.join(words)[:60]!r}"
            ) from None
        if len(row) != size:
            raise InputError(f"{path.name}, line {line}: a face of {size} vertices has {len(row)}")
        found.append((line, row))
    return polygons_of(path, found, count)


# ---------------------------------------------------------------------- OBJ


def read_obj(path: Path) -> Found:
    """Read a file: faces become facets, lines inner segments; groups and objects become markers."""
    text = text_of(path)
    if "\\" in text:  # a line that is continued; the others keep their numbers
        text = re.sub(r"\\[ \t]*(\r?\n)((?:.*\\[ \t]*\r?\n)*)(.*)", _joined, text)
    vertices: list[Line] = []
    faces: list[tuple[int, list[int]]] = []
    lines: list[tuple[int, list[int]]] = []
    named: dict[str, list[int]] = {}
    group: list[str] = []
    thing: list[str] = []
    for line in word_rows(text):
        number, words = line
        key = words[0].lower()
        if key == "v":
            vertices.append(line)
        elif key == "f" or key == "fo":
            for name in dict.fromkeys([*group, *thing]):
                named.setdefault(name, []).append(len(faces))
            faces.append((number, _indices(path, number, words, len(vertices))))
        elif key == "l":
            row = _indices(path, number, words, len(vertices))
            lines += [(number, list(pair)) for pair in pairwise(row)]
        elif key == "g":
            group = words[1:]
        elif key == "o":
            thing = [" ".join(words[1:])] if words[1:] else []
        elif key in CURVED_PARTS:
            raise InputError(
                f"{path.name}, line {number}: {key!r} belongs to curves and curved surfaces, which are not "
                "read; write the body as polygons"
            )
        elif key not in IGNORED_LINES and key != "p":
            raise InputError(
                f"{path.name}, line {number}: {' '.join(words)[:60]!r} is no line of an OBJ file"
            )
    if not vertices:
        raise InputError(f"{path.name} has no vertices: lines that begin with 'v' are expected")
    count = len(vertices)
    parts = {
        "points": coordinates(path, vertices, 1),
        "facets": polygons_of(path, faces, count, first=1),
        "markers": {free_name(name): np.array(rows) for name, rows in named.items()},
    }
    if lines:
        parts["inner"] = polygons_of(path, lines, count, least=2, first=1)
    return Found(parts)


def _joined(match: re.Match[str]) -> str:
    """A continued line as one, followed by as many empty ones as it took."""
    whole = match[0]
    return re.sub(r"\\[ \t]*\r?\n", " ", whole) + "\n" * whole.count("\n")


def _indices(path: Path, line: int, words: list[str], count: int) -> list[int]:
    """The vertices of a face, counted from 0; negative numbers count back from the last vertex."""
    found = []
    for word in words[1:]:
        try:
            value = int(word.split("/", 1)[0])
        except ValueError:
            raise InputError(f"{path.name}, line {line}: {word[:60]!r} is no number of a vertex") from None
        if value == 0 or value < -count:
            raise InputError(
                f"{path.name}, line {line}: there is no vertex {value}; they are counted from 1, or back "
                f"from -1 to {-count}"
            )
        found.append(value - 1 if value > 0 else count + value)
    return found
