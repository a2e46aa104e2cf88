"""A mesh that misses its size says so: asked once more of the size itself, not of a table of it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from unstruct import (
    Domain,
    IncompleteWarning,
    Mesh,
    circumcenter_insertion,
    refine,
    sizing,
    tetrahedralize,
    voronoi_segment,
)
from unstruct.sizing import SizeField, too_large
from unstruct.sizing.asked import MISSED_SIZE, asked_again

BOX = Domain.box()
PLACE = np.array([0.513, 0.487, 0.4567])
Function = Callable[[np.ndarray], np.ndarray]


def away(x: np.ndarray) -> np.ndarray:
    return np.sqrt(((x - PLACE) ** 2).sum(axis=1))


def exhaustive(mesh: Mesh, size: Any, longer: float) -> set[int]:
    """The definition, cell by cell."""
    field = sizing.as_size(size)

    def h(x: np.ndarray) -> float:
        return float(field(x[None])[0])

    found = set()
    shortest: dict[int, float] = {}
    for cell in mesh.simplices.tolist():
        for i, v in enumerate(cell):
            for u in cell[:i]:
                length = float(np.sqrt(((mesh.points[u] - mesh.points[v]) ** 2).sum()))
                shortest[u], shortest[v] = (min(shortest.get(w, np.inf), length) for w in (u, v))
    for t, cell in enumerate(mesh.simplices.tolist()):
        x = mesh.points[cell]
        most = max(float(np.sqrt(((a - b) ** 2).sum())) for a in x for b in x)
        if most > longer * h(x.mean(axis=0)) or any(shortest[v] > longer * h(mesh.points[v]) for v in cell):
            found.add(t)
    return found


@pytest.mark.parametrize("dimension", [2, 3])
def test_cells_are_those_of_the_definition(dimension: int) -> None:
    if dimension == 2:
        mesh: Mesh = refine(Domain.rectangle((0, 0), (1, 1)), 0.15)
    else:
        mesh = tetrahedralize(BOX, 0.4)
    rng = np.random.default_rng(3)
    missed = 0
    for _ in range(6):
        a, b = rng.normal(size=dimension) * 0.1, 0.02 + 0.3 * rng.random()
        growth = float(np.sqrt((a**2).sum()))

        def plane(x: np.ndarray, a: np.ndarray = a, b: float = b) -> np.ndarray:
            return np.maximum((x * a).sum(axis=1) + b, 0.02)

        wanted = exhaustive(mesh, plane, 2.0)
        missed += len(wanted)
        assert set(too_large(mesh, plane, 2.0).cells.tolist()) == wanted
        known = SizeField(plane, growth=growth)
        assert set(too_large(mesh, known, 2.0).cells.tolist()) == wanted, (
            "the proof by growth leaves none out"
        )
    assert missed > 0
    assert len(too_large(mesh, 0.01).cells) == 0, "a number is judged by the methods themselves"


@pytest.mark.parametrize("method", [tetrahedralize, refine, voronoi_segment, circumcenter_insertion])
def test_what_is_seen_late_is_mended_or_told(method: Callable[..., Any]) -> None:
    """A needle of the size that no sample of a table meets, but the middle of a cell does."""
    mesh = method(BOX, 0.3)
    center = mesh.points[mesh.simplices[len(mesh.simplices) // 2]].mean(axis=0)

    def needle(x: np.ndarray) -> np.ndarray:
        return np.where(np.sqrt(((x - center) ** 2).sum(axis=1)) < 0.004, 0.03, 0.3)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IncompleteWarning)
        better = method(BOX, needle)
    assert better.size > mesh.size or not better.complete, "a leaf of a table does not get as small as that"
    field = sizing.as_size(needle)
    missed = too_large(better, field)
    assert set(missed.cells.tolist()) <= set(better.unrefined.tolist()), "complete tells the truth"


def test_what_cannot_be_mended_is_listed() -> None:
    mesh = tetrahedralize(BOX, 0.4)
    with warnings.catch_warnings():
        warnings.simplefilter("error", IncompleteWarning)
        same = asked_again(lambda size: tetrahedralize(BOX, 0.4), lambda x: 0.4 + 0.0 * x[:, 0])
    assert same.complete

    def fine(x: np.ndarray) -> np.ndarray:
        return np.where(away(x) < 0.3, 0.05, 0.4)

    calls = []

    def stubborn(size: Any) -> Any:
        calls.append(len(sizing.as_size(size).landmarks))
        return tetrahedralize(BOX, 0.4)

    found = asked_again(stubborn, fine)
    assert calls[0] == 0 < calls[1] < calls[2] and len(calls) == 3
    assert not found.complete and set(found.reasons.tolist()) == {MISSED_SIZE}
    assert set(found.unrefined.tolist()) == set(too_large(mesh, fine).cells.tolist())
    once = asked_again(stubborn, fine, again=False)
    assert len(calls) == 4 and len(once.unrefined) == len(found.unrefined)


@pytest.mark.parametrize("growth, least", [(0.2, 0.004), (0.5, 0.01), (1.0, 0.02)])
def test_sources_are_met(growth: float, least: float) -> None:
    for size in (sizing.points([PLACE], least, growth=growth, far=0.3), cone(growth, least)):
        mesh = tetrahedralize(BOX, size)
        assert mesh.complete, mesh.reasons
        corners = mesh.points[mesh.simplices]
        near = np.sqrt(((corners.mean(axis=1) - PLACE) ** 2).sum(axis=1)).argmin()
        longest = max(np.sqrt(((a - b) ** 2).sum()) for a in corners[near] for b in corners[near])
        assert longest < 3 * least


def cone(growth: float, least: float) -> Function:
    return lambda x: np.minimum(0.3, least + growth * away(x))


def test_sizes_by_region_are_asked_in_their_regions() -> None:
    left = Domain.rectangle((0, 0), (1, 1))
    both = Domain(
        np.concatenate([left.points, [(2, 0), (2, 1)]]), [(0, 1), (1, 4), (4, 5), (5, 2), (2, 3), (3, 0)],
        inner=[(1, 2)], regions={"left": [(0.5, 0.5)], "right": [(1.5, 0.5)]},
    )  # fmt: skip
    mesh = refine(both, 0.2)
    cells = too_large(mesh, {"left": lambda x: 0.01 + 0.0 * x[:, 0], None: 0.001}).cells
    assert np.array_equal(cells, np.flatnonzero(mesh.markers["region"] == mesh.regions["left"]))
