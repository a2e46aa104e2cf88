"""Every public method in units far from one: the same result in the new unit, without a warning, or an error.

A power of two as a unit changes no digit, so that the results can be compared as they are.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import unstruct as u
from unstruct import UnstructError, sizing, studies

POINTS = np.array(
    [(0, 0), (1, 0), (1.25, 0.7), (1, 1), (0.4, 0.75), (0, 1),
     (0.2, 0.2), (0.3, 0.2), (0.3, 0.35), (0.6, 0.5), (0.8, 0.6)], dtype=float,
)  # fmt: skip
FACETS = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (6, 7), (7, 8), (8, 6)]
CROSSING = [(0, 2), (2, 5), (5, 1), (1, 4), (4, 3), (3, 0)]
CLOUD = np.random.default_rng(0).random((60, 2))
SPACE = np.random.default_rng(1).random((40, 3))
BOX = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)


def straight(s: float) -> u.Domain:
    """A pentagon with a bend, a hole and an inner segment."""
    named = {"markers": {"b": [0, 1]}, "regions": {"r": (0.05 * s, 0.5 * s)}}
    return u.Domain(POINTS * s, FACETS, inner=[(9, 10)], **named)


def curved(s: float) -> u.Domain:
    """The same with an arc."""
    arc = u.Arc.through(np.array((0, 1.0)) * s, np.array((-0.2, 0.5)) * s, (0.0, 0.0))
    return u.Domain(POINTS[:9] * s, FACETS, curves={5: arc})


def spline(s: float) -> u.Domain:
    """Another with a Bezier curve."""
    curve = u.Bezier(np.array([(0, 1), (-0.3, 0.5), (0, 0)]) * s)
    return u.Domain(POINTS[:6] * s, FACETS[:6], curves={5: curve})


def graded(s: float) -> Callable[[np.ndarray], np.ndarray]:
    """A size that grows."""
    return lambda x: 0.1 * s + 0.1 * np.hypot(*x.T)


def metric(s: float) -> sizing.Metric:
    """A size with a direction."""
    return sizing.directional((1.0, 0.0), 0.3 * s, 0.2 * s)


def right_of(s: float) -> Callable[..., np.ndarray]:
    """Which triangles to refine."""
    return lambda corners, areas, regions: corners[:, :, 0].max(axis=1) > 1.2 * s


def coarse(s: float) -> u.DomainMesh:
    """A mesh to start from."""
    return u.refine(straight(s), 0.2 * s)


METHODS: dict[str, Callable[[float], Any]] = {
    "delaunay": lambda s: u.delaunay(CLOUD * s),
    "delaunay in space": lambda s: u.delaunay(SPACE * s),
    "gift_wrap": lambda s: u.gift_wrap(CLOUD * s),
    "insert": lambda s: u.insert(u.delaunay(CLOUD[:30] * s), CLOUD[40] * s),
    "voronoi": lambda s: u.voronoi(CLOUD * s).vertices / s,
    "clip": lambda s: np.concatenate(u.voronoi(CLOUD * s).clip(BOX * s)) / s,
    "relax": lambda s: u.voronoi(CLOUD * s).relax(clip=BOX * s).voronoi.points / s,
    "interpolate": lambda s: u.interpolate(u.delaunay(CLOUD * s), CLOUD[:, 0], CLOUD[:9] * s / 2 + s / 4),
    "constrained": lambda s: u.constrained_delaunay(straight(s)),
    "conforming": lambda s: u.conforming_delaunay(straight(s), 0.3 * s),
    "refine": lambda s: u.refine(straight(s), 0.2 * s, history=True),
    "refine, graded": lambda s: u.refine(straight(s), graded(s)),
    "refine, curved": lambda s: u.refine(curved(s), 0.2 * s),
    "refine, ruppert": lambda s: u.refine(straight(s), 0.2 * s, method="ruppert"),
    "refine_if": lambda s: u.refine(straight(s), refine_if=right_of(s), budget=99),
    "refine again": lambda s: u.refine(coarse(s), 0.15 * s),
    "circumcenters": lambda s: u.circumcenter_insertion(straight(s), 0.2 * s),
    "voronoi_segment": lambda s: u.voronoi_segment(straight(s), 0.2 * s),
    "voronoi_segment, graded": lambda s: u.voronoi_segment(curved(s), graded(s), history=True),
    "advancing_front": lambda s: u.advancing_front(spline(s), 0.2 * s),
    "advancing_front, graded": lambda s: u.advancing_front(straight(s), graded(s), history=True),
    "classical front": lambda s: u.advancing_front(straight(s), 0.2 * s, method="classical"),
    "front in a metric": lambda s: u.advancing_front(straight(s), metric(s)),
    "front_delaunay": lambda s: u.front_delaunay(straight(s), 0.2 * s),
    "front_delaunay, points": lambda s: u.front_delaunay(straight(s), (CLOUD[:5] * 0.2 + 0.05) * s),
    "layers": lambda s: u.advancing_layers(
        straight(s), 0.2 * s, layers=u.Layers(first=0.01 * s, growth=1.3, count=3), walls=["b"]
    ),
    "smooth": lambda s: u.smooth(coarse(s), "laplace"),
    "smooth, search": lambda s: u.smooth(coarse(s), "search"),
    "swap_diagonals": lambda s: u.swap_diagonals(coarse(s)),
    "second_order": lambda s: u.second_order(u.refine(curved(s), 0.3 * s)).points / s,
    "sampled": lambda s: curved(s).sampled(0.2 * s).points / s,
    "simplified": lambda s: u.Domain.polygon(POINTS[:6] * s).simplified(0.01 * s).points / s,
    "spaced": lambda s: u.refine(straight(s).spaced({"b": u.Spacing(first=s / 20, last=s / 10)}), 0.3 * s),
    "resolved": lambda s: u.Domain(POINTS * s, CROSSING, resolve=True).points / s,
    "contains": lambda s: straight(s).contains(CLOUD * s),
    "skeleton": lambda s: studies.skeleton_points(straight(s), 0.3 * s).mesh,
    "angles": lambda s: coarse(s).quality("min_angle"),
    "roundness": lambda s: coarse(s).quality("2r/R"),
    "statistics": lambda s: str(u.statistics(coarse(s), 0.2 * s)),
    "statistics in a metric": lambda s: str(u.statistics(coarse(s), metric(s))),
    "checked": lambda s: bool(u.check(u.voronoi_segment(curved(s), 0.3 * s), domain=curved(s))),
    "checked spline": lambda s: bool(u.check(u.refine(spline(s), 0.3 * s), domain=spline(s))),
    "find_simplex": lambda s: coarse(s).find_simplex(CLOUD * s),
    "from_features": lambda s: u.refine(straight(s), sizing.from_features(straight(s), 1.0, far=0.3 * s)),
    "from_curvature": lambda s: sizing.from_curvature(curved(s), far=0.3 * s)(CLOUD * s) / s,
    "sources": lambda s: sizing.lines(BOX[:2] * s, 0.1 * s, far=0.3 * s)(CLOUD * s) / s,
    "background": lambda s: sizing.background(coarse(s), sizing.mesh_size(coarse(s)))(CLOUD * s) / s,
    "limit_nodes": lambda s: sizing.limit_nodes(coarse(s), sizing.mesh_size(coarse(s)), 0.01) / s,
    "local_feature_size": lambda s: sizing.local_feature_size(straight(s), CLOUD * s) / s,
}  # fmt: skip
# These need squares of lengths as doubles, and say so.
LIMITED = {"front in a metric", "layers", "statistics in a metric"}


def _plain(result: Any, s: float) -> list[Any]:
    if isinstance(result, u.Mesh):
        cells = [np.asarray(block) for block in result.cells.values()]
        return [result.points / s, *cells]
    return [result]


@pytest.mark.parametrize("name", METHODS)
def test_units(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", u.IncompleteWarning)
        usual = _plain(METHODS[name](1.0), 1.0)
        for exponent in (-1000, -600, -300, 300, 530, 1000):
            unit = 2.0**exponent
            try:
                found = _plain(METHODS[name](unit), unit)
            except UnstructError as error:
                assert name in LIMITED, error
                assert "scale" in str(error)
                continue
            assert len(found) == len(usual)
            for one, two in zip(found, usual):
                if isinstance(one, np.ndarray) and one.dtype.kind == "f":
                    np.testing.assert_allclose(one, two, rtol=1e-9, atol=1e-12)
                else:
                    assert np.array_equal(one, two), exponent


@pytest.mark.parametrize(
    "method",
    [u.refine, u.circumcenter_insertion, u.voronoi_segment, u.advancing_front, u.front_delaunay],
)
def test_vertices_that_doubles_cannot_tell_apart(method: Callable[..., u.DomainMesh]) -> None:
    tiny = 1e-310
    domain = u.Domain.polygon(np.array([(0, 0), (7, 0), (5, 6), (1, 3)]) * tiny)
    with pytest.raises(UnstructError, match="scale the domain"):
        method(domain, 2 * tiny)
    assert u.check(u.constrained_delaunay(domain))
