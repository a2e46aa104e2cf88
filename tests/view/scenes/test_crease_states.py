"""Layers across a sharp edge: what the panel says is what formulas and the library say."""

from __future__ import annotations

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.crease_states import CREASE_ANGLES, CREASE_RAYS, crease_state


@pytest.mark.parametrize("angle", CREASE_ANGLES)
def test_the_whole_range(angle: float) -> None:
    """One ray: below the bound of Proposition 5.9. Several: the worst angle between two rays decides."""
    between = np.radians(180 - angle)
    for rays in CREASE_RAYS:
        one = crease_state(angle, rays)
        check_frame(one)
        least = float(one["number"].split()[-1])
        if rays == 1:
            assert least <= 2 / np.sqrt(3) * np.cos(between / 2) + 0.006
            continue
        turn = between / (rays - 1)
        wedge = min(np.sin(turn), np.cos(turn / 2)) / (np.sqrt(3) / 2)  # lying on its side
        hexahedron = np.cos(turn / 2)
        assert abs(least - min(wedge, hexahedron)) < 0.006


def test_wrong_values() -> None:
    with pytest.raises(InputError, match="angle = 180 must be between"):
        crease_state(180)
    with pytest.raises(InputError, match="rays = 0 must be at least 1"):
        crease_state(30, 0)
