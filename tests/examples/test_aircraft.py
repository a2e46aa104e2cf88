"""The wing, the body with a wing, and the duct: closed, outward, named, on their planes."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, examples

from .test_surfaces import shape, turned_alike


def corners(domain: Domain, name: str) -> np.ndarray:
    return domain.points[np.asarray(domain.facets)[domain.markers[name]]]


def test_wing() -> None:
    wing = examples.wing(0.08)
    length, angle, volume = shape(wing)
    assert turned_alike(wing) and angle.min() > 10 and np.quantile(angle.min(axis=0), 0.01) > 30
    assert length.max() < 2 * 0.08
    # the mean of the squares of the chords, over the span, times the area of a section, 0.685 t
    assert volume == pytest.approx(3 * (1 + 0.5 + 0.25) / 3 * 0.685 * 0.14, rel=0.04)
    assert set(wing.markers) == {"wing", "tip"}
    assert (np.abs(corners(wing, "tip")[..., 1]) == 1.5).all()
    assert len(wing.markers["wing"]) + len(wing.markers["tip"]) == len(wing.facets)
    rows = np.asarray(wing.facets)
    x = wing.points[rows]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    edges: dict[tuple[int, ...], list[int]] = {}
    for i, (p, q, r) in enumerate(rows.tolist()):
        for edge in ((p, q), (q, r), (r, p)):
            edges.setdefault(tuple(sorted(edge)), []).append(i)
    unit = normal / np.linalg.norm(normal, axis=1)[:, None]
    turn = np.array([(unit[i] * unit[j]).sum() for i, j in edges.values()])
    assert (turn < np.cos(np.radians(150))).sum() > 10, "the trailing edge is sharp"


def test_wing_body() -> None:
    domain = examples.wing_body(0.08)
    length, angle, volume = shape(domain)
    assert turned_alike(domain) and angle.min() > 10 and np.quantile(angle.min(axis=0), 0.01) > 27
    assert set(domain.markers) == {"wing", "tip", "body"} and 0.48 < volume < 0.55
    assert length.max() < 3.5 * 0.08
    x = corners(domain, "body")
    assert (np.linalg.norm(x[..., 1:], axis=-1) < 0.22 + 1e-12).all()
    assert len(set(map(tuple, domain.points)) ^ set(map(tuple, domain.points * [1, -1, 1] + 0.0))) == 0


def test_duct() -> None:
    tube = examples.duct(0.2)
    _, angle, volume = shape(tube)
    assert turned_alike(tube) and angle.min() > 25
    assert volume == pytest.approx(np.pi * 0.25 * (3 + 1.5 * np.pi / 2), rel=0.05)
    assert (corners(tube, "inlet")[..., 2] == 0).all()
    assert len(np.unique(corners(tube, "outlet")[..., 0])) == 1


def test_refused() -> None:
    with pytest.raises(InputError, match=r"size = 0.5 must be at most 0.15"):
        examples.wing(0.5)
    with pytest.raises(InputError, match=r"radius = 2 must be less than bend = 1.5"):
        examples.duct(radius=2.0)
