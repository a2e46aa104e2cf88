"""Pictures of trees."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

from unstruct import Domain, InputError, octree, quadtree, view
from unstruct.view.draw.histograms import plot_quality
from unstruct.view.draw.trees import plot_tree


@pytest.fixture(autouse=True)
def close() -> object:
    yield
    plt.close("all")


def test_leaves_are_colored_by_level() -> None:
    tree = quadtree(Domain.disc(), boundary_size=0.2)
    ax = tree.plot()
    squares, outline = ax.collections[:2]
    np.testing.assert_array_equal(squares.get_array(), tree.levels)
    corners = np.array([path.vertices[:4] for path in squares.get_paths()])
    np.testing.assert_array_equal(corners[:, 0], tree.corners[0])
    np.testing.assert_array_equal(corners[:, 2], tree.corners[1])
    assert len(outline.get_segments()) == len(tree.boundary.pieces)
    bare = plot_tree(tree, plt.figure().add_subplot(), values=tree.sides, label="side", boundary=False)
    assert len(bare.collections) == 1 and bare.collections[0].get_array().max() == tree.sides.max()


def test_octrees() -> None:
    tree = octree(Domain.ball(size=0.6), 0.5)
    whole, half = tree.plot(azimuth=20, elevation=10), tree.plot(section=("x", 0.0))
    assert whole.collections and half.collections
    assert view.plot_tree(octree([(0, 0, 0), (1, 1, 1)], 0.5)).collections


def test_errors() -> None:
    tree = quadtree([(0, 0), (1, 1)], 0.5)
    with pytest.raises(InputError, match=r"values must have one entry per leaf, shape \(4,\), not \(3,\)"):
        tree.plot(values=[1, 2, 3])
    with pytest.raises(InputError, match="section: only for octrees"):
        tree.plot(section=("x", 0.5))
    with pytest.raises(InputError, match="plot_tree draws a Tree, not a int"):
        plot_tree(3)


@pytest.mark.parametrize("ax", [5, "x", [1], object()])
def test_axes_that_are_none_are_refused(ax) -> None:
    """Every function that draws asks here; an AttributeError said nothing of `ax`."""
    tree = quadtree([[0, 0], [1, 1]], 0.5)
    cubes = octree([[0, 0, 0], [1, 1, 1]], 0.6)
    mesh = tree.mesh()
    draws = [tree.plot, cubes.plot, mesh.plot, cubes.mesh().plot, Domain.disc().plot]
    for draw_in in [*draws, lambda ax: plot_quality(mesh, ax=ax)]:
        with pytest.raises(InputError, match="ax must be matplotlib axes, such as"):
            draw_in(ax)
