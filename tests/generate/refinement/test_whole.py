"""Refinement of small input in one kernel call: the same mesh, account and names as step by step."""

from __future__ import annotations

import numpy as np
import pytest
from regions import KINDS

from unstruct import Domain, refine
from unstruct.generate.refinement import whole

CHOICES = [
    {"min_angle": 30},
    {"min_angle": 33, "method": "chew"},
    {"max_area": 0.01, "method": "ruppert", "min_angle": 20},
    {"size": 0.15},
    {"min_angle": 25, "split_boundary": False},
    {"min_angle": 25, "split_boundary": "inner"},
    {"min_angle": 0, "max_area": 0.02},
]


def same(domain: Domain, **choices: object) -> None:
    one, two = refine(domain, **choices), refine(domain, history=True, **choices)  # a record needs steps
    for name in ("points", "simplices", "neighbors", "origin", "segments", "piece", "span", "unrefined"):
        a, b = getattr(one, name), getattr(two, name)
        np.testing.assert_array_equal(a, b, err_msg=name)
        assert a.dtype == b.dtype and not a.flags.writeable
    assert one.counts == two.counts and one.complete == two.complete
    assert one.reasons.tolist() == two.reasons.tolist()
    assert list(one.markers) == list(two.markers)
    for name in one.markers:
        np.testing.assert_array_equal(one.markers[name], two.markers[name], err_msg=name)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("choice", range(len(CHOICES)))
def test_as_step_by_step(kind, choice):
    for seed in range(2):
        same(KINDS[kind](np.random.default_rng(seed)), budget=3000, **CHOICES[choice])


def test_reasons_and_scaled_coordinates():
    needle = np.array([(0, 0), (1000, 0), (1000, 30), (3, 500)], dtype=float)
    rows = [(0, 1), (1, 2), (2, 0)]
    for factor in (1.0, 2.0**-300, 3e150):
        domain = Domain(needle[:3] * factor, rows, markers={"base": [0]})
        assert len(refine(domain, min_angle=30).reasons), "a small angle is left"
        same(domain, min_angle=30)


def test_names_and_unused_vertices():
    points = np.array([(0, 0), (3, 0), (3, 1), (0, 1), (1, 0), (1, 1), (5, 5)], dtype=float)
    rows = [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)]
    domain = Domain(points, rows, inner=[(4, 5)], regions={"left": [0.5, 0.5]}, markers={"cut": [6]})
    same(domain, min_angle=30, max_area={"left": 0.01})
    assert refine(domain, max_area={"left": 0.01}).origin.max() == 5


def test_more_than_expected_is_left_to_the_steps(monkeypatch):
    domain = Domain.rectangle()
    same(domain, size=lambda x: 0.05 + 0.1 * x[:, 0])  # a table
    same(domain, max_area=1e-4)  # more than a few vertices
    same(domain, size=0.1, budget=50)
    same(Domain.disc(), min_angle=30)
    monkeypatch.setattr(whole, "FEW_VERTICES", 3)  # what compiled code knows stays
    same(domain, min_angle=30)
