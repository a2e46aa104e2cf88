"""The proof pictures over the whole range of their sliders, ends included."""

from itertools import product

import numpy as np
import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.proofs import cavity_proof_state, star_proof_state

ENDS = (1, 30, 90, 109, 111, 135, 170, 179)


@pytest.mark.parametrize(("angle_p", "angle_d"), list(product(ENDS, ENDS)))
def test_angles_decide(angle_p, angle_d):
    """P is in circle ABC above 110 degrees; with D outside of it, circle ACD then always holds P."""
    for place in (0.0, 0.5, 1.0):
        frame = cavity_proof_state(angle_p, angle_d, place)
        check_frame(frame)
        caption = frame["caption"]
        assert "IMPOSSIBLE" not in caption
        if angle_p < 110:
            assert "P is not in circle ABC" in caption
        elif angle_d < 110:
            assert "ACD goes too" in caption
        elif angle_p != angle_d:
            assert ("stays and hides P" in caption) == (angle_p < angle_d)
        cells = [item["role"] for item in frame["items"] if item["kind"] == "polygons"]
        assert cells[0] == ("cavity" if angle_p > 110 else "cell")
        if angle_p != angle_d:
            assert cells[1] == ("cavity" if angle_p > angle_d else "cell")


@pytest.mark.parametrize("p", [0.0, 0.3, 0.999, 1.0])
@pytest.mark.parametrize("hull", [False, True])
def test_a_point_in_the_new_circle_was_in_an_old_one(p, hull):
    sides = set()
    for turn in np.arange(0.0, 361.0, 15.0):
        frame = star_proof_state(p, turn, hull)
        check_frame(frame)
        above = "P's side" in frame["caption"]
        sides.add(above)
        if hull and not above:
            assert frame["number"] == "" and "ghost" in frame["caption"]
        else:
            assert float(frame["number"].rsplit(" ", 1)[1]) < 0
            assert ("ABE" if above else "ABF") in frame["number"]
    assert sides == {True, False}


@pytest.mark.parametrize(
    "call",
    [
        lambda: cavity_proof_state(angle_p=180),
        lambda: cavity_proof_state(angle_d=0),
        lambda: cavity_proof_state(place=1.5),
        lambda: star_proof_state(p=-0.1),
        lambda: star_proof_state(p=float("nan")),
    ],
)
def test_out_of_range_raises_the_typed_error(call):
    with pytest.raises(InputError, match="between"):
        call()
