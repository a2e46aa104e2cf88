"""The quality of tetrahedra, and whether the given surface is theirs, by formulas of this file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .volume_meshers import Given

BINS = 36  # of the histogram of dihedral angles, five degrees each
SHARP = 20.0  # cells with a smaller dihedral angle are counted
SIDES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # outward faces of a positive cell
EDGES = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]


def dihedral(x: NDArray) -> NDArray:
    """The six dihedral angles of each tetrahedron (m, 4, 3), in degrees; 0 and 180 for those that are flat."""
    normal = np.cross(x[:, SIDES[:, 1]] - x[:, SIDES[:, 0]], x[:, SIDES[:, 2]] - x[:, SIDES[:, 0]])
    length = np.linalg.norm(normal, axis=2, keepdims=True)
    normal = normal / np.maximum(length, 1e-300)
    cosine = np.stack([-(normal[:, i] * normal[:, j]).sum(axis=1) for i, j in EDGES], axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def roundness(x: NDArray) -> NDArray:
    """3 r / R of each tetrahedron (m, 4, 3): the inradius by the circumradius, 1 if it is regular."""
    a, b, c = (x[:, k] - x[:, 0] for k in (1, 2, 3))
    six = np.abs((a * np.cross(b, c)).sum(axis=1))
    square = [(v * v).sum(axis=1)[:, None] for v in (a, b, c)]
    center = square[0] * np.cross(b, c) + square[1] * np.cross(c, a) + square[2] * np.cross(a, b)
    area = np.linalg.norm(
        np.cross(x[:, SIDES[:, 1]] - x[:, SIDES[:, 0]], x[:, SIDES[:, 2]] - x[:, SIDES[:, 0]]), axis=2
    ).sum(axis=1)  # twice the surface
    return 6.0 * six * six / np.maximum(area * np.linalg.norm(center, axis=1), 1e-300)


def surface(points: NDArray, cells: NDArray, given: Given) -> dict[str, Any]:
    """Whether the faces at the border are the given triangles, and how many vertices there are new."""
    known = {row.tobytes(): i for i, row in enumerate(np.asarray(given.points) + 0.0)}
    number = np.array([known.get(row.tobytes(), -1) for row in np.ascontiguousarray(points) + 0.0])
    faces = cells[:, SIDES].reshape(-1, 3)
    rows, times = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
    border = rows[times == 1]
    new = np.unique(border[number[border] < 0])
    mapped = np.unique(np.sort(number[border], axis=1), axis=0)
    wanted = np.unique(np.sort(given.triangles, axis=1), axis=0)
    return {"exact": bool(np.array_equal(mapped, wanted)), "steiner": len(new)}


def measures(points: NDArray, cells: NDArray, work: str, given: Given) -> dict[str, Any]:
    """Numbers that tell how good a mesh is, and whether it is one of the given body."""
    x = points[cells]
    six = np.einsum("ij,ij->i", x[:, 1] - x[:, 0], np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 0]))
    if six.sum() < 0:  # some count vertices the other way round
        cells = cells[:, [0, 2, 1, 3]]
        x, six = points[cells], -six
    corners = np.asarray(given.points)[given.triangles]
    enclosed = (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum()
    angle = dihedral(x)
    least = angle.min(axis=1)
    return {
        "cells": len(cells),
        "valid": bool((six >= 0).all() and abs(six.sum() - enclosed) <= 1e-9 * abs(enclosed)),
        "min_dihedral": round(float(least.min()), 3),
        "max_dihedral": round(float(angle.max()), 3),
        "sharp": round(float((least < SHARP).mean()), 7),
        "mean_3r_R": round(float(roundness(x).mean()), 5),
        "angles": np.histogram(angle, bins=BINS, range=(0.0, 180.0))[0].tolist(),
        **surface(points, cells, given),
    }
