"""The plain rules for the next point of a front: their defining properties, and what the fast front does."""

from __future__ import annotations

from math import dist, pi, radians, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import unstruct
from unstruct import InputError
from unstruct.plain import front_points as rules
from unstruct.view.scenes.fronts import fronts_of

coordinate = st.floats(-3, 3)
point = st.tuples(coordinate, coordinate)


@given(point, point, st.floats(0.01, 5))
def test_equal_sides(a: tuple, b: tuple, h: float) -> None:
    length = dist(a, b)
    if length < 1e-6:
        return
    x = rules.equal_sides(a, b, h)
    side = min(max(h, 0.55 * length), 2 * length)
    assert dist(x, a) == pytest.approx(side, rel=1e-6) == dist(x, b)
    assert unstruct.predicates.orient(np.array([a, b, x])) == 1


@given(point, point, st.floats(0.01, 5))
def test_on_circle(a: tuple, b: tuple, h: float) -> None:
    length = dist(a, b)
    if length < 1e-6:
        return
    x = rules.on_circle(a, b, h)
    radius = unstruct.simplex.circumradius(np.array([a, b, x]))
    assert radius == pytest.approx(max(h / sqrt(3), length / 2), rel=1e-5)
    assert dist(x, a) == pytest.approx(dist(x, b), rel=1e-6)


@given(st.floats(0.1, 360))
def test_parts_are_the_nearest_to_sixty_degrees(degrees: float) -> None:
    k = rules.parts(radians(degrees))
    far = [abs(degrees / j - 60) for j in range(1, 12)]
    assert far[k - 1] == pytest.approx(min(far), abs=1e-9)


def test_parts_change_at_these_angles() -> None:
    for k in range(1, 6):
        switch = radians(120 * k * (k + 1) / (2 * k + 1))
        assert (rules.parts(switch * (1 - 1e-12)), rules.parts(switch * (1 + 1e-12))) == (k, k + 1)


def test_by_angle_connects_bisects_trisects() -> None:
    a, b = (0.0, 0.0), (1.0, 0.0)
    far = (-0.9, 0.1)  # before A: an angle of nearly 180 degrees
    for degrees, part in ((60, 1), (79, 1), (81, 2), (143, 2), (145, 3)):
        n = (1 - np.cos(radians(degrees)), np.sin(radians(degrees)))
        x = rules.by_angle(far, a, b, n, 1.0)
        assert rules.angle_at(a, b, n) == pytest.approx(radians(degrees))
        if part == 1:
            assert x == n
        else:
            assert dist(b, x) == pytest.approx(1) and rules.angle_at(a, b, x) == pytest.approx(
                radians(degrees / part)
            )
    reflex = (2.0, -0.5)
    assert rules.by_angle((-1.0, -0.5), a, b, reflex, 1.0) == rules.equal_sides(a, b, 1.0)
    mirrored = rules.by_angle((0.3, 0.9), a, b, (1.9, 0.1), 1.0)
    assert mirrored == (0.3, 0.9)


def test_angles_of_dangling_edges() -> None:
    assert rules.angle_at((0, 0), (1, 0), (0, 0)) == 2 * pi  # the end of a crack
    with pytest.raises(InputError, match="same point"):
        rules.equal_sides((1, 1), (1, 1), 0.2)


@pytest.mark.parametrize("placement", ["equal sides", "circle", "angle"])
def test_the_fast_front_wants_the_same_points(placement: str) -> None:
    """Wherever its ideal point was not moved toward the circumcenter, it is that of the plain rule."""
    domain = unstruct.Domain.polygon([(0, 0), (3, 0), (3.4, 1.2), (2.6, 2.4), (1.5, 1.4), (0.2, 2.2)])
    mesh = unstruct.advancing_front(domain, 0.31, placement=placement, finish=False, history=True)
    steps, same, compared = mesh.steps, 0, 0
    assert steps is not None
    x = mesh.points
    for i, front in enumerate(fronts_of(mesh)):
        if i == mesh.size or steps["reason"][i] != "new point":
            continue
        a, b = steps["edge"][i].tolist()
        before, after = front[front[:, 1] == a, 0], front[front[:, 0] == b, 1]
        if len(before) != 1 or len(after) != 1:
            continue
        p, a, b, n = (tuple(x[v]) for v in (int(before[0]), a, b, int(after[0])))
        h = float(steps["size"][i])
        rule = {"equal sides": rules.equal_sides, "circle": rules.on_circle}.get(placement)
        wanted = rules.by_angle(p, a, b, n, h) if rule is None else rule(a, b, h)
        compared += 1
        same += np.allclose(wanted, steps["ideal"][i], atol=1e-12)
    assert compared > 40 and same >= 0.6 * compared


@pytest.mark.parametrize("placement", ["equal sides", "circle"])
def test_the_corner_ahead_is_taken_as_the_fast_front_takes_it(placement: str) -> None:
    domain, rule = unstruct.examples.running_region(0.08), rules.equal_sides
    rule = rules.on_circle if placement == "circle" else rule
    options = {"placement": placement, "finish": False, "history": True}
    mesh = unstruct.advancing_front(unstruct.Domain(*domain), 0.08, **options)
    seen = dict.fromkeys(("small enough", "empty circle", "near apex"), 0)
    for edge, apex, reason in zip(*(mesh.steps[key] for key in ("edge", "apex", "reason"))):
        if reason in seen:
            a, b, c = (tuple(mesh.points[v].tolist()) for v in (*edge, apex))
            assert rules.ahead(a, b, c, 0.08, rule) == (reason, c)
            seen[str(reason)] += 1
    assert seen["small enough"] > 10 and seen["near apex"] > 100


def test_a_wish_is_moved_back_and_never_forward() -> None:
    a, b = (0.0, 0.0), (1.0, 0.0)
    assert rules.ahead(a, b, (0.5, 3.0), 1.0) == ("new point", pytest.approx((0.5, sqrt(0.75))))
    low = rules.ahead(a, b, (1.4, 0.8), 1.0)  # q is below the wish: the circumcenter
    center = unstruct.simplex.circumcenter(np.array([a, b, (1.4, 0.8)]))
    assert low == ("new point", pytest.approx((0.5, float(center[1]))))
    short = rules.ahead(a, b, (0.5, 3.0), 0.5)  # the wish is nearer than a quarter of the edge
    assert short == ("new point", pytest.approx((0.5, sqrt(0.55**2 - 0.25))))
