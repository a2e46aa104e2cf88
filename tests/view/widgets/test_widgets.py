"""Widgets: every state over its whole range, both ends and all presets; the shells only pass it on."""

import base64
import json
import zlib
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unstruct import InputError, view
from unstruct.plain import predicates as plain
from unstruct.view.scenes import states
from unstruct.view.scenes.states import CIRCLES, INSERTIONS, SITES

NASTY = "nasty: neighboring doubles"


# ---- the empty circle --------------------------------------------------------------------------


@pytest.mark.parametrize("preset", CIRCLES)
@pytest.mark.parametrize("x", np.linspace(-2, 2, 9))
def test_empty_circle_over_its_whole_range(preset, x):
    for y in np.linspace(-2, 2, 9):
        view.check_frame(view.empty_circle_state(x, y, preset))


@given(st.floats(-2, 2), st.floats(-2, 2))
def test_the_caption_is_the_rational_sign(x, y):
    frame = view.empty_circle_state(x, y)
    triangle = CIRCLES["any triangle"]["triangle"]
    sign = plain.in_sphere([list(map(Fraction, p)) for p in triangle], [Fraction(x), Fraction(y)])
    word = {1: "inside", -1: "outside", 0: "on the circle"}[int(np.sign(sign))]
    assert word in frame["caption"]
    assert frame["items"][0]["role"] == ("cavity" if sign > 0 else "accepted")


def test_the_fourth_corner_of_a_square_is_on_the_circle():
    frame = view.empty_circle_state(-1, 1, "corners of a square")
    assert "on the circle" in frame["caption"] and frame["number"] == "determinant = 0, exact sign 0"


def test_the_nasty_window_tells_wrong_signs_apart():
    """All 1089 doubles: exact by rational numbers, and a large part of the floating-point signs wrong."""
    given_ = CIRCLES[NASTY]
    frame = view.empty_circle_state(0, 0, NASTY)
    marks = {
        i["role"]: i["data"] for i in frame["items"] if i["kind"] == "points" and i["role"] != "inserted"
    }
    assert sum(map(len, marks.values())) == 33**2
    triangle = [list(map(Fraction, p)) for p in given_["triangle"]]
    wrong = 0
    for role, places in marks.items():
        for i, j in places:
            d = [v + k * float(np.spacing(abs(v))) for v, k in zip(given_["origin"], (i, j))]
            sign = int(np.sign(plain.in_sphere(triangle, list(map(Fraction, d)))))
            naive = int(np.sign(states.float_in_circle(np.array(given_["triangle"]), np.array(d))))
            assert role == ("muted" if sign == naive else "waiting" if naive == 0 else "bad")
            wrong += sign != naive
    assert frame["number"].startswith(f"wrong signs here: {wrong} of 1089") and wrong > 300


def test_the_line_of_the_nasty_window_parts_the_exact_signs():
    frame = view.empty_circle_state(2, -2, NASTY)
    ((p, q),) = (i["data"][0] for i in frame["items"] if i["kind"] == "segments")
    triangle, origin = np.array(CIRCLES[NASTY]["triangle"]), np.array(CIRCLES[NASTY]["origin"])
    sides = {-1: set(), 1: set()}
    for i in range(-16, 17):
        for j in range(-16, 17):
            side = (q[0] - p[0]) * (j - p[1]) - (q[1] - p[1]) * (i - p[0])
            if abs(side) > 1e-6 * np.hypot(q[0] - p[0], q[1] - p[1]):
                d = origin + np.array([i, j]) * np.spacing(np.abs(origin))
                sides[int(np.sign(side))].add(int(view.states.in_sphere(triangle, d)))
    assert sorted(map(sorted, sides.values())) == [[-1], [1]]


# ---- the dual ----------------------------------------------------------------------------------


@pytest.mark.parametrize("preset", SITES)
def test_voronoi_dual_over_its_whole_range(preset):
    numbers = set()
    for k in range(11):
        frame = view.voronoi_dual_state(k / 10, preset)
        view.check_frame(frame)
        numbers.add(frame["number"])
    assert len(numbers) == 1
    first, last = view.voronoi_dual_state(0, preset), view.voronoi_dual_state(1, preset)
    strength = lambda frame, role: next(i.get("opacity", 1) for i in frame["items"] if i["role"] == role)  # noqa: E731
    assert strength(first, "voronoi") == 1 > strength(first, "edge")
    assert strength(last, "edge") == 1 > strength(last, "voronoi")


@pytest.mark.parametrize(
    ("preset", "number"),
    [
        ("lattice: four on each circle", "8 triangles, 4 corners"),
        ("three neighbors, no triangle", "3 triangles, 3 corners"),
        ("vertices outside their triangles", "2 triangles, 2 corners, 1 outside its triangle"),
    ],
)
def test_the_presets_show_what_they_promise(preset, number):
    assert view.voronoi_dual_state(0.5, preset)["number"] == number


def test_the_false_triangle_is_no_delaunay_triangle():
    """Its three sites are neighbors in pairs, and yet its circle holds the fourth."""
    from unstruct import voronoi

    diagram = voronoi(SITES["three neighbors, no triangle"])
    assert {(0, 1), (0, 2), (1, 2)} <= {tuple(sorted(p)) for p in diagram.ridge_points.tolist()}
    assert [0, 1, 2] not in np.sort(diagram.mesh.simplices, axis=1).tolist()


# ---- Bowyer and Watson -------------------------------------------------------------------------


@pytest.mark.parametrize("preset", INSERTIONS)
def test_bowyer_watson_steps_through_its_whole_history(preset):
    history = view.bowyer_watson_history(preset)
    for k in range(len(history)):
        assert view.bowyer_watson_state(k, preset) == history[k]
        view.check_frame(history[k])
    for wrong in (-1, len(history)):
        with pytest.raises(InputError, match="step"):
            view.bowyer_watson_state(wrong, preset)


def test_the_nasty_start_has_triangles_that_lie_apart():
    assert any("apart" in f["caption"] for f in view.bowyer_watson_history("nasty: not Delaunay at first"))


@pytest.mark.parametrize(
    "call",
    [
        lambda: view.empty_circle_state(3, 0),
        lambda: view.empty_circle_state(float("nan"), 0),
        lambda: view.empty_circle_state(0, 0, "no such"),
        lambda: view.voronoi_dual_state(1.1),
        lambda: view.voronoi_dual_state(0.5, "no such"),
        lambda: view.bowyer_watson_state(0, "no such"),
    ],
)
def test_values_out_of_range_are_refused(call):
    with pytest.raises(InputError):
        call()


# ---- the shells --------------------------------------------------------------------------------


def test_a_shell_has_presets_and_a_described_picture():
    panel = view.bowyer_watson()
    assert len(panel.player.variants) > 1 and not panel.controls and panel.player.alt.endswith(".")
    assert panel.children == (panel.player,)
    assert len(repr(panel)) < 160 and panel.player.alt in repr(panel)


@pytest.mark.parametrize(
    ("make", "controls", "said"),
    [
        (view.cavity_argument, ["angle APC", "angle ADC", "place of P"], "ABC goes, and D is not"),
        (view.new_triangle_argument, ["the edge AB is", "place of P", "direction of D"], "D on P's side"),
    ],
)
def test_the_two_arguments_move_without_a_kernel(make, controls, said):
    """All frames are stored, none says that the theorem fails, and points can be dragged."""
    panel = make()
    assert [one["label"] for one in panel.grid] == controls and panel.alt.endswith(".")
    assert said in panel.frames[0]["caption"] and panel.packed
    whole = zlib.decompress(base64.b64decode(panel.packed)).decode()
    count = int(np.prod([len(one["values"]) for one in panel.grid]))
    assert len(json.loads(whole)["histories"]) == count <= 3000
    assert "IMPOSSIBLE" not in whole and '"handles"' in whole


def test_stepped_shells_hold_all_presets_and_need_no_kernel():
    panel = view.bowyer_watson()
    assert [v["name"] for v in panel.player.variants] == list(INSERTIONS) and not panel.controls
    assert [len(v["frames"]) for v in panel.player.variants] == [
        len(view.bowyer_watson_history(n)) for n in INSERTIONS
    ]
