"""The panel of a metric over its whole range."""

from __future__ import annotations

from itertools import product

import numpy as np

from unstruct.view import check_frame
from unstruct.view.scenes.metric_states import (
    METRIC_ACROSS,
    METRIC_ALONG,
    METRIC_EDGE,
    METRIC_TURNS,
    metric_state,
)


def length(metric: np.ndarray, v: np.ndarray) -> float:
    return float(np.sqrt(v @ metric @ v))


def test_the_whole_range_of_the_metric() -> None:
    words = set()
    for turn, along, across in product(METRIC_TURNS, METRIC_ALONG, METRIC_ACROSS):
        one = metric_state(turn, along, across)
        check_frame(one)
        t = np.radians(turn)
        d = np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]])
        metric = d.T @ np.diag([along**-2.0, across**-2.0]) @ d
        ellipse = np.asarray(one["items"][0]["data"][0])
        assert np.allclose([length(metric, v) for v in ellipse], 1)
        triangle = np.asarray(one["items"][2]["data"][0])
        assert np.allclose([length(metric, triangle[k] - triangle[k - 1]) for k in range(3)], 1)
        assert f"length {length(metric, np.array(METRIC_EDGE)):.2f}" in one["caption"]
        words.add(one["caption"].split(": ")[1])
    assert words == {"too long", "too short", "about as wanted"}
