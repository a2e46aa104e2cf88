"""Structured grids: counts, areas, spacing, and the fold that check finds."""

import numpy as np
import pytest

from unstruct import InputError, check
from unstruct.examples.structured import graded_line, ring_grid, tensor_grid


def circle(n, radius=1.0):
    angle = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def test_graded_line_respects_the_spacing():
    x = graded_line(-1.0, 2.0, lambda x: 0.05 + 0.2 * np.abs(x))
    steps, middle = np.diff(x), (x[1:] + x[:-1]) / 2
    assert x[0] == -1 and x[-1] == 2 and (steps > 0).all()
    assert (steps <= 1.05 * (0.05 + 0.2 * np.abs(middle))).all() and (
        steps >= 0.8 * (0.05 + 0.2 * np.abs(middle))
    ).all()
    assert np.allclose(graded_line(0, 1, lambda x: np.full(len(x), 0.25)), [0, 0.25, 0.5, 0.75, 1])


def test_tensor_grid():
    mesh = tensor_grid([0, 1, 3], [0, 2, 3, 4])
    assert mesh.face_counts() == (12, 17, 6) and mesh.volume == 12 and check(mesh)
    assert mesh.points[1 * 4 + 2].tolist() == [1, 3]


def test_ring_grid():
    mesh = ring_grid(circle(24), circle(24, 3.0), np.linspace(0, 1, 5))
    assert mesh.size == 96 and mesh.euler_characteristic == 0 and check(mesh)
    assert mesh.volume == pytest.approx(12 * np.sin(np.pi / 12) * 8)
    outer = circle(24, 3.0)
    outer[3] = [-2.5, 0.0]
    folded = check(ring_grid(circle(24), outer, np.linspace(0, 1, 5)))
    assert "negative cell" in {problem.kind for problem in folded.problems}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: graded_line(0, 1, lambda x: x - 0.5), "positive"),
        (lambda: graded_line(1, 1, lambda x: x), "length"),
        (lambda: tensor_grid([0, 1], [1, 0]), "y must be a one-dimensional array of at least two increasing"),
        (lambda: ring_grid(circle(5), circle(6), [0, 1]), "both have shape"),
        (lambda: ring_grid(circle(5), circle(5, 2), [0, 0.5]), "from 0 to 1"),
    ],
)
def test_errors(call, words):
    with pytest.raises(InputError, match=words):
        call()
