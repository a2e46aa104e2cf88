"""Rebay's step and cobweb: every state over its whole range; the shells only pass it on."""

import re
from itertools import product
from math import hypot, isclose, sqrt

import numpy as np
import pytest

from unstruct import InputError
from unstruct.plain import rebay
from unstruct.plain import rebay_step as rs
from unstruct.predicates.batch import in_sphere
from unstruct.view import check_frame
from unstruct.view.scenes import rebay as rb
from unstruct.view.scenes.rebay_history import rebay_frames
from unstruct.view.widgets.rebay_widgets import by_corner, rebay_cobweb, rebay_step


def points(frame, role):
    return [tuple(p) for i in frame["items"] if (i["kind"], i["role"]) == ("points", role) for p in i["data"]]


# ---- one step ------------------------------------------------------------------------------------


@pytest.mark.parametrize("preset", rb.FRONT_EXAMPLES)
def test_the_step_over_its_whole_range(preset):
    for f, q in product(np.linspace(*rb.F_RANGE, 12), np.linspace(*rb.Q_RANGE, 14)):
        frame = rb.voronoi_segment_state(f, q, preset)
        check_frame(frame)
        (x,), (_, center), caption = points(frame, "inserted"), points(frame, "voronoi"), frame["caption"]
        assert isclose(center[1], -q, rel_tol=1e-9) and -q - 1e-9 <= x[1] < 0 == x[0]
        a, b, c, d = map(np.array, points(frame, "vertex"))
        assert isclose(hypot(*(d - center)), hypot(1, q), rel_tol=1e-9)
        assert d[1] < 0
        if in_sphere(np.array([a, b, c]), d) > 0:
            assert "not Delaunay" in caption
            continue
        assert caption.endswith("AB is deleted") == bool(in_sphere(np.array([a, b, c]), np.array(x)) > 0)
        assert ("beyond F" in caption) == (q < 1 - 1e-12)
        if "radius f" in caption or "right angle" in caption:
            assert isclose(-x[1], rs.distance(max(f, 1.0), 1.0), rel_tol=1e-9)
        else:
            assert isclose(-x[1], q, rel_tol=1e-9)


@pytest.mark.parametrize(
    ("preset", "caption", "number"),
    [
        ("a short edge: p < f", "the circle AXB has the radius f", "d = 1.56, q = 1.80, angle AXB = 65°"),
        ("a long edge: p > f", "f < p: the smallest circle, with a right angle at X", "angle AXB = 90°"),
        ("the cap is active", "f is too large for this triangle: X = F", "d = 1.50, q = 1.50"),
        ("q < p: d is beyond F", "q < p: d leads beyond F, so stop at F", "d = 1.00, q = 0.75"),
        ("nasty: AB is deleted", "X is in circle ABC, so AB is deleted", "d = 1.00, q = 1.60"),
    ],
)
def test_the_presets_show_what_they_promise(preset, caption, number):
    given_ = rb.FRONT_EXAMPLES[preset]
    frame = rb.voronoi_segment_state(given_["f"], given_["q"], preset)
    assert caption in frame["caption"] and number in frame["number"]


# ---- the cobweb ----------------------------------------------------------------------------------


@pytest.mark.parametrize("growth", np.linspace(*rb.GROWTH, 16))
def test_the_cobweb_over_its_whole_range(growth):
    for start in np.linspace(*rb.START, 11):
        frame = rb.cobweb_state(growth, start, measured=[(0.1, -0.05), (5, 5)])
        check_frame(frame)
        web = next(i for i in frame["items"] if (i["kind"], i["role"]) == ("segments", "inserted"))["data"]
        x = start
        for across in web[0::2]:
            assert isclose(across[0][0], rs.epsilon(x, 1.0), abs_tol=1e-9)
            x = rs.next_ratio(x, growth)
            assert isclose(across[1][1], rs.epsilon(x, 1.0), abs_tol=1e-9)
        assert len(web) == 2 * rb.COBWEB_STEPS
        assert points(frame, "accepted") == ([(0.1, -0.05)] if abs(growth - 1) < 1e-9 else [])
        if growth < sqrt(0.5):
            assert "without bound" in frame["caption"]
        if growth > 0.95:  # above 0.8995 every start comes to rest; near it, slowly
            assert "tend to one shape" in frame["caption"]


def test_the_slope_is_half_for_constant_size_and_the_tangent_has_it():
    frame = rb.cobweb_state(1.0, 0.55)
    assert frame["number"].endswith("slope at ε* -0.500")
    tangent = next(i for i in frame["items"] if i["role"] == "circumcircle")["data"][0]
    (x0, y0), (x1, y1) = tangent
    assert isclose((y1 - y0) / (x1 - x0), -0.5) and isclose(x0 + x1, 0, abs_tol=1e-12)


@pytest.mark.parametrize(
    ("preset", "caption"),
    [
        ("constant size", "one shape"),
        ("f grows by a quarter", "one shape"),
        ("f shrinks: a start near the fixed point", "one shape"),
        ("the same, a start from afar", "two shapes in turn"),
        ("f shrinks: nothing is stable", "no convergence"),
        ("nasty: f shrinks faster than p", "without bound"),
    ],
)
def test_the_fates(preset, caption):
    assert caption in rb.cobweb_state(*rb.COBWEBS[preset])["caption"]


# ---- the chain -----------------------------------------------------------------------------------


@pytest.mark.parametrize("growth", [0.7, 0.87, 1.0, 1.2])
def test_the_chain_is_the_map(growth):
    frame = rb.chain_frame(0.55, growth, 9)
    check_frame(frame)
    triangles = np.array(next(i for i in frame["items"] if i["kind"] == "polygons")["data"])
    x = 0.55
    for k, (a, b, c) in enumerate(triangles):
        f = growth**k
        assert isclose(np.linalg.norm(b - a) / 2 / f, x, rel_tol=1e-9)
        assert isclose(np.linalg.norm(c - a), np.linalg.norm(c - b), rel_tol=1e-9)
        x = rs.next_ratio(x, growth)
    last = float(re.findall(r"([\d.]+)° at last", frame["number"])[0])
    assert growth != 1 or abs(last - 60) < 0.2


# ---- the shells ----------------------------------------------------------------------------------


def test_the_panel_of_the_step_shows_its_states():
    """Without a kernel: all states are computed, the handles F and X can be dragged, both ends are there."""
    made = rebay_step()
    corners, radii, ways = (one["values"] for one in made.grid)
    assert [corners[0], radii[0], radii[-1], ways[0], ways[-1]] == ["acute at C", "0.3", "2", "0.1", "2"]
    (shown,), wanted = made.frames, rb.voronoi_segment_state(1.1, 1.8)
    assert (shown["caption"], shown["number"]) == (wanted["caption"], wanted["number"])
    handles = [h for item in shown["items"] for h in item.get("handles", [])]
    assert sorted(handles) == ["F", "X"] and made.alt.endswith(".") and len(made.packed) < 100_000
    nasty = by_corner("nasty: obtuse at C", 0.3, 2.0)
    assert nasty == rb.voronoi_segment_state(0.3, 2.0, "nasty: AB is deleted")


def test_the_panel_of_the_cobweb_has_both_thresholds():
    made = rebay_cobweb(measured=[(0.2, -0.08)])
    factors, starts = ([float(v) for v in one["values"]] for one in made.grid)
    assert min(factors) < sqrt(0.5) < 0.88 in factors and 1.0 in factors  # diverging, two ends, constant
    assert (starts[0], starts[-1]) == rb.START and 0.9 in starts and 0.8 in starts  # both ends at 0.88
    (shown,), wanted = made.frames, rb.cobweb_state(1.0, 0.55, [(0.2, -0.08)])
    assert (shown["caption"], shown["number"]) == (wanted["caption"], wanted["number"])
    assert [h for item in shown["items"] for h in item.get("handles", [])] == ["start"]


@pytest.mark.parametrize(
    "call",
    [
        lambda: rb.voronoi_segment_state(0.1, 1.0),
        lambda: rb.voronoi_segment_state(1.0, float("nan")),
        lambda: rb.voronoi_segment_state(1.0, 1.0, "no such"),
        lambda: rb.cobweb_state(0.1, 1.0),
        lambda: rb.cobweb_state(1.0, 9.0),
        lambda: rb.chain_frame(count=0),
        lambda: rb.chain_frame(0.8, 0.1, 80),
    ],
)
def test_values_out_of_range_are_refused(call):
    with pytest.raises(InputError):
        call()


# ---- a run ---------------------------------------------------------------------------------------


def test_the_frames_of_a_run_count_what_happens():
    """A square with two points on each side: every frame can be drawn, and the last has nothing waiting."""
    points = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    segments = [(k, (k + 1) % 8) for k in range(8)]
    judge = lambda p, c: rebay.is_accepted(p, c, lambda x: 0.55, 1.35)  # noqa: E731
    cells, _ = rebay.start(points, segments)
    history = list(rebay.voronoi_segment(points, segments, lambda x: 0.55))
    frames = rebay_frames(points, cells, history, judge, cavities=2)
    assert len(frames) == 1 + 2 * len(history) + min(2, len(history)) and len(history) >= 1
    for frame in frames:
        check_frame(frame)
    assert frames[0]["number"] == "4 accepted, 2 waiting" and frames[-1]["number"].endswith(" 0 waiting")
    gone = next(i for i in frames[2]["items"] if i["role"] == "cavity")["data"]
    assert len(gone) == len(history[0].cavity) and str(len(gone)) in frames[2]["number"]
