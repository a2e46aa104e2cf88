"""Frames of an advancing front."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import Domain, InputError, advancing_front
from unstruct.plain.advancing_front import advancing_front as plain_front
from unstruct.plain.advancing_front import boundary_front
from unstruct.plain.front_delaunay import front_delaunay as plain_delaunay
from unstruct.view import check_frame
from unstruct.view.scenes.fronts import (
    candidate_frames,
    empty_circle_frames,
    front_frames,
    front_length,
    fronts_of,
)

SQUARE = Domain.polygon([(0, 0), (1, 0), (1, 1), (0, 1)])


@pytest.mark.parametrize("placement", ["circle", "equal sides", "angle"])
@pytest.mark.parametrize("order", ["widest", "shortest"])
def test_every_step_has_a_frame(placement: str, order: str) -> None:
    domain = SQUARE.with_holes(Domain.disc((0.4, 0.5), 0.15))
    mesh = advancing_front(domain, 0.2, finish=False, history=True, placement=placement, order=order)
    frames = front_frames(mesh)
    assert len(frames) == mesh.size + 1 and "view" in frames[0]
    for one in frames:
        check_frame(one)
    some = front_frames(mesh, [0, -1], names=False)
    assert len(some) == 3 and some[0]["caption"] == frames[0]["caption"]
    assert some[1]["caption"] == frames[-2]["caption"]


def test_fronts_close() -> None:
    mesh = advancing_front(SQUARE, 0.1, finish=False)
    lengths = front_length(mesh)
    assert lengths[0] == len(mesh.segments) and lengths[-1] == 0 and len(lengths) == mesh.size + 1
    assert set(np.diff(lengths)) <= {1, -1, -3}
    for front in fronts_of(mesh):  # at every vertex as many edges arrive as leave
        assert np.array_equal(np.sort(front[:, 0]), np.sort(front[:, 1]))


def test_a_record_is_needed() -> None:
    for mesh in (advancing_front(SQUARE, 0.2, finish=False), advancing_front(SQUARE, 0.2, history=True)):
        with pytest.raises(InputError, match="history=True"):
            front_frames(mesh)


def test_frames_of_the_plain_fronts() -> None:
    points = [(0, 0), (4, 0), (4, 3), (0, 3), (1.5, 1), (2.5, 1), (2, 2)]
    sides = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 6), (6, 5), (5, 4)]
    first = list(boundary_front(points, sides, []).edges)
    steps = list(plain_front(points, sides, lambda x: 1.0))
    cells = list(plain_delaunay(points, sides))
    for frames, made in (
        (candidate_frames(points, first, steps), steps),
        (empty_circle_frames(points, first, cells), cells),
    ):
        assert len(frames) == len(made) + 1 and frames[-1]["number"] == f"{len(made)} triangles"
        for one in frames:
            check_frame(one)
        assert frames[0]["number"].startswith("0 triangles, 7 edges")
    assert any("X is taken" in one["caption"] for one in candidate_frames(points, first, steps))
