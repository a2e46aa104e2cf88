"""Bodies written as STL, OFF, PLY, OBJ, or TetGen's ``.smesh`` and ``.poly``; what a format lacks is said.

Facets are written so that they point outward. Doubles have as many digits as restore them exactly.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....base.decimals import rows_as_text
from ....base.errors import InputError
from ....base.files import replacing, suffix_of
from ....base.telling import tell, tell_renamed
from ....geometry.inside_shell import even_odd_in_space, front_inside
from ....geometry.outline import Outline
from ....geometry.polygons import Polygons
from ...plane.poly import is_marker, is_value, numbers_for, tell_numbers
from ..cutting import Shell, cut
from ..faults import first_copies
from ..parts import Parts, parts_in_space
from .stl import STL_HEAD, STL_TRIANGLE

__all__ = ["BODY_FORMATS", "write_body"]

BODY_FORMATS = (".stl", ".off", ".ply", ".obj", ".smesh", ".poly")
WITH_BINARY = (".stl", ".ply")
HALVINGS_INWARD = 60  # of the distance of a point from the triangle beside which it must lie


def write_body(
    domain: Outline,
    shell: Shell,
    volumes: Mapping[str, float],
    seeds_of_holes: np.ndarray,
    path: Path,
    binary: bool | None,
) -> None:
    """Write a file in the format of its suffix; see `Domain.write`."""
    suffix = suffix_of(path)
    if suffix not in BODY_FORMATS:
        raise InputError(
            f"a body is written as {', '.join(BODY_FORMATS)}, not as {path.suffix!r}: change the file's name"
        )
    if binary is not None and suffix not in WITH_BINARY:
        raise InputError(f"{suffix} has no option 'binary'; it is for {' and '.join(WITH_BINARY)}")
    if suffix in (".smesh", ".poly"):
        content = _tetgen(domain, shell, volumes, seeds_of_holes, suffix == ".smesh")
    else:
        if len(domain.facets) == 0 and suffix == ".stl":
            raise InputError("a domain without facets cannot be written as .stl, which stores triangles only")
        content = {".stl": _stl, ".off": _off, ".ply": _ply, ".obj": _obj}[suffix](
            domain, shell, bool(binary)
        )
    with replacing(path) as beside:
        beside.write_bytes(content)
    if suffix not in (".smesh", ".poly"):
        _say_lost(domain, suffix, bool(binary))


def _say_lost(domain: Outline, suffix: str, binary: bool) -> None:
    lost = []
    if len(domain.inner) and not (suffix == ".obj" and (domain.inner.corners == 2).all()):
        lost.append("inner pieces")
    if domain.regions:
        lost.append("regions")
    if domain.markers and (suffix not in (".stl", ".obj") or binary):
        lost.append("markers")
    if suffix == ".stl" and len(domain.loose):
        lost.append("loose points")
    if lost:
        tell(f"not written: {', '.join(lost)}; {suffix} does not store them")


def _outward(shell: Shell) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.bool_]]:
    """The triangles of facets pointing outward, the piece of each, and which pieces are turned for that."""
    rows, piece = shell.bounding, shell.piece[shell.piece < shell.facets]
    turned = front_inside(shell.points, rows)
    flipped = np.zeros(shell.facets, dtype=bool)
    flipped[piece[turned]] = True
    return np.where(turned[:, None], rows[:, ::-1], rows).astype(np.int32), piece, flipped


def _faces(domain: Outline, shell: Shell) -> tuple[Polygons, NDArray[np.int32]]:
    """The facets without holes as they are, of others the triangles; pointing outward, with their pieces."""
    rows, piece, flipped = _outward(shell)
    facets = Polygons.of(domain.facets)
    if facets.triangles is not None:
        return Polygons.of_rows(rows), piece
    whole = np.diff(facets.first_ring) == 1
    first = np.searchsorted(piece, np.arange(len(facets) + 1))
    rings: list[Any] = []
    owner: list[int] = []
    for i in range(len(facets)):
        mine = [facets.rings(i)[0][:: -1 if flipped[i] else 1]] if whole[i] else rows[first[i] : first[i + 1]]
        rings += [[ring] for ring in mine]
        owner += [i] * len(mine)
    return Polygons.of_rings(rings), np.array(owner, dtype=np.int32)


def _last_names(domain: Outline) -> list[str]:
    """For each facet the last marker that names it, or nothing; a warning lists markers that lose facets."""
    names = np.full(len(domain.facets), "", dtype=object)
    for name, pieces in domain.markers.items():
        names[pieces[pieces < len(domain.facets)]] = name
    parts = ((name, pieces[pieces < len(domain.facets)]) for name, pieces in domain.markers.items())
    lost = [repr(name) for name, pieces in parts if (names[pieces] != name).any()]
    if lost:
        tell(f"not written completely: {', '.join(lost)}; .stl stores for each facet its last marker")
    return names.tolist()


def _labels(names: Iterable[str], between: str) -> dict[str, str]:
    """Names with ``between`` in the place of all blanks, made different by numbers."""
    first = {name: between.join(name.split()) or "unnamed" for name in names}
    taken = {name for name, label in first.items() if name == label}
    labels: dict[str, str] = {}
    for name, label in first.items():
        word, count = label, 2
        while word != name and word in taken:
            word, count = f"{label}_{count}", count + 1
        labels[name] = word
        taken.add(word)
    return labels


# ---------------------------------------------------------------------- formats of surfaces


def _stl(domain: Outline, shell: Shell, binary: bool) -> bytes:
    rows, piece, _ = _outward(shell)
    corners = shell.points[rows]
    sides = corners[:, 1:] / 2 - corners[:, :1] / 2
    sides = sides / np.abs(sides).max(axis=(1, 2), keepdims=True)  # so that products do not overflow
    normal = np.cross(sides[:, 0], sides[:, 1])
    length = np.linalg.norm(normal, axis=1)[:, None]
    normal = normal / np.where(length > 0.0, length, 1.0) + 0.0
    if binary:
        return _binary_stl(corners, normal)
    names = _last_names(domain)
    labels = _labels(domain.markers, " ")
    tell_renamed(labels, "names of solids in .stl are words with single spaces, and are all different")
    found = []
    place = np.searchsorted(piece, np.arange(len(names) + 1))
    runs: dict[str, list[NDArray[np.int64]]] = {}
    for i in range(len(names)):
        runs.setdefault(names[i], []).append(np.arange(place[i], place[i + 1]))
    for name, parts in runs.items():
        some = np.concatenate(parts)
        label = labels.get(name, "")
        values = np.concatenate([normal[some], corners[some].reshape(-1, 9)], axis=1)
        found.append(f"solid {label}".rstrip() + "\n")
        found += [
            f"facet normal {a!r} {b!r} {c!r}\nouter loop\nvertex {d!r} {e!r} {f!r}\n"
            f"vertex {g!r} {h!r} {i!r}\n"
            f"vertex {j!r} {k!r} {m!r}\nendloop\nendfacet\n"
            for a, b, c, d, e, f, g, h, i, j, k, m in values.tolist()
        ]
        found.append(f"endsolid {label}".rstrip() + "\n")
    return "".join(found).encode()


def _binary_stl(corners: np.ndarray, normal: np.ndarray) -> bytes:
    with np.errstate(over="ignore"):
        short = corners.astype(np.float32)
    if not np.isfinite(short).all():
        raise InputError("coordinates are too large for binary STL (single precision): write it as text")
    flat, small = corners.reshape(-1, 3), short.reshape(-1, 3).astype(np.float64)
    if len(np.unique(first_copies(flat))) != len(np.unique(first_copies(small))):
        raise InputError(
            "points become equal in binary STL, which has single precision: move the body towards the "
            "origin, or write it as text"
        )
    rows = np.zeros(len(corners), dtype=STL_TRIANGLE)
    rows["normal"], rows["corners"] = normal, short
    head = b"binary STL".ljust(STL_HEAD - 4, b" ") + len(rows).to_bytes(4, "little")
    return head + rows.tobytes()


def _lists(faces: Polygons, more: int = 0) -> bytes:
    """A line for each polygon: the number of its vertices, then they, plus ``more``."""
    triangles = faces.triangles
    if triangles is not None and len(triangles):
        return rows_as_text(np.column_stack([np.full(len(triangles), 3), triangles + more]))
    flat = (faces.vertices.astype(np.int64) + more).astype(str).tolist()
    at, lines = faces.ring_start.tolist(), []
    for first, last in pairwise(at):
        lines.append(f"{last - first} {' '.join(flat[first:last])}\n")
    return "".join(lines).encode()


def _off(domain: Outline, shell: Shell, binary: bool) -> bytes:
    faces, _ = _faces(domain, shell)
    head = f"OFF\n{len(domain.points)} {len(faces)} 0\n".encode()
    return head + rows_as_text(None, domain.points) + _lists(faces)


def _ply(domain: Outline, shell: Shell, binary: bool) -> bytes:
    faces, _ = _faces(domain, shell)
    large = int(np.diff(faces.ring_start).max(initial=0)) > 255
    head = [
        "ply", f"format {'binary_little_endian' if binary else 'ascii'} 1.0",
        f"element vertex {len(domain.points)}", *(f"property double {name}" for name in "xyz"),
        f"element face {len(faces)}", f"property list {'int' if large else 'uchar'} int vertex_indices",
        "end_header",
    ]  # fmt: skip
    start = ("\n".join(head) + "\n").encode()
    if not binary:
        return start + rows_as_text(None, domain.points) + _lists(faces)
    body = domain.points.astype("<f8").tobytes()
    size = "<i4" if large else "u1"
    triangles = faces.triangles
    if triangles is not None:
        rows = np.zeros(len(triangles), dtype=[("n", size), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, triangles
        return start + body + rows.tobytes()
    parts = [start, body]
    for i in range(len(faces)):
        ring = faces.rings(i)[0]
        parts += [np.array(len(ring), dtype=size).tobytes(), ring.astype("<i4").tobytes()]
    return b"".join(parts)


def _obj(domain: Outline, shell: Shell, binary: bool) -> bytes:
    faces, piece = _faces(domain, shell)
    lines = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in domain.points.tolist()]
    labels = _labels(domain.markers, "_")
    tell_renamed(labels, "names of groups in .obj have no spaces, and are all different")
    groups: list[list[str]] = [[] for _ in range(len(domain.facets))]
    for name, pieces in domain.markers.items():
        for i in pieces[pieces < len(domain.facets)].tolist():
            groups[i].append(labels[name])
    flat = (faces.vertices.astype(np.int64) + 1).astype(str).tolist()
    at = faces.ring_start.tolist()
    now: list[str] = []
    for first, last, i in zip(at, at[1:], piece.tolist()):
        if groups[i] != now:
            now = groups[i]
            lines.append(f"g {' '.join(now)}".rstrip() + "\n")
        lines.append(f"f {' '.join(flat[first:last])}\n")
    lines += [f"l {a + 1} {b + 1}\n" for a, b in shell.segments.tolist()]
    return "".join(lines).encode()


# ---------------------------------------------------------------------- TetGen


def _tetgen(
    domain: Outline, shell: Shell, volumes: Mapping[str, float], seeds_of_holes: np.ndarray, simple: bool
) -> bytes:
    marks = numbers_for(domain.markers, is_marker)
    mark = np.full(len(domain.pieces), "0", dtype=object)
    for name, pieces in domain.markers.items():
        mark[pieces] = marks[name]
    values = numbers_for(domain.regions, is_value)
    lines = [f"# marker {number}: {name!r}\n" for name, number in marks.items() if name != number]
    lines += [f"# region {number}: {name!r}\n" for name, number in values.items() if name != number]
    lines += [f"{len(domain.points)} 3 0 0\n"]
    lines += [f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(domain.points.tolist())]
    facets = list(_smesh_facets(domain, shell, mark) if simple else _poly_facets(domain, mark, shell))
    lines += [f"{len(facets)} 1\n", *facets]
    if len(domain.facets):
        holes = _hole_seeds(shell, parts_in_space(shell.points, shell.triangles))
    else:
        holes = seeds_of_holes.tolist()
    lines += [f"{len(holes)}\n", *(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(holes))]
    seeds = [(name, x) for name in domain.regions for x in domain.regions[name].tolist()]
    lines += [f"{len(seeds)}\n"]
    for row, (name, (x, y, z)) in enumerate(seeds):
        lines.append(f"{row} {x!r} {y!r} {z!r} {values[name]} {volumes.get(name, -1.0)!r}\n")
    tell_numbers(domain.markers, marks, values, ".smesh" if simple else ".poly")
    return "".join(lines).encode()


def _smesh_facets(domain: Outline, shell: Shell, mark: np.ndarray) -> Iterable[str]:
    """A line for each polygon; those with holes, which .smesh does not have, by their triangles."""
    pieces: Polygons = domain.pieces
    first = np.searchsorted(shell.piece, np.arange(len(pieces) + 1))
    for i in range(len(pieces)):
        rings = pieces.rings(i)
        for ring in rings if len(rings) == 1 else shell.triangles[first[i] : first[i + 1]]:
            yield f"{len(ring)} {' '.join(map(str, ring.tolist()))} {mark[i]}\n"


def _poly_facets(domain: Outline, mark: np.ndarray, shell: Shell) -> Iterable[str]:
    """The lines of each facet: its rings, and a seed in each of its holes."""
    pieces: Polygons = domain.pieces
    for i in range(len(pieces)):
        rings = pieces.rings(i)
        rows = "".join(f"{len(ring)} {' '.join(map(str, ring.tolist()))}\n" for ring in rings)
        seeds = [_inside_ring(shell.points, ring) for ring in rings[1:]]
        rows += "".join(f"{k} {x!r} {y!r} {z!r}\n" for k, (x, y, z) in enumerate(seeds))
        yield f"{len(rings)} {len(seeds)} {mark[i]}\n{rows}"


def _inside_ring(points: np.ndarray, ring: NDArray[np.int32]) -> list[float]:
    """A point inside of a ring: the middle of the largest of its triangles."""
    rows = cut(points, Polygons.of_rings([[ring]]), 0)[0].triangles
    corners = points[rows]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners[np.linalg.norm(normal, axis=1).argmax()].mean(axis=0).tolist()


def _hole_seeds(shell: Shell, parts: Parts) -> list[list[float]]:
    """A point in each enclosed part that is not inside of the body."""
    seeds = np.array([_inside_part(parts, number) for number in range(len(parts.walls))]).reshape(-1, 3)
    inside, _ = even_odd_in_space(shell.points, shell.bounding, seeds)
    return seeds[~inside].tolist()


def _inside_part(parts: Parts, number: int) -> np.ndarray:
    """A point in a part: beside the middle of one of its triangles, as far away as it can be."""
    corners = parts.points[parts.walls[number]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    order = np.argsort(-np.linalg.norm(normal, axis=1), kind="stable")
    for t in order.tolist():
        middle = corners[t].mean(axis=0)
        inward = -normal[t] / (np.linalg.norm(normal[t]) or 1.0)
        step = np.ptp(corners.reshape(-1, 3), axis=0).max()
        steps = step * 2.0 ** -np.arange(1, HALVINGS_INWARD)
        tries = middle + steps[:, None] * inward
        good = parts.locate(tries) == number
        for rows in parts.walls:
            if good.any():
                good[good] = ~even_odd_in_space(parts.points, rows, tries[good])[1]
        if good.any():
            return tries[int(np.argmax(good))]
    raise InputError(
        f"no point was found inside of a part near {corners[0, 0].tolist()}: is it a gap of 1e-16?"
    )
