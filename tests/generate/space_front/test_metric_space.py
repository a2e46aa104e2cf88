"""The front in space by a metric: valid meshes for any metric, lengths as wanted, surfaces, options."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

import unstruct
from unstruct import Domain, InputError, advancing_front, check, sizing
from unstruct.generate.space_front.metric_apex import ROOM_IN_STAR
from unstruct.generate.space_front.metric_measures import near_wall

AXES = np.eye(3)
C, S = 0.8, 0.6
TURNED = np.array([[C, S, 0], [-S * C, C * C, S], [S * S, -S * C, C]])
METRICS = {
    "flat": sizing.directional_space(AXES, [0.4, 0.4, 0.04]),
    "turned": sizing.directional_space(TURNED, [0.4, 0.2, 0.08]),
    "layer": sizing.directional_space(AXES, [0.3, 0.3, lambda x: 0.01 + 0.25 * x[:, 2]]),
    "needle": sizing.directional_space(AXES, [0.8, 0.1, 0.1]),
}


def quiet(*args: Any, **options: Any) -> unstruct.DomainMesh:
    """A mesh without warnings of what is not complete."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return advancing_front(*args, **options)


@pytest.mark.parametrize("name", METRICS)
def test_a_box(name: str) -> None:
    """Valid by exact signs, nothing too large, and nine of ten edges within sqrt 2 of what is wanted."""
    box, metric = Domain.box(), METRICS[name]
    mesh = advancing_front(box, metric)
    assert check(mesh, domain=box) and mesh.complete
    assert mesh.figures["edges within √2 after"] > 0.9
    assert mesh.figures["minimum metric quality after"] > 0.4 > mesh.figures["minimum metric quality before"]
    assert mesh.figures["longest edge after"] < 2.5
    assert np.array_equal(mesh.points, advancing_front(box, metric).points)
    again = advancing_front(box, metric, placement="sphere", order="oldest")
    assert check(again, domain=box)


def test_figures_by_brute_force() -> None:
    mesh, metric = advancing_front(Domain.box(), METRICS["turned"], finish=False), METRICS["turned"]
    edges = {tuple(sorted((c[i], c[j]))) for c in mesh.simplices.tolist() for i in range(4) for j in range(i)}
    lengths = []
    for i, j in edges:
        v = mesh.points[j] - mesh.points[i]
        assert metric.constant is not None
        lengths.append(np.sqrt(v @ metric.constant @ v))
    within = np.mean([0.5 <= length**2 <= 2 for length in lengths])
    assert mesh.figures["edges within √2"] == pytest.approx(within)
    assert mesh.figures["longest edge"] == pytest.approx(max(lengths))
    assert mesh.figures["tetrahedra"] == len(mesh.simplices)


def test_as_the_scaled_body() -> None:
    """With one metric everywhere the front does what it does in the scaled box without a metric."""
    body = Domain.ball(size=0.35)
    round_ = advancing_front(body, 0.35, split_boundary=False)
    for ratio in (1, 10):
        flat = Domain(body.points / [1, 1, ratio], body.facets)
        metric = sizing.directional_space(AXES, [0.35, 0.35, 0.35 / ratio])
        mesh = advancing_front(flat, metric, split_boundary=False)
        assert check(mesh, domain=flat) and mesh.complete
        assert 0.8 < len(mesh.simplices) / len(round_.simplices) < 1.25
        assert mesh.figures["mean metric quality after"] > 0.8


@pytest.mark.parametrize("finish", [False, True])
def test_a_ratio_of_a_thousand_is_valid(finish: bool) -> None:
    """Along the axes as good as any; turned, on surfaces that stay coarse, valid and reported."""
    plate = Domain.box((0, 0, 0), (1, 1, 0.01))
    thin = sizing.directional_space(AXES, [0.5, 0.5, 0.0005])
    mesh = quiet(plate, thin, finish=finish)
    assert check(mesh, domain=plate)
    assert mesh.figures["edges within √2 after" if finish else "edges within √2"] > 0.85
    turned = sizing.directional_space(TURNED, [0.5, 0.5, 0.0005])
    for body in (Domain.box(), Domain.ball(size=0.5)):
        mesh = quiet(body, turned, split_boundary=False, finish=finish)
        assert check(mesh, domain=body) and len(mesh.unrefined) > 0


def test_a_metric_that_jumps() -> None:
    """Validity and the end of the front need no smoothness."""

    def jumping(x: np.ndarray) -> np.ndarray:
        odd = (np.floor(4 * x).sum(axis=1) % 2)[:, None, None]
        return odd * np.diag([4.0, 4.0, 400.0]) + (1 - odd) * np.diag([400.0, 4.0, 4.0])

    box = Domain.box()
    mesh = quiet(box, sizing.SpaceMetric(jumping))
    assert check(mesh, domain=box)


def test_room_around_points() -> None:
    """No two vertices are nearer than ROOM_IN_STAR times the least length, before finishing."""
    mesh = advancing_front(Domain.box(), METRICS["layer"], finish=False)
    nearest = cKDTree(mesh.points).query(mesh.points, 2)[0][:, 1]
    assert nearest.min() >= ROOM_IN_STAR * 0.01


def test_regions_and_walls() -> None:
    box = Domain.box((0, 0, 0), (1, 1, 1))
    wall = np.array([[0.5, 0.2, 0.2], [0.5, 0.8, 0.2], [0.5, 0.8, 0.8], [0.5, 0.2, 0.8]])
    n = len(box.points)
    body = Domain(
        np.concatenate([box.points, wall]), list(box.facets), inner=[[n, n + 1, n + 2, n + 3]],
        regions={"all": (0.1, 0.1, 0.1)},
    )  # fmt: skip
    mesh = advancing_front(body, METRICS["flat"])
    assert check(mesh, domain=body)
    assert mesh.figures["edges within √2 after"] > 0.85


def test_record_and_budget() -> None:
    box = Domain.box()
    mesh = advancing_front(box, METRICS["needle"], finish=False, history=True)
    assert len(mesh.steps["reason"]) == len(mesh.simplices)
    rows = np.hstack([mesh.steps["face"], mesh.steps["apex"][:, None]])
    assert (np.sort(rows, axis=1) == np.sort(mesh.simplices, axis=1)).all()
    new = mesh.steps["reason"] == "new point"
    assert mesh.points[mesh.steps["apex"][new]] == pytest.approx(mesh.steps["ideal"][new])
    assert (mesh.steps["size"][new] <= 1.4 / 0.5).all()
    ball = Domain.ball(size=0.3)
    metric = sizing.directional_space(TURNED, [0.3, 0.2, 0.2])
    short = quiet(ball, metric, split_boundary=False, budget=9)
    assert check(short, domain=ball) and not short.complete
    assert len(short.points) == len(ball.points) + 9 and set(short.reasons.tolist()) == {"budget"}


def test_wrong_options() -> None:
    box, metric = Domain.box(), METRICS["flat"]
    for options, words in (
        ({"method": "classical"}, "delaunay"),
        ({"order": "smallest"}, "widest"),
        ({"placement": "angle"}, "equal sides"),
        ({"placement": lambda *rest: None}, "equal sides"),
        ({"split_boundary": "inner"}, "plane"),
        ({"budget": -1}, "budget"),
    ):
        with pytest.raises(InputError, match=words):
            advancing_front(box, metric, **options)
    with pytest.raises(InputError, match="SpaceMetric"):
        advancing_front(box, sizing.directional([1, 0], 0.1, 0.2))
    with pytest.raises(InputError, match="whole body"):
        advancing_front(box, {None: metric})
    with pytest.raises(InputError):
        advancing_front(Domain.rectangle(), metric)
    with pytest.raises(InputError):
        unstruct.tetrahedralize(box, metric)


def test_distance_from_a_triangle() -> None:
    """Against the nearest of many points of the triangle."""
    rng = np.random.default_rng(4)
    u, v = rng.random((2, 20000))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    for _ in range(100):
        corners = rng.normal(size=(4, 3))
        x = corners[0] + u[:, None] * (corners[1] - corners[0]) + v[:, None] * (corners[2] - corners[0])
        wanted = np.linalg.norm(x, axis=1).min()
        assert wanted - 0.1 <= np.sqrt(near_wall(corners)) <= wanted + 1e-9
