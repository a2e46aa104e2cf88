"""The frames of stuffing: the planar analog, and the stencils over their whole range."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct.view import check_frame
from unstruct.view.scenes.stuffing_frames import (
    PLANE_ALPHA,
    STENCILS,
    planar_stuffing,
    planar_stuffing_frames,
    stencil_angles,
    stencil_state,
)


def area(pieces: list) -> float:
    x = np.array(pieces)
    (ux, uy), (vx, vy) = (x[:, 1] - x[:, 0]).T, (x[:, 2] - x[:, 0]).T
    return float(abs(ux * vy - uy * vx).sum() / 2)


def test_planar_stuffing() -> None:
    made = planar_stuffing()
    for v, place, _ in made["moves"]:
        assert 0 < np.sqrt(((place - made["points"][v]) ** 2).sum()) < PLANE_ALPHA
    for (p, q), x in made["left"].items():  # the edges have the length 1
        for v in (p, q):
            assert np.sqrt(((x - made["points"][v]) ** 2).sum()) >= PLANE_ALPHA
    taken = sum(len(own) for _, _, own in made["moves"])
    assert taken + len(made["left"]) == len(made["crossings"])
    cut = planar_stuffing(0.0)
    assert not cut["moves"]
    assert cut["left"].keys() == cut["crossings"].keys()
    assert area(made["pieces"]) == pytest.approx(area(cut["pieces"]), rel=0.02)


def test_planar_frames() -> None:
    frames = planar_stuffing_frames()
    for one in frames:
        check_frame(one)
    made = planar_stuffing()
    assert len(frames) == 5 + len(made["moves"])
    warped, cut = (float(one["number"].split()[2]) for one in frames[-2:])
    assert warped > 30 > 3 > cut


@pytest.mark.parametrize("stencil", STENCILS)
def test_stencils_over_their_range(stencil: str) -> None:
    for first in (0.02, 0.28511, 0.5, 0.98):
        for others in (0.02, 0.39882, 0.5, 0.98):
            one = stencil_state(stencil, first, others)
            check_frame(one)
            angles = stencil_angles(STENCILS[stencil], [first, others])[1]
            text = f"dihedral angles from {angles.min():.1f} to {angles.max():.1f} degrees"
            assert one["number"] == text
            marked = any(item["role"] == "bad" for item in one["items"])
            assert marked == (angles.min() < 10.7 or angles.max() > 164.8)


def test_pieces_fill_what_is_inside() -> None:
    """At the middles of all edges each vertex inside has an eighth of the cell, the rest follows."""
    corners, _ = stencil_angles("+---", [0.5])
    x = corners[:, 1:] - corners[:, :1]
    small = abs(np.linalg.det(x)).sum()
    corners, _ = stencil_angles("+++-", [0.5])
    large = abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum()
    assert small == pytest.approx(8 * 0.5 / 8 * 1.0)
    assert small + large == pytest.approx(8 * small)
