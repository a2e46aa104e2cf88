"""The histories of two proofs of section 2.5, for all presets."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from unstruct import InputError
from unstruct.studies import cavities
from unstruct.view import check_frame
from unstruct.view.scenes.visibility import FANS, SIGHTS, fan_history, fan_mesh, sight_history


def numbers(frames):
    return [float(one["number"].split(" = ")[1]) for one in frames if one["number"]]


@pytest.mark.parametrize("preset", SIGHTS)
def test_sights(preset):
    frames = sight_history(preset)
    for one in frames:
        check_frame(one)
    assert len({tuple(one["view"]) for one in frames}) == 1
    powers = numbers(frames)
    if preset == "a clear view":
        assert len(powers) == len(SIGHTS[preset]["cells"]), "the line of sight enters all triangles"
        assert all(p > q for p, q in pairwise(powers)) and powers[-1] == 0
    elif SIGHTS[preset]["segments"]:
        assert powers[0] < 0 and len(powers) == 1 and "not seen" in frames[-1]["caption"]
    else:
        assert powers[0] < 0 < powers[1] and any("RISEN" in one["caption"] for one in frames)


@pytest.mark.parametrize("preset", FANS)
def test_fans(preset):
    frames = fan_history(preset)
    for one in frames:
        check_frame(one)
    for one in frames:
        triangles, edges = (int(part.split(" = ")[1]) for part in one["number"].split(", "))
        assert edges == triangles + 2
    mesh, p, fixed = fan_mesh(preset)
    sets = cavities(mesh, p, fixed=np.array(fixed, dtype=np.int32))
    assert len(fixed) == FANS[preset].get("fixed", 0)
    assert triangles == len(sets.upsilon_component) > 3
    assert len(frames) == triangles - len(sets.holders) + 1
    if preset == "P on an edge":
        assert len(sets.holders) == 2
    if "nasty" in preset:
        assert len(sets.gamma) > triangles, "another piece of the cavity is apart"


def test_unknown_presets():
    for history in (sight_history, fan_history):
        with pytest.raises(InputError, match="no preset"):
            history("nothing")
