"""Four regions by three methods at three sizes."""

from __future__ import annotations

import re

import pytest

from unstruct import InputError
from unstruct.view import check_frame
from unstruct.view.scenes.meshed_states import MESHED_METHODS, MESHED_REGIONS, MESHED_SIZES, meshed_state


@pytest.mark.parametrize("region", MESHED_REGIONS)
def test_the_whole_range(region: str) -> None:
    for size in MESHED_SIZES:
        largest = {}
        for method in MESHED_METHODS:
            one = meshed_state(region, method, size)
            check_frame(one)
            said = re.match(r"(\d+) triangles, angles (\d+)° to \d+°, largest R = ([\d.]+) h", one["number"])
            assert said
            drawn = [len(item["data"]) for item in one["items"]]
            assert drawn[0] + drawn[1] == int(said[1]) and drawn[1] == drawn[3] == 1
            largest[method] = float(said[3])
            assert int(said[2]) >= (25 if method == "Delaunay refinement" else 8)
        # circumcenters are inserted until every radius is at most h / sqrt(3)
        assert largest["circumcenters"] == min(largest.values()) <= 0.58


def test_unknown_values() -> None:
    with pytest.raises(InputError, match="Voronoi segments"):
        meshed_state(method="front")
    with pytest.raises(InputError, match="letters"):
        meshed_state("a moon")
