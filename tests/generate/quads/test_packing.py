"""Packed points: inside, none in the square about a later one, nowhere room for one more step."""

from __future__ import annotations

import numpy as np
import pytest

import unstruct
from unstruct import Domain
from unstruct.generate.quads import packing
from unstruct.generate.quads.crosses import cross_field
from unstruct.generate.quads.packing import NEAREST_POINT, NEAREST_SIDE, Guide, packed
from unstruct.generate.quads.recombine import on_pieces


def guide_of(domain, size, length):
    mesh = unstruct.voronoi_segment(domain, size)
    rows = np.asarray(mesh.simplices)
    flat = rows.ravel()
    order = np.argsort(flat, kind="stable")
    given = np.zeros(len(mesh.points), dtype=bool)
    given[mesh.segments.ravel()] = True
    start = np.searchsorted(flat[order], np.arange(len(mesh.points) + 1))
    lengths = np.full(len(mesh.points), length) if np.isscalar(length) else length(mesh.points)
    return mesh, Guide(
        np.array(mesh.points), rows, np.asarray(mesh.neighbors), on_pieces(mesh), given,
        cross_field(np.array(mesh.points), rows, mesh.segments), lengths, start, order // 3,
    )  # fmt: skip


def test_a_rectangle_is_filled_by_a_grid():
    _, g = guide_of(Domain.rectangle((0, 0), (2, 1)), 0.125, 0.125)
    points = packed(g, 10**6)
    assert len(points) == 15 * 7
    assert np.abs(points * 8 - np.round(points * 8)).max() < 1e-6


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_no_two_in_a_square(turn):
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([[0, 0], [2, 0], [2, 1], [0, 1]]) @ [[c, s], [-s, c]]
    domain, h = Domain.polygon(corners), 0.11
    mesh, g = guide_of(domain, h, h)
    points = packed(g, 10**6)
    assert domain.contains(points).all()
    every = np.concatenate([points, mesh.points[g.given]])
    apart = (every[:, None] - every[None]) @ np.array([[c, -s], [s, c]])  # the crosses are those of the sides
    largest = np.abs(apart).max(axis=2)
    largest[len(points) :, len(points) :] = np.inf  # of the given ones
    np.fill_diagonal(largest, np.inf)
    assert largest.min() >= NEAREST_POINT * h * (1 - 1e-9)
    a, b = mesh.points[mesh.segments].transpose(1, 0, 2)
    along = ((points[:, None] - a) * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1)
    foot = a + np.clip(along, 0, 1)[..., None] * (b - a)
    away = np.sqrt(((points[:, None] - foot) ** 2).sum(axis=2))
    assert away.min() >= NEAREST_SIDE * h * (1 - 1e-9)


def test_a_budget_and_room_that_grows(monkeypatch):
    _, g = guide_of(Domain.disc(), 0.1, 0.02)
    every = packed(g, 10**6)
    assert len(packed(g, 37)) == 37
    assert np.array_equal(packed(g, 500), every[:500])
    monkeypatch.setattr(packing, "MOST_AT_FIRST", 3)
    assert np.array_equal(packed(g, 10**6), every)


def test_flat_triangles_of_the_guide():
    """Sides of 1e-90 at corners: lengths were negative by rounding there, and points without end."""
    ring = [(0, 0), (1, 0), (1, 1e-90), (1, 1), (1e-200, 1), (0, 1), (0, 3e-120)]
    domain = Domain.polygon(ring)
    with pytest.warns(unstruct.IncompleteWarning):
        mesh = unstruct.quadrilaterals(domain, 0.2)
    assert unstruct.check(mesh, domain=domain)
    assert mesh.size < 1000
