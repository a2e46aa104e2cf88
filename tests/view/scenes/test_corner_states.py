"""Meshes of a region with a sharp corner."""

from __future__ import annotations

import re

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.corner_states import CORNER_ANGLES, CORNER_METHODS, corner_state


@pytest.mark.parametrize("method", CORNER_METHODS)
def test_the_whole_range(method: str) -> None:
    for angle in CORNER_ANGLES:
        one = corner_state(method, angle)
        check_frame(one)
        given_up = int(one["caption"].split()[0])
        bad = next(item for item in one["items"] if item["role"] == "bad")
        assert len(bad["data"]) == given_up
        others = float(re.search(r"others ([\d.]+)°", one["number"])[1])
        if method == "circumcenters":  # it is asked for no angle, and gives up nothing
            assert given_up == 0
        else:
            assert others > 24.9 and (given_up > 0) == (angle <= 20)


def test_unknown_values() -> None:
    with pytest.raises(InputError, match="Voronoi segments"):
        corner_state("front")
    with pytest.raises(InputError, match="angle = 0 must"):
        corner_state(angle=0)
