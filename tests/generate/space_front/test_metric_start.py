"""Where the front in a metric starts: stretched surfaces are recovered at once, counts are known before."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import unstruct
from unstruct import Domain, InputError, advancing_front, check, sizing
from unstruct.generate.space_front import metric_start
from unstruct.generate.space_front.metric_count import expected_cells
from unstruct.generate.space_front.metric_start import recovered_in_metric
from unstruct.generate.volume_points.run import recovered
from unstruct.predicates.batch import orient
from unstruct.sizing.space_metric_table import leaves_of

C, S = 0.8, 0.6
TURNED = np.array([[C, S, 0], [-S * C, C * C, S], [S * S, -S * C, C]])
AXES = np.eye(3)


@pytest.fixture
def recoveries(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Where surfaces are recovered: in the coordinates of their metric, or in space, which takes minutes."""
    seen: list[str] = []

    def noted(domain: Domain, progress: bool, *image: Any) -> Any:
        seen.append("metric" if image else "space")
        return recovered(domain, progress, *image)

    monkeypatch.setattr(metric_start, "recovered", noted)
    return seen


@pytest.mark.parametrize("ratio", [30, 100])
def test_turned_surfaces_are_recovered(ratio: int, recoveries: list[str]) -> None:
    """It took minutes, and points in edges and facets that did not leave again."""
    box, metric = Domain.box(), sizing.directional_space(TURNED, [0.5, 0.5, 0.5 / ratio])
    mesh = advancing_front(box, metric)
    assert recoveries == ["metric"]
    assert check(mesh, domain=box) and mesh.complete
    assert mesh.counts["missing segments"] == mesh.counts["added on pieces"] == 0
    assert mesh.figures["edges within √2 after"] > 0.93
    assert mesh.figures["mean metric quality after"] > 0.8


def test_flat_cells_of_a_grid_are_not_turned_over(recoveries: list[str]) -> None:
    """Four points of a box at ratio 1000 are on one circle of the image; it was given up for them."""
    box, metric = Domain.box(), sizing.directional_space(AXES, [0.5, 0.5, 0.0005])
    mesh = advancing_front(box, metric, finish=False)
    assert recoveries in (["metric"], ["metric", "metric"])
    assert check(mesh, domain=box) and mesh.complete
    assert mesh.figures["edges within √2"] > 0.93


def test_cells_are_valid_in_space() -> None:
    """The vertices are those given, bit for bit, and all cells inside are positive, whatever the metric."""
    ball = Domain.ball(size=0.5)
    for lengths in ([0.5, 0.5, 0.5], [0.5, 0.5, 0.01], [0.5, 0.01, 0.01]):
        cells, found = recovered_in_metric(ball, sizing.directional_space(TURNED, lengths))
        assert found.complete
        points = cells.points()
        assert np.array_equal(points[: len(ball.points)], ball.points)
        corners = cells.vertex[: 4 * cells.slots].reshape(-1, 4)[cells.inside_slots()]
        assert (orient(points[corners]) > 0).all()
        volume = np.linalg.det(points[corners[:, 1:]] - points[corners[:, :1]]).sum() / 6
        assert volume == pytest.approx(ball.volume)


def slow_count(domain: Domain, metric: sizing.SpaceMetric, parts: int) -> float:
    """The integral of sqrt(det M) by the midpoints of a fine grid, over the volume of a cell."""
    low, high = domain.bounds
    axis = (np.arange(parts) + 0.5) / parts
    x = low + np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3) * (high - low)
    x = x[domain.contains(x)]
    density = np.sqrt(np.linalg.det(metric.at(x)))
    return float(density.sum() * np.prod((high - low) / parts) * 6 * np.sqrt(2))


def test_expected_cells() -> None:
    layer = sizing.directional_space(TURNED, [0.3, 0.2, lambda x: 0.05 + 0.3 * np.abs(x[:, 2])])
    thin = Domain.torus(size=0.3)
    for domain in (Domain.box(), Domain.ball(size=0.2), thin):
        count = expected_cells(domain, layer.table(*domain.bounds))
        assert count == pytest.approx(slow_count(domain, layer, 60), rel=0.05)
    box = Domain.box((0, 0, 0), (1, 2, 3))
    flat = sizing.directional_space(TURNED, [0.4, 0.3, 0.1])
    exact = 6 * 6 * np.sqrt(2) / (0.4 * 0.3 * 0.1)
    assert expected_cells(box, flat.table(*box.bounds)) == pytest.approx(exact, rel=1e-9)
    sheet = Domain.box((0, 0, 0), (1, 1, 1)).with_holes(Domain.box((1e-6,) * 3, (1 - 1e-6,) * 3))
    found = expected_cells(sheet, layer.table(*sheet.bounds))  # no place of those looked at is within
    assert found == pytest.approx(6 * np.sqrt(2) * sheet.volume / 0.3 / 0.2 / 0.15, rel=0.6)


def test_leaves_fill_the_box() -> None:
    layer = sizing.directional_space(AXES, [0.3, 0.3, lambda x: 0.01 + 0.2 * x[:, 2] ** 2])
    low, side = leaves_of(layer.table([0, 0, -1], [1, 2, 1]))
    assert len(low) > 512 and side.prod(axis=1).sum() == pytest.approx(4.0)
    corner = np.unique(low, axis=0)
    assert len(corner) == len(low)


def test_too_many_are_refused_before_work(recoveries: list[str]) -> None:
    box = Domain.box()
    with pytest.raises(InputError, match=r"tetrahedra.*budget.*larger lengths"):
        advancing_front(box, sizing.directional_space(TURNED, [1e-3, 1e-3, 1e-5]))
    with pytest.raises(InputError, match="more than the 100 of the budget"):
        advancing_front(box, sizing.directional_space(AXES, [0.1, 0.1, 0.1]), budget=100)
    assert not recoveries
    mesh = advancing_front(box, sizing.directional_space(AXES, [0.3, 0.3, 0.1]))
    assert 0.5 < len(mesh.simplices) / mesh.figures["tetrahedra expected"] < 2.0
    assert isinstance(mesh, unstruct.DomainMesh)
