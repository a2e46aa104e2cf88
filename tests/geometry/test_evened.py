"""Coordinates for searches by boxes: nothing that meets is missed, and needles at an angle are told apart."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from unstruct.geometry.boxes import BoxTree, bounding_boxes
from unstruct.geometry.evened import WORTH_EVENING, evened


def needles(seed: int, ratio: float, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Points of a box that is thin in a turned direction, and random edges between them."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    x = rng.random((count, 3)) @ (turn * [1.0, 1.0, 1.0 / ratio]) @ turn.T
    return x / np.abs(x).max(), rng.integers(0, count, (3 * count, 2))


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10**6), decades=st.floats(0.0, 7.0))
def test_images_are_those_of_one_map(seed: int, decades: float) -> None:
    """By fractions: four points fix the map, and all others are where it says, up to the slack."""
    x, edges = needles(seed, 10.0**decades)
    image, slack = evened(x, edges)
    if (slack == 0).all():
        assert image is x
        return
    # the map is triangular: coordinate k of an image hangs on the first k + 1 coordinates alone
    base = [[Fraction(v) for v in row] for row in x[:4].tolist()]
    to = [[Fraction(v) for v in row] for row in image.tolist()]
    a = (to[1][0] - to[0][0]) / (base[1][0] - base[0][0])
    for row, there in zip(x.tolist(), to):
        assert abs(float(there[0] - to[0][0] - a * (Fraction(row[0]) - base[0][0]))) <= 1e3 * slack[0]


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10**6), decades=st.floats(0.0, 6.0))
def test_no_meeting_is_missed(seed: int, decades: float) -> None:
    """Triangles that share a point have boxes that meet, enlarged by the slack."""
    x, edges = needles(seed, 10.0**decades)
    image, slack = evened(x, edges)
    triangles = np.random.default_rng(seed).permutation(39).reshape(-1, 3)
    low, high = bounding_boxes(image[triangles])
    tree = BoxTree(low - slack, high + slack)
    # edges that end in the middle of an edge of a triangle, up to rounding
    for t, (a, b, _) in enumerate(triangles.tolist()):
        there = (x[a] + x[b]) / 2
        both, _ = evened(np.vstack([x, there]), edges)
        _, hit = tree.pairs(both[-1:], both[-1:])
        assert t in hit


def test_usual_edges_stay_and_needles_are_apart() -> None:
    x, edges = needles(1, 1.0)
    assert evened(x, edges)[0] is x
    assert evened(x, edges[:0])[0] is x
    assert evened(x, np.zeros((3, 2), dtype=int))[0] is x
    rng = np.random.default_rng(0)
    start = rng.random((2000, 3))
    line = np.array([0.6, 0.64, 0.48]) * 0.3
    x = np.concatenate([start, start + line + 1e-3 * rng.normal(size=(2000, 3))]) / 2
    edges = np.column_stack([np.arange(2000), 2000 + np.arange(2000)])
    image, slack = evened(x, edges)
    assert (slack > 0).all()
    pairs = []
    for place in (x, image):
        boxes = bounding_boxes(place[edges])
        pairs.append(len(BoxTree(*boxes).pairs(*boxes)[0]))
    assert pairs[0] > WORTH_EVENING * pairs[1]
