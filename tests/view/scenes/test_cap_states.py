"""Two bodies with layers: the counts are what the tests of caps say."""

from __future__ import annotations

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.cap_states import CAP_PAIRS, cap_state


@pytest.mark.parametrize("bodies", CAP_PAIRS)
def test_the_whole_range(bodies: str) -> None:
    """No place is covered twice exactly when the caps neither cross nor contain each other."""
    seen = set()
    for distance in (0.2, 0.4, 0.6, 0.8, 1.0):
        for height in (0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.3):
            one = cap_state(bodies, distance, height)
            check_frame(one)
            caps, count = one["number"].split(": ")[1].split(";")[0], int(one["number"].split()[-3])
            right = height if bodies == "equal" else 0.2 * height
            touch = abs(height + right - distance) < 1e-9
            assert (caps == "apart") == (height + right < distance - 1e-9)
            assert count == (1 if caps == "apart" or touch else 2)
            seen.add(caps)
    assert ("one contains the other" in seen) == (bodies == "a small one")


def test_an_unknown_pair() -> None:
    with pytest.raises(InputError, match="bodies = 'three' must be one of 'equal', 'a small one'"):
        cap_state("three")
