"""Layers of random bodies that stop or are squeezed, alone and with tetrahedra beyond them: always valid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, Layers, check
from unstruct.generate.prisms.prismatic_layers import prismatic_layers
from unstruct.generate.prisms.records import RAY_REASONS


def star_body(seed: int, least: float, size: float) -> Domain:
    """A ball whose points are moved along their radii at random: closed, and as sharp as it may be."""
    ball = Domain.ball(size=size)
    share = np.random.default_rng(seed).uniform(least, 1.2, len(ball.points))
    return Domain(ball.points * share[:, None], ball.facets, markers={"body": range(len(ball.facets))})


def columns_of(mesh) -> np.ndarray:
    """The edges of the walls, as rows of rays."""
    place = np.full(len(mesh.points), -1)
    vertex = mesh.steps["vertex"]
    place[vertex[vertex >= 0]] = np.flatnonzero(vertex >= 0)
    rows = place[np.asarray(mesh.markers["body"])[:, :3]]
    return np.concatenate([rows[:, [0, 1]], rows[:, [1, 2]], rows[:, [2, 0]]])


@given(
    st.integers(0, 10_000),
    st.sampled_from([0.2, 0.5, 0.9]),
    st.integers(1, 8),
    st.sampled_from(["squeeze", "stop"]),
    st.sampled_from(["wedge", "tetrahedron"]),
)
@settings(max_examples=12)
def test_random_bodies(seed: int, least: float, count: int, stop: str, cells: str) -> None:
    body = star_body(seed, least, 0.8)
    layers = Layers(first=0.02, growth=1.3, count=count)
    alone = prismatic_layers(body, layers=layers, stop=stop, cells=cells)
    assert check(alone), check(alone)
    domain = Domain.box((-3, -3, -3), (3, 3, 3)).with_holes(body)
    mesh = prismatic_layers(domain, 1.5, layers=layers, walls="body", stop=stop, cells=cells)
    report = check(mesh, domain=domain)
    assert report and not report.skipped and mesh.complete, report
    level = mesh.steps["level"]
    assert set(mesh.steps["reason"]) <= set(RAY_REASONS)
    assert (mesh.steps["reason"][level == count] != "step").all()
    if stop == "stop":
        rise = layers.cumulative()
        assert np.allclose(mesh.steps["height"], rise[level], rtol=1e-12)
        edges = columns_of(mesh)
        assert (np.abs(level[edges[:, 0]] - level[edges[:, 1]]) <= 1).all()
    else:
        assert set(level.tolist()) <= {0, count}


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
def test_two_bodies_leave_room_for_tetrahedra(cells: str) -> None:
    """Layers that would meet stop, or become thinner, with reasons; between the caps angles stay good."""
    one, two = Domain.ball(size=0.4), Domain.ball((2.4, 0.0, 0.0), size=0.4)
    bodies = [
        Domain(b.points, b.facets, markers={n: range(len(b.facets))}) for n, b in (("one", one), ("two", two))
    ]
    domain = Domain.box((-4, -4, -4), (6, 4, 4)).with_holes(*bodies)
    layers = Layers(first=0.01, growth=1.3, count=10)
    for stop in ("squeeze", "stop"):
        mesh = prismatic_layers(domain, 1.5, layers=layers, walls=["one", "two"], stop=stop, cells=cells)
        assert check(mesh, domain=domain) and mesh.complete
        limited = mesh.steps["reason"] == "crossing"
        assert limited.any() and (mesh.steps["place"][limited, 0] > 0.5).all()
        assert mesh.counts["limited: crossing"] == limited.sum()
        assert mesh.figures["least dihedral angle beyond"] > 10.0
        assert (mesh.counts["limited: step"] > 0) == (stop == "stop")


def test_all_layers_are_left_where_there_is_room() -> None:
    ball = Domain.ball(size=0.5)
    stop, squeeze = (
        prismatic_layers(ball, layers=Layers(first=0.01, count=4), stop=how) for how in ("stop", "squeeze")
    )
    assert np.array_equal(stop.points, squeeze.points)
    assert np.array_equal(stop.cells["wedge"], squeeze.cells["wedge"])
    assert (stop.steps["reason"] == "full").all() and stop.counts["rounds"] == 0


def test_layers_by_vertex_stop_each_by_its_own_heights() -> None:
    ball = Domain.ball(size=0.5)
    layers = Layers(first=lambda x: 0.01 * (1.5 + x[:, 0]), growth=1.2, count=5)
    mesh = prismatic_layers(ball, layers=layers, stop="stop")
    assert check(mesh) and (mesh.steps["level"] == 5).all()
    assert np.allclose(mesh.steps["height"], layers.cumulative(at=mesh.steps["place"])[:, -1])


def test_with_something_beyond_all_wedges_can_be_divided() -> None:
    """Found by a fuzz: a wedge was positive, but not its parts, and `check` left out its tests of overlap."""
    rng = np.random.default_rng(1036)
    ball = Domain.ball(size=rng.choice([0.5, 0.7, 1.0]))
    points = ball.points * rng.uniform(0.02, 1.2, len(ball.points))[:, None]
    body = Domain(points, ball.facets, markers={"body": range(len(ball.facets))})
    domain = Domain.box((-3, -3, -3), (3, 3, 3)).with_holes(body)
    layers = Layers(first=0.01, growth=1.3, count=int(rng.integers(1, 10)))
    mesh = prismatic_layers(domain, 1.0, layers=layers, walls="body")
    report = check(mesh, domain=domain)
    assert report and not report.skipped and set(mesh.cells) == {"wedge", "tetra"}
