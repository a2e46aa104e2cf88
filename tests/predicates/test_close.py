"""Close calls: the same signs as integers, and most of them without integers."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct.base.jit import kernel
from unstruct.predicates import close, exact
from unstruct.predicates.batch import orient
from unstruct.predicates.filters import filter_balls
from unstruct.predicates.kernels import conflict

D = {"orient2": (2, 3), "incircle": (2, 4), "orient3": (3, 4), "insphere": (3, 5)}


def call(module, prefix, name, points):
    function = getattr(module, f"{prefix}_{name}")
    if function is close.close_orient3:
        return function(tuple(points.ravel().tolist()))
    return function(*points.ravel()) if points.shape[1] == 2 else function(points.ravel().copy())


def short(rng, shape):
    return rng.integers(-5, 6, shape) / 16.0


def longer(rng, shape):
    return rng.integers(-600, 601, shape) / 1024.0


def spherical(rng, shape):
    x = rng.standard_normal(shape)
    return x / (2 * np.linalg.norm(x, axis=1)[:, None])


def last_bits(rng, shape):
    return 0.3 + rng.integers(-3, 4, shape) * 2.0**-54


def wide(rng, shape):
    return np.ldexp(rng.integers(-3, 4, shape).astype(float), rng.integers(-60, 0, shape))


def tiny(rng, shape):
    return np.ldexp(rng.integers(-3, 4, shape).astype(float), -2 - rng.integers(0, 300))


def dependent(rng, shape):
    x = rng.random(shape)
    weights = rng.dirichlet(np.ones(shape[1]))
    x[-1] = weights @ x[: shape[1]]
    return x


@pytest.mark.parametrize("name", D)
@pytest.mark.parametrize("make", [short, longer, spherical, last_bits, wide, tiny, dependent])
def test_the_same_signs_as_integers(name, make):
    rng = np.random.default_rng(len(name))
    d, size = D[name]
    signs = []
    for _ in range(400):
        points = np.ascontiguousarray(make(rng, (size, d)))
        signs.append(call(close, "close", name, points))
        assert signs[-1] == call(exact, "exact", name, points)
    assert {-1, 1} <= set(signs)


@pytest.mark.parametrize("name", D)
@pytest.mark.parametrize("step", range(40, 56, 3))
def test_one_small_step_from_a_tie(name, step):
    """Lattice points, the last one moved by 2**-step: short differences end, and the sign is still right."""
    rng = np.random.default_rng(step)
    d, size = D[name]
    for _ in range(200):
        points = rng.integers(0, 3, (size, d)) / 4.0
        points[-1, 0] += rng.integers(-1, 2) * 2.0**-step
        assert call(close, "close", name, points) == call(exact, "exact", name, points)


@pytest.mark.parametrize("name", D)
def test_ties_of_many_bits(name):
    """Integers of every length, up to where the short stage must give up, turned into exact ties."""
    rng = np.random.default_rng(0)
    d, size = D[name]
    for bits in range(1, 50):
        points = rng.integers(0, 2**bits, (size, d)) / 2.0**50
        points[-1] = points[rng.integers(0, size - 1)]
        points[0, 0] += 0.25  # long differences beside short ones
        assert call(close, "close", name, points) == call(exact, "exact", name, points)


@pytest.mark.parametrize(
    ("name", "make"), [("incircle", spherical), ("insphere", spherical), ("incircle", short)]
)
def test_most_are_decided_without_integers(name, make, monkeypatch):
    """In plain Python, with the integers taken away."""
    plain = {key: getattr(value, "py_func", value) for key, value in vars(close).items() if callable(value)}
    for key, value in plain.items():
        monkeypatch.setattr(close, key, value)
    monkeypatch.setattr(close, f"exact_{name}", lambda *_: None)
    rng = np.random.default_rng(1)
    d, size = D[name]
    points = [np.ascontiguousarray(make(rng, (size, d))) for _ in range(100)]
    left = sum(call(close, "close", name, p) is None for p in points)
    assert left == 0


CELLS = 16


@kernel
def filtered(corners, p, dets, bounds):
    filter_balls(corners, corners.shape[1], p[0], p[1], p[2], dets, bounds)


def uniform(rng, shape):
    return rng.random(shape)


@pytest.mark.parametrize("make", [uniform, short, spherical, last_bits, wide, tiny, dependent])
def test_no_ball_is_decided_wrongly(make):
    rng = np.random.default_rng(7)
    decided = 0
    for _ in range(40):
        cells = np.array([make(rng, (5, 3)) for _ in range(CELLS)])
        p = cells[0, 4]
        simplices = cells[:, :4].copy()
        down = np.asarray(orient(simplices)) < 0
        simplices[down] = simplices[down][:, [1, 0, 2, 3]]
        real = np.asarray(orient(simplices)) > 0
        dets, bounds = np.zeros(CELLS), np.zeros(CELLS)
        filtered(np.ascontiguousarray(simplices.reshape(CELLS, 12).T), p, dets, bounds)
        for i in np.flatnonzero(real & (np.abs(dets) > bounds)):
            points = np.vstack([simplices[i], p])
            assert conflict(points, np.arange(4, dtype=np.int32), 4) == (1 if dets[i] < 0 else -1)
            decided += 1
        if make is uniform:
            assert (np.abs(dets) > bounds)[real].mean() > 0.9
    assert decided or make in (spherical, last_bits, tiny)
