"""The limit on growth: everywhere, never above what was seen, and the largest such, over brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct import Domain, InputError, refine
from unstruct.sizing import (
    LimitedSize,
    SizeField,
    background,
    clip,
    from_features,
    limited,
    minimum,
    points,
    product,
    sources,
)

RNG = np.random.default_rng(5)
BOX = [0, 0], [1, 1]
DENSE = np.stack(np.meshgrid(*[np.linspace(0, 1, 181)] * 2), axis=-1).reshape(-1, 2)


def step(x: np.ndarray) -> np.ndarray:
    return np.where(np.hypot(*(x - 0.5).T) < 0.2, 0.01, 0.3)


def valleys(x: np.ndarray) -> np.ndarray:
    return 0.02 + 0.3 * np.abs(np.sin(9 * x[:, 0]) * np.cos(7 * x[:, 1]))


def funnel(x: np.ndarray) -> np.ndarray:
    return 0.02 + 2 * np.abs(x[:, 0] - 0.4)


def waves(x: np.ndarray) -> np.ndarray:
    return 0.3 + 0.28 * np.sin(9 * x[:, 0] * x[:, 1])


def assert_limited(size: SizeField, growth: float, rng: np.random.Generator, *, scale: float = 1.0) -> None:
    """No two points are steeper than the limit, far and near, in the box and beyond."""
    x = rng.random((3000, 2)) * 1.4 - 0.2
    for reach in (1.0, 1e-2, 1e-4, 1e-7):
        y = x + reach * rng.standard_normal(x.shape)
        rise, away = np.abs(size(x * scale) - size(y * scale)), np.hypot(*(x - y).T) * scale
        rounding = 1e-14 * (size(x * scale) + growth * scale)
        assert (rise <= growth * away * (1 + 1e-9) + rounding).all(), (rise / away).max() / growth


def test_a_jump_becomes_a_slope() -> None:
    field = limited(step, 0.2, *BOX)
    x = RNG.random((2000, 2))
    away = np.maximum(0, np.hypot(*(x - 0.5).T) - 0.2)
    assert np.abs(field(x) - np.minimum(0.3, 0.01 + 0.2 * away)).max() < 0.0005
    near = np.hypot(*(x[:1000] - x[1000:]).T)
    assert (np.abs(step(x[:1000]) - step(x[1000:])) / near).max() > 2  # the wish itself is steep
    assert (np.abs(field(x[:1000]) - field(x[1000:])) / near).max() <= 0.2 * (1 + 1e-9)


@pytest.mark.parametrize("growth", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("wish", [step, valleys, funnel, waves])
def test_what_the_limit_promises(wish: object, growth: float) -> None:
    size = SizeField(wish)
    field = limited(size, growth, *BOX)
    assert isinstance(field, LimitedSize) and field.capped["nodes"] == field.capped["depth"] == 0
    assert_limited(field, growth, np.random.default_rng(1))
    assert (field(field.places) <= field.values * (1 + 1e-14)).all()
    assert (size(field.places) == field.values).all()
    seen = np.concatenate([DENSE, field.places])
    h = size(seen)
    for x in RNG.random((60, 2)):
        true = min((h + growth * np.hypot(*(x - seen).T)).min(), size([x])[0])
        got = field([x])[0]
        assert (
            true * 0.97 - growth / 181 <= got <= true * 1.05
        )  # DENSE may be half a mesh from the best place


@pytest.mark.parametrize("growth", [0.1, 0.3])
def test_the_bottom_of_a_sharp_valley_is_found(growth: float) -> None:
    """Its size is asked for all along it, and the slope beside it is the limit."""
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])

    def wish(x: np.ndarray) -> np.ndarray:
        return 0.02 + 3 * np.abs(((x - 0.5) @ turn.T)[:, 1])

    field = limited(wish, growth, *BOX)
    along = np.linspace(-0.45, 0.45, 500)[:, None] * turn[0] + 0.5
    k = 3 / growth
    assert (field(along) <= 0.02 * (1 + 0.02 * max(1, k / 8))).all()
    assert (field(along) >= 0.02 * (1 - 1e-12)).all()
    beside = along[100:400] + 0.05 * turn[1]
    assert np.allclose(field(beside), 0.02 + growth * 0.05, rtol=0.05)


def random_field(seed: int) -> SizeField:
    """Facets of random planes with creases and jumps between them."""
    rng = np.random.default_rng(seed)
    kind = rng.integers(3, size=4)
    normals, offsets = rng.standard_normal((4, 2)), rng.random((4, 2))
    heights = 10 ** rng.uniform(-1.5, -0.3, 4)

    def value(x: np.ndarray) -> np.ndarray:
        total = np.full(len(x), 0.03)
        for k, n, p, height in zip(kind, normals, offsets, heights, strict=True):
            along = (x - p) @ n
            total += height * (np.abs(along), along > 0, 1 + np.sin(12 * along))[k]
        return total

    return SizeField(value)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.05, 0.2, 0.5, 1.0, 2.0]))
def test_random_fields(seed: int, growth: float) -> None:
    wish, rng = random_field(seed), np.random.default_rng(seed)
    field = limited(wish, growth, *BOX, tolerance=0.05, max_nodes=20_000)
    assert_limited(field, growth, rng)
    assert (field(field.places) <= field.values * (1 + 1e-14)).all()
    # the largest: an oracle of what was looked at, cones about all places, is nowhere less
    x = rng.random((50, 2))
    cones = (field.values + growth * np.hypot(*(x[:, None] - field.places).transpose(2, 0, 1))).min(axis=1)
    assert (field(x) <= cones * (1 + 1e-12)).all()
    # nor more at places themselves, but for what the interpolant says between them
    at = rng.integers(len(field.places), size=50)
    away = np.hypot(*(field.places[at, None] - field.places).transpose(2, 0, 1))
    cones = (field.values + growth * away).min(axis=1)
    assert (field(field.places[at]) >= cones - growth / 32).all()
    assert np.abs(field(field.places[at]) / cones - 1).mean() < 0.05


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.1, 0.5, 2.0]))
def test_the_minimum_over_the_interpolant_is_exact(seed: int, growth: float) -> None:
    """Over dense samples of the edges of the interpolant that `limited` says it uses."""
    from unstruct import delaunay

    rng = np.random.default_rng(seed)
    places = np.concatenate([[[0, 0], [1, 0], [0, 1], [1, 1]], rng.random((8, 2))])
    values = 0.1 + rng.random(len(places)) ** 3
    field = LimitedSize(growth, places, values, capped={}, landmarks=np.empty((0, 2)), name="twelve places")
    x = rng.random((40, 2))
    h = background(delaunay(places), values)
    # it is taken at x itself or on an edge
    a, b = np.moveaxis(h.mesh.points[h.mesh.edges], 1, 0)
    along = (a[:, None] + np.linspace(0, 1, 1001)[:, None] * (b - a)[:, None]).reshape(-1, 2)
    dense = (h(along) + growth * np.hypot(*(x[:, None] - along).transpose(2, 0, 1))).min(axis=1)
    true = np.minimum(dense, h(x))
    assert (field(x) <= true * (1 + 1e-12)).all()
    assert (field(x) >= true - growth * 2e-3).all()
    assert_limited(field, growth, rng)


def test_outside_of_the_box_as_at_its_nearest_point() -> None:
    field = limited(funnel, 0.3, *BOX)
    assert field([[-1, 0.5], [2, 3]]).tolist() == field([[0, 0.5], [1, 1]]).tolist()


@pytest.mark.parametrize("scale", [2.0**-30, 2.0**30])
def test_far_scales(scale: float) -> None:
    field = limited(lambda x: scale * valleys(x / scale), 0.3, [0, 0], [scale, scale])
    assert np.allclose(field(DENSE * scale) / scale, limited(valleys, 0.3, *BOX)(DENSE), rtol=1e-6)
    assert_limited(field, 0.3, np.random.default_rng(2), scale=scale)


@pytest.mark.parametrize("upper", [[1, 0], [0, 1], [0, 0]])
def test_a_box_without_an_inside(upper: list[float]) -> None:
    field = limited(lambda x: 0.02 + 3 * np.abs(x.sum(axis=1) - 0.4), 0.2, [0, 0], upper)
    t = np.linspace(0, 1, 101)[:, None] * upper
    assert np.allclose(field(t), 0.02 + 0.2 * np.abs(t.sum(axis=1) - 0.4) if any(upper) else 1.22, rtol=0.03)


def test_a_limit_that_does_not_bind_changes_nothing() -> None:
    def gentle(x: np.ndarray) -> np.ndarray:
        return 0.1 + 0.1 * x[:, 0]

    x = RNG.random((300, 2))
    assert np.allclose(limited(gentle, 0.1001, *BOX)(x), gentle(x), rtol=1e-12)

    def curved(x: np.ndarray) -> np.ndarray:
        return 0.1 + 0.05 * np.sin(3 * x[:, 0] + x[:, 1])

    assert np.allclose(limited(curved, 0.2, *BOX)(x), curved(x), rtol=0.01)


def test_what_is_known_to_be_gentle_comes_back_as_it_is() -> None:
    source = points([[0.5, 0.5]], 0.01, growth=0.2)
    feature = from_features(Domain.rectangle(), 0.3, far=0.2)
    for gentle in (source, feature, minimum(source, feature, 0.5), clip(source, 0.02, 0.1)):
        assert limited(gentle, 0.3, *BOX) is gentle
    assert limited(source, 0.1, *BOX) is not source
    again = limited(step, 0.2, *BOX)
    assert limited(again, 0.2, *BOX) is again and again.growth == 0.2
    assert product(3, source).growth is None and SizeField(step).growth is None
    assert minimum(source, step).growth is None
    assert limited(0.3, 0.1, *BOX).constant == 0.3


def test_landmarks_are_looked_at() -> None:
    dip = minimum(0.3, sources([[0.501, 0.333]], 1e-4, growth=1.0))
    field = limited(dip, 0.1, *BOX)
    assert np.isclose(field([[0.501, 0.333]])[0], 1e-4, rtol=1e-9)
    assert np.allclose(field([[0.601, 0.333]]), 1e-4 + 0.01, rtol=0.01)


def test_what_was_not_resolved_is_reported() -> None:
    field = limited(valleys, 0.1, *BOX, max_nodes=2000)
    assert isinstance(field, LimitedSize) and field.capped["nodes"] > 0
    assert_limited(field, 0.1, np.random.default_rng(3))


def test_a_mesh_follows() -> None:
    mesh = refine(Domain.rectangle(), limited(step, 0.3, *BOX))
    assert mesh.complete and mesh.quality("min_angle").min() > 20


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: limited(0.1, 0.0, *BOX), "growth"),
        (lambda: limited(step, np.nan, *BOX), "growth"),
        (lambda: limited(lambda x: x[:, 0], 0.1, *BOX), "positive and finite"),
        (lambda: limited(step, 0.1, [1, 1], [0, 0]), "box"),
    ],
)
def test_bad_input(make: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
