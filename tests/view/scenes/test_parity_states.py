"""Rays that count facets: what the frames say is what `Domain.contains` says."""

from __future__ import annotations

import pytest

from unstruct import Domain, InputError
from unstruct.plain.regions import odd_vertices
from unstruct.view import check_frame
from unstruct.view.scenes.parity_states import PARITY_OUTLINES, PARITY_PLACES, parity_frames, parity_state


@pytest.mark.parametrize("outline", PARITY_OUTLINES)
def test_the_whole_range(outline: str) -> None:
    points, facets = PARITY_OUTLINES[outline]
    closed = not odd_vertices(facets)
    assert closed != outline.startswith("nasty")
    answers = []
    for place in range(len(PARITY_PLACES)):
        found = []
        for turn in range(0, 360, 15):
            one = parity_state(outline, place, turn)
            check_frame(one)
            dots = next(item for item in one["items"] if item["role"] == "cavity")
            assert len(dots["data"]) == int(one["number"].split()[0])
            found.append(one["caption"] == "inside")
        answers.append(set(found))
        if closed:
            assert answers[-1] == {bool(Domain(points, facets).contains([PARITY_PLACES[place]])[0])}
    assert closed or {True, False} in answers


def test_by_hand() -> None:
    points, facets = PARITY_OUTLINES["three rings"]
    frames = parity_frames([*points, (5.6, 2.7)], facets, (0.4, 2.0), inner=[(6, 11)])
    for one in frames:
        check_frame(one)
    assert [int(one["number"]) for one in frames] == [0, 1, 2, 3, 4, 5, 5]
    assert "not 5–6 and 6–11" in frames[4]["caption"] and "inside" in frames[-1]["caption"]
    level = parity_frames(points, facets, (-1.0, 0.0))
    assert [one["number"] for one in level] == ["0", "1", "2", "2"]
    assert "outside" in level[-1]["caption"]


def test_unknown_values() -> None:
    with pytest.raises(InputError, match="three rings"):
        parity_state("ring")
    with pytest.raises(InputError, match="place = 99"):
        parity_state(place=99)
