"""Bodies by formulas: signs, distances, volumes, bounds of change; random fields by seed."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from unstruct import InputError, examples

BODIES = {
    "sphere": (examples.sphere(), 4 / 3 * np.pi),
    "torus": (examples.torus(), 2 * np.pi**2 * 0.16),
    "cube": (examples.cube(), 8.0),
    "notch": (examples.notch(), 7.2),
}


@pytest.mark.parametrize("name", BODIES)
def test_volumes_and_bounds(name: str) -> None:
    body, volume = BODIES[name]
    x = np.random.default_rng(0).uniform(*body.box, (200_000, 3))
    found = (body(x) > 0).mean() * np.prod(body.box[1] - body.box[0])
    assert abs(found - volume) < 0.02 * volume
    steps = np.diff(x, axis=0)
    assert (np.abs(np.diff(body(x))) <= body.change * np.sqrt((steps**2).sum(axis=1)) * (1 + 1e-12)).all()
    for side in range(3):
        for end in body.box:
            face = x[:2000].copy()
            face[:, side] = end[side]
            assert (body(face) < 0).all()


def test_values() -> None:
    assert examples.sphere(2.0)([0.0, 0.0, 0.5]) == 1.5
    assert examples.torus(2.0, 0.5)([0.0, 2.0, 0.25]) == 0.25
    np.testing.assert_allclose(examples.cube()([(2, 2, 0), (0.75, 0, 0), (0, -3, 0)]), [-(2**0.5), 0.25, -2])
    np.testing.assert_allclose(examples.notch()([(0, 0, 0), (0, 0.5, 0.5), (0, 0, -0.9)]),
                               [0, -0.5 / 7.25**0.5, 0.1])  # fmt: skip
    assert examples.sphere()(np.zeros((2, 4, 3))).shape == (2, 4)


def test_the_notch_as_a_domain() -> None:
    body, domain = examples.notch(0.3, 1.5), examples.notched_box(0.3, 1.5)
    x = np.random.default_rng(0).uniform(-1.1, 1.1, (5000, 3))
    np.testing.assert_array_equal(body(x) > 0, domain.contains(x))
    np.testing.assert_allclose(domain.volume, 8 - 0.3 * 1.5 * 2)
    assert {*domain.markers} == {"front", "back", "bottom", "right", "top", "left", "notch"}
    sides = {
        "front": (1, -1),
        "back": (1, 1),
        "bottom": (2, -1),
        "top": (2, 1),
        "left": (0, -1),
        "right": (0, 1),
    }
    for name, (axis, at) in sides.items():
        for facet in domain.markers[name]:
            rows = np.asarray(domain.facets[facet])
            assert (domain.points[rows[rows >= 0], axis] == at).all(), name


def test_noise() -> None:
    field = examples.noise(3, waves=30, shortest=0.5)
    x = np.random.default_rng(0).uniform(-20, 20, (50_000, 3))
    values = field(x)
    assert abs(values.mean()) < 0.05 and abs((values**2).mean() - 1) < 0.05
    np.testing.assert_array_equal(values, examples.noise(3, waves=30, shortest=0.5)(x))
    assert np.abs(values - examples.noise(4, waves=30, shortest=0.5)(x)).max() > 1
    near = x + 1e-4
    assert (np.abs(field(near) - values) <= field.change * 1e-4 * 3**0.5 * (1 + 1e-9)).all()


def test_noisy_balls_are_closed() -> None:
    for seed in range(5):
        body = examples.noisy_ball(seed, height=0.3)
        x = np.random.default_rng(seed).uniform(*body.box, (2000, 3))
        for side in range(3):
            x[:, side] = body.box[1, side]
            assert (body(x) < 0).all()
            x[:, side] = np.random.default_rng(seed).uniform(*body.box[:, side], 2000)
        assert body([0.0, 0.0, 0.0]) > 0
    flat = examples.noisy_ball(0, height=0.0)
    np.testing.assert_allclose(flat(x), examples.sphere()(x), atol=1e-15)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: examples.sphere(0), "radius = 0.0 must be positive"),
        (lambda: examples.torus(1, 1), "tube = 1 must be less than radius = 1"),
        (lambda: examples.cube("x"), "half must be a number"),
        (lambda: examples.notch(1.0), "width = 1 must be less than 1"),
        (lambda: examples.notched_box(0.5, 2.0), "depth = 2 less than 2"),
        (lambda: examples.noise(-1), "seed"),
        (lambda: examples.noise(waves=0), "waves must be at least 1"),
        (lambda: examples.noise(shortest=-1), "shortest"),
        (lambda: examples.noisy_ball(height=0.5), "height = 0.5 must be at least 0 and less than 0.5"),
        (lambda: examples.sphere()([1.0, 2.0]), r"x must have shape \(\.\.\., 3\), not \(2,\)"),
    ],
)
def test_errors(call, says: str) -> None:
    with pytest.raises(InputError, match=says):
        call()


@pytest.mark.parametrize("name", [*BODIES, "noise", "noisy ball"])
def test_bodies_pickle_and_copy(name: str) -> None:
    """Processes of a pool take them: the same values bit for bit, and the box is read-only again."""
    more = {"noise": examples.noise(3), "noisy ball": examples.noisy_ball(2)}
    body = more[name] if name in more else BODIES[name][0]
    x = np.random.default_rng(1).uniform(-2, 2, (500, 3))
    for again in (pickle.loads(pickle.dumps(body)), copy.deepcopy(body)):
        assert repr(again) == repr(body) and again.change == body.change
        np.testing.assert_array_equal(again(x), body(x))
        np.testing.assert_array_equal(again.box, body.box)
    assert not pickle.loads(pickle.dumps(body)).box.flags.writeable
