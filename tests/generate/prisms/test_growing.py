"""Numbers of the vertices of layers: level by level, for any levels, and with several rays at a vertex."""

from __future__ import annotations

import numpy as np

from unstruct.generate.prisms.growing import grown_layers, in_tetrahedra, numbers_of_levels
from unstruct.generate.prisms.records import Walls


def test_numbers_follow_levels_and_rays() -> None:
    base, level = np.array([0, 1, 1, 3]), np.array([2, 0, 1, 3])
    number, ray, step = numbers_of_levels(base, level, 3, 4)
    assert number.tolist() == [[0, 1, 1, 3], [4, 1, 5, 6], [7, 1, 5, 8], [7, 1, 5, 9]]
    assert ray.tolist() == [0, 1, -1, 3, 0, 2, 3, 0, 3, 3]
    assert step.tolist() == [0, 0, 0, 0, 1, 1, 1, 2, 2, 3]


def test_layers_over_one_triangle() -> None:
    points = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    rows = np.array([(0, 1, 2)], dtype=np.int32)
    walls = Walls(
        points,
        rows,
        np.array([7, 5, 9], np.int32),
        np.array([4]),
        np.full((3, 2), -1, np.int32),
        np.empty((0, 3)),
    )
    places = points + np.array([0.0, 0.0, 1.0]) * np.arange(3)[:, None, None]
    grown = grown_layers(walls, np.arange(3), np.array([2, 1, 0]), places, rows)
    assert {kind: len(block) for kind, block in grown.cells.items()} == {"pyramid": 1, "tetra": 1}
    assert grown.stem.tolist() == [7, 5, 9, 7, 5, 7] and grown.level.tolist() == [0, 0, 0, 1, 1, 2]
    assert (
        grown.cap.tolist() == [[5, 4, 2]]
        and grown.layer.tolist() == [0, 1]
        and grown.column.tolist() == [0, 0]
    )
    parts = in_tetrahedra(grown)
    assert list(parts.cells) == ["tetra"] and parts.layer.tolist() == [0, 0, 1]
