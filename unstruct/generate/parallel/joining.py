"""The meshes of parts as one mesh of the whole region: vertices are joined by number, not by place."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...connect.planar.extraction import named_sets
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..boundary.pairs import paired
from .dividing import Division

__all__ = ["joined"]


def joined(domain: Domain, division: Division, meshes: list[DomainMesh]) -> DomainMesh:
    """One mesh of the region from those of its parts."""
    if len(meshes) != len(division.parts):
        raise InputError(f"there are {len(division.parts)} parts, but {len(meshes)} meshes")
    numbers, points, origin = _vertices(division, meshes)
    cells, places = _cells(meshes, numbers)
    size = sum(mesh.size for mesh in meshes)
    part = np.empty(size, dtype=np.int32)
    markers: dict[str, Any] = {"part": part}
    if division.numbered:
        markers["region"] = np.empty(size, dtype=np.int32)
    for k, (mesh, place) in enumerate(zip(meshes, places)):
        part[place] = k
        if division.numbered:
            markers["region"][place] = _regions(mesh)
    segments, piece, span = _segments(division, meshes, numbers)
    facets = len(domain.facets)
    outer = int((piece < facets).sum())
    unrefined = np.concatenate([place[mesh.unrefined] for mesh, place in zip(meshes, places)])
    reasons = np.concatenate([mesh.reasons for mesh in meshes])
    order = np.argsort(unrefined, kind="stable")
    counts: Counter[str] = Counter()
    for mesh in meshes:
        counts.update(mesh.counts)
    many = np.array([mesh.size for mesh in meshes])
    mesh = DomainMesh(
        points, None, cells=cells, origin=origin,
        markers=markers | named_sets(segments, piece, outer, facets, domain.markers),
        regions=division.regions, unrefined=unrefined[order], reasons=reasons[order],
        counts=counts
        | {
            "parts": len(meshes),
            "coarse triangles": division.triangles,
            "interface edges": division.interface,
        },
        figures={
            "largest part": float(many.max() / many.mean()),
            "least coarse angle": float(np.degrees(np.arcsin(np.sqrt(min(division.sine, 1.0))))),
        },
        segments=segments, piece=piece, span=span,
    )  # fmt: skip
    return paired(domain, mesh)


def _vertices(
    division: Division, meshes: list[DomainMesh]
) -> tuple[list[NDArray[np.int64]], NDArray[np.float64], NDArray[np.int32]]:
    """The number in the whole of each vertex of each mesh; all points; their origins."""
    many = len(division.points)
    used = np.zeros(many, dtype=bool)
    for part, mesh in zip(division.parts, meshes):
        old = np.asarray(mesh.origin)
        used[part.vertices[old[old >= 0]]] = True
    place = np.cumsum(used) - 1
    first = int(used.sum())
    points, numbers = [division.points[used]], []
    for part, mesh in zip(division.parts, meshes):
        old = np.asarray(mesh.origin)
        number, new = np.empty(len(old), dtype=np.int64), old < 0
        number[~new] = place[part.vertices[old[~new]]]
        number[new] = first + np.arange(int(new.sum()))
        points.append(mesh.points[new])
        numbers.append(number)
        first += int(new.sum())
    known = np.full(many, -1, dtype=np.int32)
    known[: len(division.sampled.origin)] = division.sampled.origin
    origin = np.full(first, -1, dtype=np.int32)
    origin[: int(used.sum())] = known[used]
    return numbers, np.concatenate(points), origin


def _cells(
    meshes: list[DomainMesh], numbers: list[NDArray[np.int64]]
) -> tuple[dict[str, NDArray[np.int32]], list[NDArray[np.int64]]]:
    """All cells by kind, and the place among them of each cell of each mesh."""
    kinds = dict.fromkeys(kind for mesh in meshes for kind in mesh.cells)
    cells: dict[str, NDArray[np.int32]] = {}
    place: list[dict[str, NDArray[np.int64]]] = [{} for _ in meshes]
    start = 0
    for kind in kinds:
        blocks = []
        for k, mesh in enumerate(meshes):
            if kind in mesh.cells:
                blocks.append(numbers[k][np.asarray(mesh.cells[kind])].astype(np.int32))
                place[k][kind] = start + np.arange(len(blocks[-1]))
                start += len(blocks[-1])
        cells[kind] = np.concatenate(blocks)
    none = np.empty(0, dtype=np.int64)
    return cells, [np.concatenate([none, *(own[kind] for kind in m.cells)]) for m, own in zip(meshes, place)]


def _regions(mesh: DomainMesh) -> NDArray[np.int32]:
    """The number in the whole of each cell's region, which is its name in the part."""
    names = {number: int(name) for name, number in mesh.regions.items()}
    found, which = np.unique(np.asarray(mesh.markers["region"]), return_inverse=True)
    return np.array([names[r] for r in found.tolist()], dtype=np.int32)[which]


def _segments(
    division: Division, meshes: list[DomainMesh], numbers: list[NDArray[np.int64]]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
    """The subsegments of the domain's pieces, each once, in the order of the pieces."""
    sampled = division.sampled
    seen = np.zeros(len(sampled.piece), dtype=bool)
    ends, piece, span = [], [], []
    for part, mesh, number in zip(division.parts, meshes, numbers):
        row = part.rows[mesh.piece]
        rows = np.flatnonzero((row >= 0) & ~seen[np.maximum(row, 0)])
        row = row[rows]
        t0, t1 = sampled.span[row].T
        s = mesh.span[rows]
        ends.append(number[mesh.segments[rows]])
        piece.append(sampled.piece[row])
        span.append(t0[:, None] * (1.0 - s) + t1[:, None] * s)
        seen[row] = True
    every, along = np.concatenate(piece), np.concatenate(span)
    order = np.lexsort((along[:, 0], every))
    return np.concatenate(ends)[order].astype(np.int32), every[order].astype(np.int32), along[order]
