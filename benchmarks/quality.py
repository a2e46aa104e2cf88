"""The quality of a mesh: angles, 2r/R, and how many of its edges have about the wanted length."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .regions import graded

BINS = 36  # the number of bins in the histogram of all angles, five degrees each


def measures(points: NDArray, triangles: NDArray, work: str, given: Any) -> dict[str, Any]:
    """The number of cells and, except for "constrained", measures of quality, by formulas of this file."""
    found: dict[str, Any] = {"cells": len(triangles)}
    if work == "constrained":
        return found
    corners = points[triangles]
    sides = np.stack([np.linalg.norm(corners[:, (k + 1) % 3] - corners[:, (k + 2) % 3], axis=1)
                      for k in range(3)])  # fmt: skip
    a, b, c = sides
    cosines = np.stack([(b * b + c * c - a * a) / (2 * b * c), (c * c + a * a - b * b) / (2 * c * a),
                        (a * a + b * b - c * c) / (2 * a * b)])  # fmt: skip
    angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    round_ = (b + c - a) * (c + a - b) * (a + b - c) / (a * b * c)  # 2 r / R
    found |= {
        "min_angle": round(float(angles.min()), 3),
        "max_angle": round(float(angles.max()), 3),
        "mean_2r_R": round(float(round_.mean()), 5),
        "min_2r_R": round(float(round_.min()), 4),
        "angles": np.histogram(angles, bins=BINS, range=(0.0, 180.0))[0].tolist(),
    }
    if work in ("uniform", "graded"):
        ends = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
        wanted = graded(points[ends].mean(axis=1)) if given is None else given
        off = np.abs(np.log2(length / wanted))
        found["conforming"] = round(float((off <= 0.5).mean()), 5)
    return found
