"""Two segments that halve each other: over the whole range, and against circles measured anew."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest

from unstruct import InputError, view

ANGLES, LENGTHS = (20, 30, 40, 45, 60, 90), (0.6, 0.75, 1.0)


def _vertices(frame: dict) -> tuple[np.ndarray, np.ndarray]:
    """The vertices on the lower segment and on the upper one, by their distance from the corner."""
    dots = next(np.array(i["data"]) for i in frame["items"] if i["role"] == "vertex")
    corner = np.flatnonzero((dots == 0).all(axis=1))
    return dots[: corner[1]], dots[corner[1] :]


@pytest.mark.parametrize(("angle", "shorter"), product(ANGLES, LENGTHS))
def test_it_is_done_exactly_when_no_vertex_is_in_a_circle(angle: int, shorter: float) -> None:
    for halvings in range(9):
        frame = view.sharp_corner_state(angle, shorter, halvings)
        view.check_frame(frame)
        lines = _vertices(frame)
        inside = False
        for mine, other in (lines, lines[::-1]):
            for p, q in pairwise(mine):
                away = np.linalg.norm(other[1:] - (p + q) / 2, axis=1)
                inside |= bool((away < np.linalg.norm(q - p) / 2 - 1e-12).any())
        assert inside == ("next" in frame["caption"])
        made = int(frame["number"].split()[0])
        assert sum(map(len, lines)) == 4 + made
        assert made == halvings or not inside


def test_below_the_angle_of_three_quarters_it_never_ends() -> None:
    for angle, ends in ((40, False), (41.3, False), (41.5, True), (60, True)):
        frame = view.sharp_corner_state(angle, 0.75, 40)
        assert ("done" in frame["caption"]) == ends


def test_wrong_arguments() -> None:
    for angle, shorter in ((0, 1), (180, 1), (30, 0)):
        with pytest.raises(InputError, match="angle"):
            view.sharp_corner_state(angle, shorter)
