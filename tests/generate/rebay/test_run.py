"""Runs of `voronoi_segment`: where pieces must stay as they are, and where vertices are renumbered."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, DomainMesh, UnstructError, advancing_front, check, voronoi_segment
from unstruct.generate.rebay import run
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


# --- large meshes, whose vertices are renumbered before finishing ------------------------------------


def varied(x: np.ndarray) -> np.ndarray:
    return 0.02 + 0.1 * np.hypot(x[:, 0], x[:, 1])


@pytest.mark.parametrize("mesher", [voronoi_segment, advancing_front])
def test_the_record_knows_vertices_that_were_renumbered(
    mesher: Callable[..., DomainMesh], monkeypatch: pytest.MonkeyPatch
) -> None:
    domain = Domain.polygon([(-1, -1), (1, -1), (1.3, 1), (0, 0.4), (-1, 1)])
    usual = mesher(domain, varied, history=True)
    monkeypatch.setattr(run, "RENUMBERED_FROM", 0)
    mesh = mesher(domain, varied, history=True)
    assert check(mesh, domain=domain, delaunay="constrained")
    # Finishing goes another way, by a part of an edge at the most; what was made before it is the same.
    name = "vertex" if mesher is voronoi_segment else "apex"
    made = min(len(usual.steps[name]), len(mesh.steps[name]))
    old, new = usual.steps[name][:made], mesh.steps[name][:made]
    both = (old >= 0) & (new >= 0)
    assert made > 300 and both.sum() > 0.98 * made
    far = np.linalg.norm(usual.points[old[both]] - mesh.points[new[both]], axis=1)
    assert (far < varied(mesh.points[new[both]])).all() and (old != new).any()
    place = "point" if mesher is voronoi_segment else "ideal"
    np.testing.assert_array_equal(usual.steps[place][: made // 2], mesh.steps[place][: made // 2])
    assert mesh.quality("min_angle").min() > 25


def test_points_added_after_renumbering_are_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "RENUMBERED_FROM", 0)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        t = np.sort(rng.uniform(0, 2 * np.pi, 9))
        r = rng.uniform(0.3, 1.0, 9)
        domain = Domain.polygon(np.column_stack([r * np.cos(t), r * np.sin(t)]))
        mesh = voronoi_segment(domain, varied, history=True)
        steps = mesh.steps
        # the two ends of the edge that a point was made for are near it
        seen = (steps["vertex"] >= 0) & (steps["edge"] >= 0).all(axis=1)
        x = mesh.points[steps["vertex"][seen]]
        for end in steps["edge"][seen].T:
            assert (np.linalg.norm(mesh.points[end] - x, axis=1) < 4 * varied(x)).all()
