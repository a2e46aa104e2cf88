"""Distances of points to the true pieces of an outline, and the nearest points on them. See chapter 2.6d."""

from __future__ import annotations

import numpy as np

from .curves import Arc
from .outline import Outline

__all__ = ["distance_to_line", "distance_to_piece"]


def distance_to_line(a: np.ndarray, b: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of points (k, 2) to the lines through a and b, and the parameters of the nearest points.

    Parameters are cut off at the ends, 0 and 1. ``a`` and ``b`` may have one row for each point.
    """
    d = b - a
    longest = np.abs(d).max(axis=-1, keepdims=True)
    u, v = d / longest, (x - a) / longest  # so that large coordinates do not overflow
    squared = u[..., 0] * u[..., 0] + u[..., 1] * u[..., 1]
    t = np.clip((v[..., 0] * u[..., 0] + v[..., 1] * u[..., 1]) / squared, 0, 1)
    across = np.abs(v[..., 0] * u[..., 1] - v[..., 1] * u[..., 0])
    return across / np.sqrt(squared) * longest[..., 0], t


def distance_to_piece(outline: Outline, piece: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of points (k, 2) to a true piece and the parameters of the nearest points on it."""
    a, b = outline.points[outline.pieces[piece]]
    curve = outline.curves.get(piece)
    if curve is None:
        return distance_to_line(a, b, x)
    if isinstance(curve, Arc):
        away = x - curve.center
        turn = np.arctan2(away[:, 1], away[:, 0]) - curve.start
        t = np.mod(turn if curve.sweep > 0 else -turn, 2 * np.pi) / abs(curve.sweep)
        full = 2 * np.pi / abs(curve.sweep)
        # Half of the rest of the circle belongs to each end of the arc.
        t = np.where(t > (1 + full) / 2, t - full, t)
        return np.abs(np.hypot(away[:, 0], away[:, 1]) - curve.radius), t
    return _distance_to_curve(outline, piece, x)


def _distance_to_curve(outline: Outline, piece: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Take the nearest of many samples, search by thirds around it, then refine by tangent steps."""
    from scipy.spatial import cKDTree

    samples = np.linspace(0, 1, 2049)
    there = outline.at(piece, samples)
    # squares are taken of distances in a unit in which they are neither below nor above all doubles
    shift = -int(np.frexp(max(np.abs(there).max(), np.abs(x).max(initial=0.0)))[1])

    def at(t: np.ndarray) -> np.ndarray:
        return np.ldexp(outline.at(piece, t), shift)

    x = np.ldexp(x, shift)
    nearest = cKDTree(np.ldexp(there, shift)).query(x)[1]
    low, high = samples[np.maximum(nearest - 1, 0)], samples[np.minimum(nearest + 1, 2048)]
    for _ in range(40):
        left, right = low + (high - low) / 3, high - (high - low) / 3
        at_left = ((at(left) - x) ** 2).sum(axis=1)
        at_right = ((at(right) - x) ** 2).sum(axis=1)
        low, high = np.where(at_left > at_right, left, low), np.where(at_left > at_right, high, right)
    t = (low + high) / 2
    # Comparing squares finds only half of the digits of t; steps along the tangent find the rest.
    before, after = np.maximum(t - 1e-4, 0), np.minimum(t + 1e-4, 1)
    tangent = (at(after) - at(before)) / (after - before)[:, None]
    for _ in range(8):
        along = ((at(t) - x) * tangent).sum(axis=1) / (tangent**2).sum(axis=1)
        t = np.clip(t - along, 0, 1)
    return np.ldexp(np.hypot(*(at(t) - x).T), -shift), t
