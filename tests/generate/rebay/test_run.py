"""Runs of `voronoi_segment` where pieces must stay as they are."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, UnstructError, check, voronoi_segment
from unstruct.generate.rebay.run import VoronoiSegmentRun

# Refinement for the angle leaves triangles waiting here; the queue was then filled a second time, so that a
# triangle stood in it twice and its turn never ended.
WAITING = [
    [0.55, 0.37], [0.45, 0.39], [0.38, 0.6], [0.07, 0.81], [-0.75, 0.61],
    [-0.46, 0.2], [-0.75, 0.1], [-0.69, -0.39], [-0.05, -0.5], [0.09, -0.29],
]  # fmt: skip


def held(ring: list[list[float]]) -> Domain:
    return Domain.polygon(ring).spaced({i: 1 for i in range(len(ring))})


def test_the_queue_is_empty_before_it_is_filled(monkeypatch: pytest.MonkeyPatch) -> None:
    start = VoronoiSegmentRun.start

    def checked(self: VoronoiSegmentRun, moved: np.ndarray) -> None:
        assert (self.gates < 0).all()
        start(self, moved)

    monkeypatch.setattr(VoronoiSegmentRun, "start", checked)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = voronoi_segment(held(WAITING), 0.15)
    assert check(mesh, domain=held(WAITING), delaunay="constrained")


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_finishing_never_spoils_what_stays(seed: int) -> None:
    """Where pieces stay, refinement for the angle may fail; the best state counts, not the last one."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(5, 12))
    t, r = np.sort(rng.uniform(0, 2 * np.pi, n)), rng.uniform(0.3, 1.0, n)
    try:
        domain = held(np.round(np.column_stack([r * np.cos(t), r * np.sin(t)]), 2).tolist())
    except UnstructError:
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        raw, mesh = voronoi_segment(domain, 0.15, finish=False), voronoi_segment(domain, 0.15)
    assert check(mesh, domain=domain, delaunay="constrained")
    assert mesh.quality("min_angle").min() >= raw.quality("min_angle").min() - 1e-9
    assert mesh.figures["minimum angle after"] == pytest.approx(mesh.quality("min_angle").min())
    if not mesh.complete:
        assert len(mesh.reasons) == len(mesh.unrefined)
