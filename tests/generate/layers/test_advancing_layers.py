"""Layers along walls: valid by `check`, with all names; stops, open ends, wakes, nasty regions."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from layer_cases import Case, judged, random_case

from unstruct import (
    Arc,
    Bezier,
    Domain,
    DomainMesh,
    InputError,
    Layers,
    advancing_layers,
    check,
    examples,
    sizing,
    voronoi_segment,
)

THIN = Layers(first=2e-3, growth=1.25)
BOX = [[0, 0], [3, 0], [3, 1], [0, 1]]


def meshed(domain: Domain, size: Any, layers: Layers = THIN, **options: Any) -> DomainMesh:
    """The mesh, which must be valid, with cells in layers exactly where rays have levels."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = advancing_layers(domain, size, layers=layers, **options)
    report = check(mesh, domain=domain)
    assert report, report
    steps = mesh.steps
    assert steps is not None
    assert (mesh.jacobian_signs() > 0).all()
    assert mesh.counts["layer cells"] == (steps["cell_layer"] > 0).sum()
    assert (steps["cell_layer"] > 0).any() == (steps["level"] > 0).any()
    assert steps["cell_layer"].max() == steps["level"].max()
    return mesh


# ---------------------------------------------------------------------- real regions


@pytest.fixture(scope="module")
def wing() -> tuple[Domain, Any]:
    domain = examples.wing_with_flap()
    sampled = domain.sampled(0.01)
    walls = np.concatenate([domain.markers["upper"], domain.markers["lower"]])
    sources = sampled.points[sampled.ends[np.isin(sampled.piece, walls)]]
    return domain, sizing.sources(sources, 0.01, growth=0.25, far=1.0)


@pytest.mark.parametrize("first", [1e-3, 1e-5])
@pytest.mark.parametrize("stop", ["nearest", "spring"])
def test_wing_with_flap(wing: tuple[Domain, Any], first: float, stop: str) -> None:
    domain, size = wing
    layers = Layers(first=first, growth=1.2)
    mesh = meshed(domain, size, layers, walls=["upper", "lower"], stop=stop)
    assert mesh.counts["refused"] == 0
    assert mesh.figures["largest angle"] <= 120.0
    assert mesh.figures["minimum angle of the rest"] >= 30.0
    area = mesh.volumes
    x = mesh.points[mesh.simplices]
    a, b, c = (np.hypot(*(x[:, k] - x[:, k - 1]).T) for k in range(3))
    round_ = 16 * area**2 / ((a + b + c) * a * b * c)
    assert round_[mesh.steps["cell_layer"] == 0].mean() >= 0.96
    t, i = np.nonzero(mesh.neighbors >= 0)
    ratio = area[t] / area[mesh.neighbors[t, i]]
    assert np.quantile(np.maximum(ratio, 1 / ratio), 0.99) <= 1.9
    # The first height is met along the normal, and there is no more than growth between layers.
    assert np.median(mesh.steps["level"]) >= (10 if first == 1e-3 else 35)


def test_quadrilaterals_are_those_of_the_triangles(wing: tuple[Domain, Any]) -> None:
    domain, size = wing
    layers = Layers(first=1e-3, growth=1.2)
    mixed = meshed(domain, size, layers, walls=["upper", "lower"], cells="quad")
    plain = meshed(domain, size, layers, walls=["upper", "lower"])
    assert set(mixed.cells) == {"triangle", "quad"}
    assert mixed.size + len(mixed.cells["quad"]) == plain.size
    np.testing.assert_array_equal(mixed.points, plain.points)
    assert (mixed.quality("max_angle")[len(mixed.cells["triangle"]) :] < 180).all()


# ---------------------------------------------------------------------- open walls, wakes, regions


def test_open_walls_slide_along_what_they_meet() -> None:
    points = [[0, 0], [1, 0], [1.2, 0.2], [1.5, 0.2], [1.7, 0], [3, 0], [3.2, 1], [0, 1]]
    domain = Domain(
        points,
        [[i, (i + 1) % 8] for i in range(8)],
        markers={"bottom": [0, 1, 2, 3, 4], "top": [6], "out": [5]},
    )
    mesh = meshed(domain, 0.06, walls=["bottom", "top"])
    assert mesh.counts["sliding rays"] == 4 and mesh.counts["refused"] == 0
    # The first points on the outflow are those of the layers, one first height (and a little more, because
    # the outflow is oblique) above the wall.
    out = np.unique(mesh.markers["out"])
    height = np.sort(mesh.points[out, 1])
    assert 1.999e-3 <= height[1] < 3.3e-3 and height[2] / height[1] == pytest.approx(2.25)


def test_a_curved_outflow_gets_points_on_the_curve() -> None:
    domain = Domain(
        BOX, [[0, 1], [1, 2], [2, 3], [3, 0]], curves={1: Bezier([[3, 0], [3.3, 0.5], [2.9, 0.7], [3, 1]])},
        markers={"wall": [0]},
    )  # fmt: skip
    mesh = meshed(domain, 0.08, walls="wall")
    assert mesh.counts["sliding rays"] == 2


def test_a_wall_that_ends_at_a_flat_angle_tapers() -> None:
    domain = Domain(
        [[0, 0], [1, 0], [3, 0], [3, 1], [0, 1]], [[i, (i + 1) % 5] for i in range(5)], markers={"plate": [1]}
    )
    mesh = meshed(domain, 0.07, walls="plate")
    steps = mesh.steps
    start = int(np.argmin(np.hypot(*(steps["place"] - [1, 0]).T)))
    assert steps["level"][start] == 0 and steps["reason"][start] == "end"
    at = np.argsort(steps["place"][:, 0])
    assert (np.abs(np.diff(steps["level"][at])) <= 1).all() and steps["level"].max() > 8


def test_an_interface_between_regions_is_crossed() -> None:
    domain = Domain(
        [[0, 0], [1, 0], [2, 0], [2, 1], [1.1, 1], [0, 1]],
        [[i, (i + 1) % 6] for i in range(6)], inner=[[1, 4]],
        regions={"a": [0.2, 0.5], "b": [1.8, 0.5]}, markers={"wall": [0, 1, 3, 4], "middle": [6]},
    )  # fmt: skip
    mesh = meshed(domain, 0.07, walls="wall")
    assert mesh.counts["sliding rays"] == 6
    layer = mesh.steps["cell_layer"] > 0
    for name in ("a", "b"):
        inside = mesh.markers["region"] == mesh.regions[name]
        assert (layer & inside).any() and (~layer & inside).any()
    sizes = {"a": 0.1, "b": 0.05}
    meshed(domain, sizes, walls="wall")


def test_both_sides_of_an_inner_wall() -> None:
    domain = Domain(
        [*BOX, [1.0, 0.5], [2.0, 0.6]],
        [[0, 1], [1, 2], [2, 3], [3, 0]],
        inner=[[4, 5]],
        markers={"plate": [4]},
    )
    mesh = meshed(domain, 0.06, walls="plate")
    assert mesh.counts["fan rays"] == 20 and mesh.counts["refused"] == 0
    assert mesh.steps["level"].min() > 5


def with_wake(end: list[float]) -> Domain:
    """A wing in a box, and an inner piece from its trailing edge."""
    section = Domain.naca("0012", nose=(0.5, 0.5))
    domain = Domain.rectangle((0, 0), (3, 1)).with_holes(section)
    tail = int(np.argmax(np.where(np.abs(domain.points[:, 1] - 0.5) < 0.1, domain.points[:, 0], 0)))
    points, facets = np.concatenate([domain.points, [end]]), domain.facets
    if end[0] == 3:
        row = int(np.flatnonzero((domain.points[facets][:, :, 0] == 3).all(axis=1))[0])
        a, b = facets[row].tolist()
        facets = np.concatenate([facets, [[len(points) - 1, b]]])
        facets[row] = a, len(points) - 1
    return Domain(
        points, facets, inner=[[tail, len(points) - 1]], curves=domain.curves,
        markers={**{k: domain.markers[k] for k in ("upper", "lower")}, "wake": [len(facets)]},
    )  # fmt: skip


@pytest.mark.parametrize("end", [[2.2, 0.52], [3, 0.55]], ids=["free", "outflow"])
@pytest.mark.parametrize("cells", ["triangle", "quad"])
def test_wakes(end: list[float], cells: str) -> None:
    domain = with_wake(end)
    mesh = meshed(domain, 0.05, walls=["upper", "lower"], wakes="wake", cells=cells)
    steps = mesh.steps
    tail = np.hypot(*(steps["place"] - [1.5, 0.5]).T) < 1e-6
    assert tail.sum() == 2  # no fan: layers go on from the wing to the wake, on both sides
    on_wake = steps["place"][:, 0] > 1.6
    assert on_wake.sum() > 10 and np.median(steps["level"][on_wake]) > 5
    # The last ray follows the outflow on both sides; a free end has no layer.
    last = np.argmax(steps["place"][:, 0])
    assert (steps["level"][last] > 5) == (end[0] == 3)


def test_wakes_must_be_inner() -> None:
    with pytest.raises(InputError, match="wakes names facet 0"):
        advancing_layers(Domain.rectangle(), 0.1, layers=THIN, wakes=[0])


# ---------------------------------------------------------------------- nasty regions


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6))
def test_random_bodies(seed: int) -> None:
    mesh, found = judged(random_case(seed))
    assert found["valid"], found["report"]
    assert np.isfinite(mesh.steps["height"]).all()


def test_close_ramps_at_concave_corners() -> None:
    """What the fronts leave between two ramps in a notch is no sliver."""
    for angle in (40, 60, 75, 90, 110):
        a = np.radians(angle) / 2
        notch = [[-1, 1], [-1, 0], [-np.tan(a) * 0.6, 0], [0, -0.6], [np.tan(a) * 0.6, 0], [1, 0], [1, 1]]
        mesh = meshed(Domain.polygon(notch), 0.05, Layers(first=1e-3, growth=1.3), walls=[1, 2, 3, 4])
        assert mesh.figures["minimum angle of the rest"] >= 15.0
        assert mesh.counts["refused"] <= 1


RING = [[0, 0], [1, 0], [1, 1], [0, 1]]
WIDE = [[-1, -1], [2, -1], [2, 1], [-1, 1]]
TIP = [[0, 0], [0.3, -0.06], [1, 0], [1, 1e-5], [0.3, 0.06]]
ARROWS = [[[0, 0], [0.4, 0.2], [0, 0.4]], [[0.41, 0.2], [0.9, 0.4], [0.9, 0]]]
HARD = {
    "needle": (WIDE, [[[0, 0], [1, 1e-3], [1, -1e-3]]]),
    "thin trailing edge": (WIDE, [TIP]),
    "narrow gap": ([[-1, -1], [2, -1], [2, 2], [-1, 2]], [RING, [[0, 1.01], [1, 1.01], [1, 1.5]]]),
    "touching layers": ([[-1, -1], [2, -1], [2, 2], [-1, 2]], [RING, [[0, 1.0001], [1, 1.0001], [0.5, 1.5]]]),
    "spike into a slot": ([[0, 0], [2, 0], [2, 1], [1.05, 1], [1, 0.1], [0.95, 1], [0, 1]], []),
    "reflex ring": ([[0, 0], [2, 0], [2, 2], [0, 2]], [[[1, 0.2], [1.05, 1.9], [1, 1.0], [0.95, 1.9]]]),
    "body under layers": ([[0, 0], [2, 0], [2, 2], [0, 2]], [[[1, 0.1], [1.004, 0.1], [1, 0.104]]]),
    "vertex to vertex": (WIDE, ARROWS),
}  # fmt: skip


@pytest.mark.parametrize("name", HARD)
def test_hard_regions(name: str) -> None:
    outer, holes = HARD[name]
    domain = Domain.polygon(outer, holes)
    for layers in (Layers(first=1e-3, growth=1.3), Layers(first=2e-2, growth=1.1, count=12)):
        meshed(domain, 0.1, layers, cells="quad")


def test_a_loose_vertex_is_not_covered() -> None:
    points = [*RING, [0.5, 0.03], [0.5, 0.5]]
    domain = Domain(points, [[0, 1], [1, 2], [2, 3], [3, 0]])
    mesh = meshed(domain, 0.1, Layers(first=1e-2, growth=1.2))
    assert set(mesh.origin[mesh.origin >= 0].tolist()) == set(range(6))


def test_spaced_and_matched_sides_keep_their_points() -> None:
    domain = Domain.rectangle((0, 0), (1, 1)).matched([1], [3])
    mesh = meshed(domain, 0.1, walls=[0, 2])
    assert len(mesh.pairs) >= 10
    np.testing.assert_allclose(
        mesh.points[mesh.pairs[:, 1]] - mesh.points[mesh.pairs[:, 0]], [[-1, 0]] * len(mesh.pairs)
    )
    spaced = Domain.rectangle((0, 0), (1, 1)).spaced({0: 7, 1: 5})
    mesh = meshed(spaced, 0.1, walls=[0, 2])
    assert (mesh.piece == 0).sum() == 7 and (mesh.piece == 1).sum() == 5


def test_few_thin_layers_and_none_at_all() -> None:
    domain = Domain.disc((0, 0), 1.0)
    mesh = meshed(domain, 0.2, Layers(first=1e-3, count=3, growth=1.2))
    assert set(mesh.steps["level"].tolist()) == {3} and set(mesh.steps["reason"].tolist()) == {"count"}
    mesh = meshed(domain, 0.2, Layers(first=0.5, growth=1.2))
    assert mesh.steps["level"].max() == 0 and mesh.counts["layer cells"] == 0


def test_heights_by_place_and_function() -> None:
    domain = Domain.polygon(BOX)
    by_place = Layers(first=lambda x: 1e-3 * (1 + x[:, 0]), growth=1.3, count=5)
    mesh = meshed(domain, 0.1, by_place, walls=[0])
    steps = mesh.steps
    full = steps["level"] == 5
    expected = 1e-3 * (1 + steps["place"][full, 0]) * (1.3**5 - 1) / 0.3
    np.testing.assert_allclose(steps["height"][full], expected, rtol=1e-9)
    meshed(domain, 0.1, Layers(first=1e-3, count=10, thickness=0.1, function="tanh"), walls=[0])
    with pytest.raises(InputError, match="one value for all, or functions of the place"):
        advancing_layers(domain, 0.1, layers=Layers(first=[1e-3, 2e-3], growth=1.2))


# ---------------------------------------------------------------------- choices and errors


def test_the_rest_by_other_methods() -> None:
    domain = Domain.disc((0, 0), 1.0)
    meshed(domain, 0.1, fill="refine", fill_options={"min_angle": 25})
    calls = []

    def own(rest: Domain, size: Any, **options: Any) -> DomainMesh:
        calls.append((rest, options))
        return voronoi_segment(rest, size)

    mesh = meshed(domain, 0.1, fill=own, fill_options={"hello": 1})
    assert calls[0][1] == {"hello": 1} and len(calls[0][0].facets) == len(mesh.steps["envelope"])


def test_a_budget_is_told() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = advancing_layers(Domain.disc((0, 0), 1.0), 0.05, layers=THIN, budget=20)
    assert not mesh.complete and "budget" in mesh.reasons[0]
    assert (mesh.steps["cell_layer"][mesh.unrefined] == 0).all()


def test_the_same_input_gives_the_same_mesh() -> None:
    case: Case = random_case(5)
    one, two = judged(case, full=False)[0], judged(case, full=False)[0]
    np.testing.assert_array_equal(one.points, two.points)


def test_curved_bodies_and_inner_pieces_beside_layers() -> None:
    domain = Domain(
        [[-2, -2], [2, -2], [2, 2], [-2, 2], [1, 0], [-1, 0], [1.2, 0], [1.5, 0.1]],
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 4]],
        inner=[[6, 7]],
        curves={4: Arc((0, 0), 1, 0, np.pi), 5: Arc((0, 0), 1, np.pi, np.pi)},
        markers={"body": [4, 5]},
    )
    mesh = meshed(domain, 0.15, Layers(first=5e-3, growth=1.2), walls="body")
    steps = mesh.steps
    nearest = int(np.argmin(np.hypot(*(steps["place"] - [1, 0]).T)))
    assert steps["reason"][nearest] in ("near", "step", "exactness", "shape")
    assert steps["height"][nearest] < 0.2 < steps["height"].max()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"layers": 3}, "layers must be Layers"),
        ({"cells": "hexagon"}, "cells must be 'triangle' or 'quad'"),
        ({"stop": "never"}, "stop must be 'nearest' or 'spring'"),
        ({"fill": "magic"}, "fill must be one of"),
        ({"walls": "roof"}, "walls names marker 'roof'"),
        ({"walls": [9]}, "pieces outside"),
        ({"walls": 1.5}, "walls must be"),
        ({"walls": []}, "name no piece"),
        ({"budget": -1}, "budget"),
        ({"fill_options": 3}, "fill_options must be a dict"),
    ],
)
def test_refused(options: dict, text: str) -> None:
    with pytest.raises(InputError, match=text):
        advancing_layers(Domain.rectangle(), 0.2, **({"layers": THIN} | options))
