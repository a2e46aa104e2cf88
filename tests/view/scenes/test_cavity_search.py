"""The insertion of one point cell by cell, and in the Voronoi diagram, over all presets and places."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from unstruct import InputError, view
from unstruct.plain import bowyer_watson as bw
from unstruct.plain.predicates import in_sphere
from unstruct.plain.voronoi import circumcenter
from unstruct.view.scenes.cavity_search import CAPTURES, INSERTION_CASES, captured_state, search_history


def shapes(one, role):
    return sum(len(i["data"]) for i in one["items"] if i["kind"] == "polygons" and i["role"] == role)


@pytest.mark.parametrize("preset", INSERTION_CASES)
def test_the_search_is_the_plain_insertion(preset):
    """What goes, ghosts included, the edges and the star: as in the plain version, which has no adjacency."""
    frames, given = search_history(preset), INSERTION_CASES[preset]
    assert 7 <= len(frames) <= 14 and len({tuple(one["view"]) for one in frames}) == 1
    for one in frames:
        view.check_frame(one)
    rows = [*given["points"], given["P"]]
    start = bw.with_ghosts(given["cells"] if "cells" in given else bw.triangulate(rows[:-1]))
    step = bw.insert(rows, start, len(rows) - 1)
    real = [edge for edge in step.boundary if bw.GHOST not in edge]
    found = sum("goes" in one["caption"] for one in frames)
    missed = sum("lies apart" in one["caption"] for one in frames)
    assert found + missed == len(step.cavity) and bool(missed) == preset.startswith("nasty")
    assert f"{len(real)} edges" in frames[-2]["caption"]
    if missed:
        assert shapes(frames[-1], "bad") == 1 and "turned over" in frames[-1]["number"]
    else:
        assert frames[-1]["number"] == f"{len(real)} new triangles" and not shapes(frames[-1], "bad")


def test_every_kind_of_cell_is_asked():
    said = " ".join(one["caption"] for preset in INSERTION_CASES for one in search_history(preset))
    for words in ("its ghost goes", "its ghost stays", "on the edge", "on the circle", "in its ghost"):
        assert words in said
    with pytest.raises(InputError, match="no preset"):
        search_history("elsewhere")


@pytest.mark.parametrize("preset", CAPTURES)
def test_the_new_cell_captures_the_centers_of_what_goes(preset):
    """As many as circles contain P, counted with fractions; ties and vertices among the places."""
    said = set()
    rows = bw.exact_points(CAPTURES[preset])
    cells = bw.triangulate(rows)
    centers = [circumcenter(*(rows[v] for v in cell)) for cell in cells]
    for x in np.linspace(0.5, 7.0, 14):
        for y in np.linspace(0.25, 4.75, 7):
            one = captured_state(preset, x, y)
            view.check_frame(one)
            p = (Fraction(x), Fraction(y))
            inside, gone = (int(word) for word in one["number"].replace(";", "").split() if word.isdigit())
            assert gone == sum(in_sphere([rows[v] for v in cell], p) > 0 for cell in cells)
            near = [
                sum((a - b) ** 2 for a, b in zip(center, p))
                < min(sum((a - b) ** 2 for a, b in zip(center, row)) for row in rows)
                for center in centers
            ]
            assert inside == sum(near) == gone
            said.add(one["caption"].split()[2])
    assert ("on" in said) == preset.startswith("nasty")
    assert "vertex" in captured_state("nasty: a lattice", 2.5, 2.5)["caption"]


@pytest.mark.parametrize("wrong", [("nowhere", 1, 1), ("twelve sites", 0, 1), ("twelve sites", 1, 5)])
def test_wrong_places_are_refused(wrong):
    with pytest.raises(InputError):
        captured_state(*wrong)


def test_all_searches_fit_the_window_of_the_first():
    """A panel shows all its presets in the window of the first frame."""
    x0, x1, y0, y1 = search_history()[0]["view"]
    for given in INSERTION_CASES.values():
        assert all(x0 < x < x1 and y0 < y < y1 for x, y in [*given["points"], given["P"]])
