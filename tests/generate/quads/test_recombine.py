"""Recombination of meshes: names, markers and pieces stay, what is refused, what is left."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import unstruct
from unstruct import Domain, Mesh


def test_one_triangle_and_two():
    with pytest.warns(unstruct.IncompleteWarning, match="triangle"):
        one = unstruct.recombine(Mesh(np.array([[0, 0], [1, 0], [0, 1.0]]), [[0, 1, 2]]))
    assert list(one.cells) == ["triangle"] and one.figures["share of quadrilaterals"] == 0
    two = unstruct.recombine(Mesh(np.array([[0, 0], [1, 0], [0, 1.0], [1, 1]]), [[0, 1, 2], [1, 3, 2]]))
    assert list(two.cells) == ["quad"] and two.complete
    assert two.figures["mean deviation"] == pytest.approx(0)


@pytest.mark.parametrize("improve", [False, True])
def test_cells_stay_in_their_part(improve):
    grid = unstruct.refine(Domain.rectangle((0, 0), (2, 1)), 0.12)
    center = grid.points[np.asarray(grid.simplices)].mean(axis=1)
    part = (center[:, 0] > 1).astype(np.int32)
    mesh = Mesh(grid.points, grid.simplices, markers={"part": part})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", unstruct.IncompleteWarning)
        found = unstruct.recombine(mesh, improve=improve)
    assert unstruct.check(found)
    area = [0.0, 0.0]
    parts = np.split(found.markers["part"], np.cumsum([len(rows) for rows in found.cells.values()])[:-1])
    for rows, marks in zip(found.cells.values(), parts):
        x = found.points[rows]
        y = np.roll(x, -1, axis=1)
        for k in (0, 1):
            area[k] += 0.5 * (x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0])[marks == k].sum()
    x = grid.points[np.asarray(grid.simplices)]
    u, w = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    each = 0.5 * (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0])
    assert area == pytest.approx([each[part == 0].sum(), each[part == 1].sum()])


def test_what_is_refused():
    for mesh in (
        unstruct.delaunay(np.random.default_rng(0).random((20, 3))),
        unstruct.recombine(Mesh(np.array([[0, 0], [1, 0], [0, 1.0], [1, 1]]), [[0, 1, 2], [1, 3, 2]])),
        Mesh(np.array([[0, 0], [1, 0], [0, 1.0]]), [[0, 2, 1]]),
    ):
        with pytest.raises(unstruct.UnstructError):
            unstruct.recombine(mesh)


def test_a_triangulation_of_many():
    domain = Domain.disc()
    mesh = unstruct.recombine(unstruct.voronoi_segment(domain, 0.02))
    assert unstruct.check(mesh, domain=domain)
    assert mesh.figures["share of quadrilaterals"] > 0.999
