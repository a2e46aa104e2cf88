"""Concentric shells around the ends of curves that meet at small angles."""

from __future__ import annotations

import numpy as np

from unstruct import Arc, Domain, check, refine


def bulging(p: np.ndarray, q: np.ndarray, sweep: float) -> Arc:
    """The arc from p to q that bulges to the left of the chord."""
    chord = q - p
    radius = np.linalg.norm(chord) / 2 / np.sin(sweep / 2)
    left = np.array([-chord[1], chord[0]]) / np.linalg.norm(chord)
    center = (p + q) / 2 - left * radius * np.cos(sweep / 2)
    return Arc(center, radius, np.arctan2(*(p - center)[::-1]), -sweep)


def test_two_curved_sides_become_a_small_angle() -> None:
    """Their chords form 100 degrees at first, their tangents 40; both sides are split on shells."""
    half, origin = np.radians(50), np.zeros(2)
    right, left = np.array([1.0, 0.0]), np.array([np.cos(2 * half), np.sin(2 * half)])
    middle = np.array([np.cos(half), np.sin(half)])
    points = np.array([origin, right, 2 * middle, left, 0.12 * middle, 0.1224 * middle])
    curves = {0: bulging(origin, right, np.pi / 3), 3: bulging(left, origin, np.pi / 3)}
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]], inner=[[4, 5]], curves=curves)
    mesh = refine(domain, min_angle=20)
    assert mesh.complete and check(mesh, domain=domain)
    ends = mesh.segments[(mesh.segments == 0).any(axis=1)]
    lengths = np.linalg.norm(mesh.points[ends[:, 0]] - mesh.points[ends[:, 1]], axis=1)
    assert len(lengths) == 2 and np.allclose(np.log2(lengths), np.round(np.log2(lengths)), atol=1e-9)
    assert mesh.counts["circumcenters"] < 25, "the two sides do not split each other (41 without shells)"
