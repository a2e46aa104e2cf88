"""Crosses: along the boundary, as complex numbers say, and constant in a channel."""

from __future__ import annotations

import numpy as np
import pytest

import unstruct
from unstruct import Domain
from unstruct.generate.quads.crosses import SMALL_CHANGE, arm_of, cross_field


def field_of(mesh):
    rows = np.asarray(mesh.simplices)
    pair = cross_field(np.array(mesh.points), rows, mesh.segments)
    return pair[:, 0] + 1j * pair[:, 1], rows


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1])
def test_a_straight_channel(turn):
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([[0, 0], [3, 0], [3, 1], [0, 1]]) @ [[c, s], [-s, c]]
    found, _ = field_of(unstruct.refine(Domain.polygon(corners), 0.2))
    assert np.abs(found - np.exp(4j * turn)).max() < 1e-9


def test_arms():
    for a in np.linspace(-np.pi, np.pi, 101):
        c, s = arm_of(np.cos(4 * a), np.sin(4 * a))
        assert np.hypot(c, s) == pytest.approx(1)
        assert np.abs(np.exp(4j * np.arctan2(s, c)) - np.exp(4j * a)) < 1e-6


def test_each_inner_cross_is_the_mean_of_its_neighbors():
    mesh = unstruct.refine(unstruct.examples.running_domain(), 0.2)
    found, rows = field_of(mesh)
    inner = np.setdiff1d(np.arange(len(mesh.points)), mesh.segments)
    for v in inner:
        around = np.setdiff1d(rows[(rows == v).any(axis=1)], [v])
        mean = found[around].sum()
        assert abs(abs(found[v]) - 1) < 1e-12
        assert abs(found[v] - mean / abs(mean)) < 20 * SMALL_CHANGE or abs(mean) < 0.5


def test_the_index_of_a_disc_is_four_quarters():
    found, rows = field_of(unstruct.refine(Domain.disc(), 0.1))
    jumps = np.angle(found[rows[:, [1, 2, 0]]] / found[rows]).sum(axis=1) / (2 * np.pi)
    index = np.round(jumps)
    assert np.abs(jumps - index).max() < 1e-9
    assert index.sum() == 4 and np.abs(index).sum() <= 6


def test_where_no_side_is_there_is_no_cross():
    mesh = unstruct.delaunay(np.random.default_rng(0).random((9, 2)))
    none = np.empty((0, 2), dtype=np.int32)
    assert not cross_field(mesh.points, np.asarray(mesh.simplices), none).any()
