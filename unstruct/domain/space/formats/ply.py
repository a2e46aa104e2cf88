"""PLY: points and polygons with any further properties, as text or binary."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ....base.errors import InputError
from ....base.files import bytes_of
from ....geometry.polygons import Polygons
from ...plane.account import Repair
from ..surfaces import Found
from .words import coordinates, finite_rows, polygons_of, triangles_at_once, word_rows

__all__ = ["read_ply"]

TYPES = {
    **dict.fromkeys(["char", "int8"], "i1"),
    **dict.fromkeys(["uchar", "uint8"], "u1"),
    **dict.fromkeys(["short", "int16"], "i2"),
    **dict.fromkeys(["ushort", "uint16"], "u2"),
    **dict.fromkeys(["int", "int32"], "i4"),
    **dict.fromkeys(["uint", "uint32"], "u4"),
    **dict.fromkeys(["float", "float32"], "f4"),
    **dict.fromkeys(["double", "float64"], "f8"),
}
FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LISTS_OF_CORNERS = ("vertex_indices", "vertex_index")
END = b"end_header"


class _Property(NamedTuple):
    name: str
    kind: str  # a type of numpy, without the order of bytes
    length: str | None  # of a list: the type of the number of its entries


class _Element(NamedTuple):
    name: str
    many: int
    properties: list[_Property]


class _Head(NamedTuple):
    order: str  # of bytes, as numpy writes it; "" for a text
    elements: list[_Element]
    body: bytes
    lines: int  # of the header


def read_ply(path: Path) -> Found:
    """Read a file: vertices and faces; colors, normals and other elements are left out."""
    head = _head(path, bytes_of(path))
    by_name = {element.name: element for element in head.elements}
    if "tristrips" in by_name:
        raise InputError(f"{path.name} has strips of triangles, which are not read: write faces")
    if "vertex" not in by_name:
        raise InputError(f"{path.name} has no element 'vertex'")
    names = [p.name for p in by_name["vertex"].properties]
    missing = [name for name in "xyz" if name not in names]
    if missing or any(p.length for p in by_name["vertex"].properties):
        raise InputError(f"{path.name}: vertices need the properties x, y, z, not {', '.join(names)}")
    lists = [p for p in by_name["face"].properties if p.length] if "face" in by_name else None
    if lists is not None and not any(p.name in LISTS_OF_CORNERS and p.kind[0] != "f" for p in lists):
        raise InputError(f"{path.name}: faces need the list 'vertex_indices'")
    if by_name["vertex"].many == 0:
        raise InputError(f"{path.name} has no vertices")
    points, facets = _of_text(path, head) if head.order == "" else _of_bytes(path, head)
    others = [e for e in head.elements if e.name not in ("vertex", "face") and e.many]
    what = ", ".join(f"{e.many} of {e.name!r}" for e in others)
    text = f"the file also has {what}, which were left out"
    repairs = (Repair("left out", text, (float("nan"),) * 3),) if others else ()
    return Found({"points": points, "facets": facets}, repairs=repairs)


def _head(path: Path, data: bytes) -> _Head:
    data = data.removeprefix(b"\xef\xbb\xbf")
    if not data.lstrip()[:3].lower() == b"ply":
        raise InputError(f"{path.name} is not a PLY file: it does not begin with 'ply'")
    end = data.find(END)
    if end < 0:
        raise InputError(f"{path.name} ends before 'end_header': it is truncated")
    stop = data.find(b"\n", end)
    body = data[stop + 1 :] if stop >= 0 else b""
    order: str | None = None
    elements: list[_Element] = []
    lines = data[:end].decode("utf-8", errors="replace").splitlines()
    for number, line in enumerate(lines, 1):
        words = line.split()
        key = words[0].lower() if words else "comment"
        try:
            if key == "format":
                order = FORMATS[words[1]]
            elif key == "element":
                many = int(words[2])
                if many < 0 or words[1] in [other.name for other in elements]:
                    raise ValueError
                elements.append(_Element(words[1], many, []))
            elif key == "property":
                is_list = words[1] == "list"
                kinds = [TYPES[word] for word in words[1 + is_list : -1]]
                taken = [p.name for p in elements[-1].properties]
                if len(kinds) != 1 + is_list or words[-1] in taken or (is_list and kinds[0][0] == "f"):
                    raise ValueError
                elements[-1].properties.append(_Property(words[-1], kinds[-1], kinds[0] if is_list else None))
            elif key not in ("ply", "comment", "obj_info"):
                raise ValueError
        except (KeyError, IndexError, ValueError):
            raise InputError(
                f"{path.name}, line {number}: {line.strip()[:60]!r} is no line of the header of a PLY file"
            ) from None
    if order is None:
        raise InputError(f"{path.name}: the header has no 'format', which is one of {', '.join(FORMATS)}")
    return _Head(order, elements, body, len(lines) + 1)


# ---------------------------------------------------------------------- text


def _of_text(path: Path, head: _Head) -> tuple[np.ndarray, Polygons]:
    text = head.body.decode("utf-8", errors="replace")
    names = [[p.name for p in element.properties] for element in head.elements]
    if len(names) == 2 and names[0] == ["x", "y", "z"] and names[1][0] in LISTS_OF_CORNERS:
        known = triangles_at_once(text, head.elements[0].many, head.elements[1].many)
        if known and len(names[1]) == 1:
            return known[0], Polygons.of_rows(known[1])
    rows = [(line + head.lines, words) for line, words in word_rows(text, "\0")]
    start, points, facets = 0, np.empty((0, 3)), []
    for element in head.elements:
        if not element.properties:
            continue
        part = rows[start : start + element.many]
        if len(part) < element.many:
            raise InputError(
                f"{path.name} announces {element.many} of {element.name!r}, but ends after {len(part)}"
            )
        start += element.many
        if element.name == "vertex":
            at = [p.name for p in element.properties]
            picked = [at.index(name) for name in "xyz"]
            short = next((row for row in part if len(row[1]) < len(at)), None)
            if short:
                raise InputError(
                    f"{path.name}, line {short[0]}: a vertex has {len(at)} properties, not {len(short[1])}"
                )
            points = coordinates(path, [(line, [words[i] for i in picked]) for line, words in part])
        elif element.name == "face":
            facets = [(line, _face(path, line, words, element)) for line, words in part]
    if start < len(rows):
        line, words = rows[start]
        raise InputError(
            f"{path.name}, line {line}: {' '.join(words)[:60]!r} follows the last element that is announced"
        )
    return points, polygons_of(path, facets, len(points))


def _face(path: Path, line: int, words: list[str], element: _Element) -> list[int]:
    """The vertices in one row of words."""
    at, found = 0, []
    try:
        for one in element.properties:
            size = int(words[at]) if one.length else 1
            first = at + (one.length is not None)
            at = first + size
            if size < 0 or len(words) < at:
                raise IndexError
            if one.name in LISTS_OF_CORNERS:
                found = [int(word) for word in words[first:at]]
    except (ValueError, IndexError):
        raise InputError(
            f"{path.name}, line {line}: a face is the number of its vertices, then they, not "
            f"{' '.join(words)[:60]!r}"
        ) from None
    return found


# ---------------------------------------------------------------------- binary


def _of_bytes(path: Path, head: _Head) -> tuple[np.ndarray, Polygons]:
    at, points = 0, np.empty((0, 3))
    faces: list[np.ndarray] | np.ndarray = []
    for element in head.elements:
        if not element.properties:
            continue
        if any(p.length for p in element.properties):
            rings, at = _lists(path, head, element, at)
            if element.name == "face":
                faces = rings
            continue
        kind = np.dtype([(p.name, head.order + p.kind) for p in element.properties])
        rows = np.frombuffer(_bytes(path, head, at, kind.itemsize * element.many, element), kind)
        at += kind.itemsize * element.many
        if element.name == "vertex":
            points = np.stack([rows[name].astype(np.float64) for name in "xyz"], axis=1)
            finite_rows(path, points, "vertex")
    if at < len(head.body):
        raise InputError(
            f"{path.name}: {len(head.body) - at} bytes follow the last element that is announced"
        )
    return points, _checked(path, faces, len(points))


def _bytes(path: Path, head: _Head, at: int, size: int, element: _Element) -> bytes:
    if at + size > len(head.body):
        raise InputError(
            f"{path.name} announces {element.many} of {element.name!r}, but ends before they do: it is "
            "truncated"
        )
    return head.body[at : at + size]


def _lists(path: Path, head: _Head, element: _Element, at: int) -> tuple[list[np.ndarray] | np.ndarray, int]:
    """The lists of vertices of an element, and the place behind it; rows of one length all at once."""
    if element.many == 0:
        return [], at
    first, _ = _one(path, head, element, at)
    sizes = [len(values) if p.length else None for p, values in zip(element.properties, first)]
    fields: list[Any] = []
    for i, (one, size) in enumerate(zip(element.properties, sizes)):
        if one.length:
            fields.append((f"n{i}", head.order + one.length))
        fields.append((f"v{i}", head.order + one.kind, (1 if size is None else size,)))
    kind = np.dtype(fields)
    corner = next((i for i, p in enumerate(element.properties) if p.name in LISTS_OF_CORNERS and p.length), 0)
    if kind.itemsize * element.many <= len(head.body) - at:
        rows = np.frombuffer(head.body, kind, element.many, at)
        if all((rows[f"n{i}"] == size).all() for i, size in enumerate(sizes) if size is not None):
            return rows[f"v{corner}"].astype(np.int64), at + kind.itemsize * element.many
    found = []
    for _ in range(element.many):
        values, at = _one(path, head, element, at)
        found.append(values[corner].astype(np.int64))
    return found, at


def _one(path: Path, head: _Head, element: _Element, at: int) -> tuple[list[np.ndarray], int]:
    """The values of one row, and the place behind it."""
    values = []
    for one in element.properties:
        size = 1
        if one.length:
            kind = np.dtype(head.order + one.length)
            size = int(np.frombuffer(_bytes(path, head, at, kind.itemsize, element), kind)[0])
            at += kind.itemsize
        kind = np.dtype(head.order + one.kind)
        if size < 0:
            raise InputError(f"{path.name}: a {element.name!r} has a list of {size} entries; is it whole?")
        values.append(np.frombuffer(_bytes(path, head, at, size * kind.itemsize, element), kind))
        at += size * kind.itemsize
    return values, at


def _checked(path: Path, rings: list[np.ndarray] | np.ndarray, count: int) -> Polygons:
    """Polygons whose vertices must be 0, ..., count - 1."""
    if isinstance(rings, np.ndarray):
        sizes = np.full(len(rings), rings.shape[1])
        flat = rings.ravel()
    else:
        sizes = np.array([len(ring) for ring in rings], dtype=np.int64)
        flat = np.concatenate([np.empty(0, dtype=np.int64), *rings])
    ends = np.cumsum(sizes)
    if (sizes < 3).any():
        i = int(np.argmax(sizes < 3))
        raise InputError(f"{path.name}: face {i} has {sizes[i]} vertices, but needs 3")
    bad = np.flatnonzero((flat < 0) | (flat >= count))
    if len(bad):
        i = int(np.searchsorted(ends, bad[0], side="right"))
        raise InputError(
            f"{path.name}: face {i} has the vertex {flat[bad[0]]}; the file has {count} vertices, from 0"
        )
    return Polygons(flat.astype(np.int32), np.concatenate([[0], ends]), np.arange(len(sizes) + 1))
