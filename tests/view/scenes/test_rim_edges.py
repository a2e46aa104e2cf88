"""The panel of the rim edge (chapter 2.6a): every state, held to exact predicates and to the theorem."""

import re
from fractions import Fraction

import pytest

from unstruct import InputError, view
from unstruct.plain.circumcenters import exact_points, radius2
from unstruct.plain.predicates import in_sphere

A, B, C = (-1.0, 0.0), (1.0, 0.0), (0.25, 1.75)
PLACES = [(x / 8, y / 8) for x in range(-8, 9) for y in range(1, 17)]


def radii(frame: dict) -> dict[str, float]:
    return {k: float(v) for k, v in re.findall(r"(\w+) ([\d.]+)", frame["number"])}


def exact(corner) -> Fraction:
    return radius2(exact_points([A, B, corner]), (0, 1, 2))


@pytest.mark.parametrize("beyond", view.RIM_BEYOND)
def test_over_its_whole_range(beyond):
    corner = view.RIM_BEYOND[beyond]
    for x, y in PLACES:
        frame = view.rim_edge_state(x, y, beyond)
        view.check_frame(frame)
        inside = in_sphere([A, B, C], (x, y)) > 0
        deleted = corner is not None and in_sphere([B, A, corner], (x, y)) > 0
        said = frame["caption"]
        assert ("stays" in said) == (not inside) and ("is deleted" in said) == (inside and deleted)
        assert radii(frame)["ABP"] == pytest.approx(float(exact((x, y))) ** 0.5, abs=0.006)
        if inside and not deleted:
            bounds = [exact(C)] if corner is None else [exact(C), exact(corner)]
            grown = exact((x, y)) > max(bounds)
            assert grown == ("is larger" in said)  # only at a boundary edge, and only in the disk
            assert not grown or (corner is None and x * x + y * y < 1)


def test_both_corners_are_delaunay():
    assert all(in_sphere([A, B, C], d) < 0 for d in view.RIM_BEYOND.values() if d is not None)


def test_all_captions_are_reached():
    said = {view.rim_edge_state(x, y, key)["caption"] for x, y in PLACES for key in view.RIM_BEYOND}
    assert len(said) == 6


def test_values_out_of_range():
    for wrong in ({"x": 1.5}, {"y": 0.0}, {"beyond": "a wall"}):
        with pytest.raises(InputError):
            view.rim_edge_state(**wrong)
