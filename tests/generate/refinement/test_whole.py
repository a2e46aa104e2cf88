"""Refinement of small input in one kernel call: the same mesh, account and names as step by step."""

from __future__ import annotations

import numpy as np
import pytest
from regions import KINDS

from unstruct import Arc, Domain, IncompleteWarning, refine
from unstruct.domain.domain import Sampled
from unstruct.generate.refinement import whole
from unstruct.mesh.domain_mesh import DomainMesh

CHOICES = [
    {"min_angle": 30},
    {"min_angle": 33, "method": "chew"},
    {"max_area": 0.01, "method": "ruppert", "min_angle": 20},
    {"size": 0.15},
    {"min_angle": 25, "split_boundary": False},
    {"min_angle": 25, "split_boundary": "inner"},
    {"min_angle": 0, "max_area": 0.02},
]


def same(domain: Domain | Sampled, **choices: object) -> DomainMesh:
    one, two = refine(domain, **choices), refine(domain, history=True, **choices)  # a record needs steps
    for name in ("points", "simplices", "neighbors", "origin", "segments", "piece", "span", "unrefined"):
        a, b = getattr(one, name), getattr(two, name)
        np.testing.assert_array_equal(a, b, err_msg=name)
        assert a.dtype == b.dtype and not a.flags.writeable
    assert one.counts == two.counts and one.complete == two.complete
    assert one.reasons.tolist() == two.reasons.tolist() and one.reasons.dtype == two.reasons.dtype
    assert one.regions == two.regions and one.figures == two.figures
    assert one.weights is None and len(one.hidden) == len(one.duplicates) == 0
    assert list(one.markers) == list(two.markers)
    for name in one.markers:
        np.testing.assert_array_equal(one.markers[name], two.markers[name], err_msg=name)
    return one


@pytest.fixture
def at_once(monkeypatch):
    """The results of the one call, None where it left the work to the steps."""
    found = []

    def spy(*given):
        found.append(whole.refined_at_once(*given))
        return found[-1]

    monkeypatch.setattr("unstruct.generate.refinement.refine.refined_at_once", spy)
    return found


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


@pytest.mark.parametrize("method", ["ruppert", "chew", "off-centers"])
@pytest.mark.parametrize("budget", [None, 5000])
def test_needles(at_once, method, budget):
    for height, apex in ((1e-6, 0.37), (1e-4, 0.01), (0.02, 0.5)):
        mesh = same(Domain.polygon([(0, 0), (1, 0), (apex, height)]), method=method, budget=budget)
        assert not mesh.complete
    assert any(mesh is not None for mesh in at_once)


@pytest.mark.parametrize("method", ["ruppert", "chew"])
def test_narrow_gaps(at_once, method):
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for width in (1e-5, 1e-2, 0.05):
        hole = [(0.2, width), (0.8, width), (0.7, 0.3), (0.3, 0.3)]
        same(Domain.polygon(square, [hole]), method=method)
    assert any(mesh is not None for mesh in at_once)


@pytest.mark.parametrize("angle", [34.0, 40.0, 59.0])
def test_angles_out_of_reach(at_once, angle):
    ell = Domain.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    mesh = same(ell, min_angle=angle)
    assert same(ell, min_angle=angle, size=0.3).size > mesh.size
    assert all(r.startswith("too near: an angle above 33.5") for r in mesh.reasons)
    assert sum(mesh is not None for mesh in at_once) == 2


def test_small_angles_between_curves(at_once):
    """The reasons name angles of true tangents; both sides are arcs, or one of them is straight."""
    for bend in (0.1, 0.4, 1.0):
        low = Arc((0.0, np.cos(bend)), 1.0, -np.pi / 2 - bend, 2 * bend)
        high = Arc((0.0, -np.cos(bend)), 1.0, np.pi / 2 - bend, 2 * bend)
        points = [low.point(0.0), low.point(1.0), (0.0, 0.9)]
        lune = Domain(points[:2], [(0, 1), (1, 0)], curves={0: low, 1: high})
        for domain in (lune, Domain(points, [(0, 1), (1, 2), (2, 0)], curves={0: low})):
            for min_angle in (20, 30):
                same(domain, min_angle=min_angle)
    tangents = [reason for mesh in at_once if mesh is not None for reason in mesh.reasons]
    assert any(reason.startswith("input angle") for reason in tangents)


def test_a_warning_names_the_caller(at_once):
    with pytest.warns(IncompleteWarning) as caught:
        refine(Domain.polygon([(0, 0), (1, 0), (0.5, 0.02)]))
    assert at_once[0] is not None and caught[0].filename == __file__


def test_sampled_domains(at_once):
    same(Domain.disc().sampled(0.5), min_angle=30)
    assert at_once[0] is not None


def test_names_and_unused_vertices(at_once):
    points = np.array([(0, 0), (3, 0), (3, 1), (0, 1), (1, 0), (1, 1), (5, 5)], dtype=float)
    rows = [(0, 4), (4, 1), (1, 2), (2, 5), (5, 3), (3, 0)]
    domain = Domain(points, rows, inner=[(4, 5)], regions={"left": [0.5, 0.5]}, markers={"cut": [6]})
    mesh = same(domain, min_angle=30, max_area={"left": 0.01})
    assert at_once[0] is not None and mesh.regions == {"left": 0} and mesh.markers["region"].max() == 1
    one = Domain([(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (2, 0)], regions={"all": [0.2, 0.2]})
    assert same(one).regions == {"all": 0}
    assert refine(domain, max_area={"left": 0.01}).origin.max() == 5


def test_more_than_expected_is_left_to_the_steps(monkeypatch):
    domain = Domain.rectangle()
    same(domain, size=lambda x: 0.05 + 0.1 * x[:, 0])  # a table
    same(domain, max_area=1e-4)  # more than a few vertices
    same(domain, size=0.1, budget=50)
    same(Domain.disc(), min_angle=30)
    monkeypatch.setattr(whole, "FEW_VERTICES", 3)  # what compiled code knows stays
    same(domain, min_angle=30)
