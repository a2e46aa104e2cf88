"""What notebooks show for trees."""

from __future__ import annotations

import re

import numpy as np

from unstruct import Domain, octree, quadtree


def test_quadtree() -> None:
    text = quadtree(Domain.disc(), 0.3)._repr_html_()
    assert "Quadtree of 64 leaves" in text and "balanced across" in text and len(text) < 20_000
    assert text.count("Z") == 64  # a square for each


def test_large_trees_show_their_first_levels() -> None:
    text = quadtree([(0, 0), (1, 1)], 0.01)._repr_html_()
    assert "Quadtree of 16,384 leaves, 5 levels drawn" in text and text.count("Z") == 1024
    assert len(octree(Domain.ball(size=0.3), 0.05)._repr_html_()) < 60_000


def test_unfinished_leaves_are_counted() -> None:
    import warnings

    with warnings.catch_warnings(action="ignore"):
        tree = octree([(0, 0, 0), (1, 1, 1)], 0.1, max_level=1, balance=None)
    text = tree._repr_html_()
    assert "unfinished" in text and "nothing" in text and "Octree of 8 leaves" in text


def test_pictures_stay_in_the_frame() -> None:
    for tree in (quadtree(Domain.disc(), 0.3), octree(Domain.ball(size=1.0), 0.5),
                 quadtree([(1e300, 0), (1.1e300, 1)])):  # fmt: skip
        numbers = re.findall(r"[ML]([\d.e+-]+) ([\d.e+-]+)", tree._repr_html_())
        assert numbers and np.abs(np.array(numbers, dtype=float) - 100).max() <= 100
