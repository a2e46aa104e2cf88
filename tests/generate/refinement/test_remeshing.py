"""Meshes as the start of a refinement where exponents are wide: slivers, and edges short beside others."""

from __future__ import annotations

import fuzz_work
import numpy as np
import pytest

import unstruct
from unstruct import Domain, Mesh, check, constrained_delaunay, refine
from unstruct.generate.refinement.remeshing import chains

SLIVERS = {  # areas of cells are only rounding; in the last one, so is that of the whole
    "beside a needle": [
        (1.2739076319261916e-103, -1.9999959459321568), (0.0, 0.0), (-1.0, -2.000002095592677),
        (0.0, 6.8607648374326044e-46),
    ],
    "needle": [(0.0, 0.0), (0.0, -1.4291381513037146e-288), (-4.93e-91, -8.36e-91)],
    "of last bits": [(0.1, 0.1), (0.3, np.nextafter(0.3, 1)), (0.7, 0.7)],
}  # fmt: skip


@pytest.mark.parametrize("name", SLIVERS)
def test_meshes_of_slivers(name: str) -> None:
    """Found by fuzzing: "cells of the mesh overlap", since their areas in doubles did not add up."""
    domain = Domain.polygon(SLIVERS[name])
    first = refine(domain, min_angle=20, budget=100)
    for mesh in (constrained_delaunay(domain), first):
        again = refine(mesh, min_angle=20, budget=200)
        assert check(again, domain=domain, delaunay="constrained")
        assert fuzz_work.promises(again, 20, None) == ""
        assert (np.diff(again.span, axis=1) > 0).all()


def test_cells_that_overlap_are_still_found() -> None:
    """A closed strip of triangles around a point, twice: no edges cross, but the area is too large."""
    turn = np.arange(8) * (np.pi / 2)
    points = np.concatenate(
        [[[0.0, 0.0]], np.column_stack([np.cos(turn), np.sin(turn)]) * np.repeat([1, 2], 4)[:, None]]
    )
    rim = np.arange(1, 9)
    cells = np.column_stack([np.zeros(8, dtype=int), rim, np.roll(rim, -1)])
    with pytest.raises(unstruct.UnstructError, match=r"overlap|cross|lies on|check"):
        refine(Mesh(points, cells), min_angle=20)


@pytest.mark.parametrize("short", [1e-30, 1e-200, 5e-324])
def test_chains_of_very_unequal_edges(short: float) -> None:
    points = np.array([(-1.0, 0.0), (0.0, 0.0), (short, 0.0), (2.0, 0.0), (2.0, 1.0)])
    edges = np.array([(0, 1), (2, 1), (2, 3), (3, 4)], dtype=np.int32)
    ends, chain, span, flipped = chains(points, edges, np.zeros((4, 1), dtype=bool))
    assert (span[:, 0] < span[:, 1]).all() and len(
        set(chain.tolist())
    ) == 4  # not one, which could not tell them
    assert (np.sort(ends, axis=1) == np.sort(edges, axis=1)).all()
    assert (ends[flipped] == edges[flipped][:, ::-1]).all()


def test_right_angles_of_tiny_edges_are_no_chains() -> None:
    """Products of their directions are 0 in doubles."""
    points = np.array([(0.0, 0.0), (1e-200, 0.0), (1e-200, 1e-200), (0.0, 1e-200)])
    edges = np.array([(0, 1), (1, 2), (2, 3), (3, 0)], dtype=np.int32)
    _, chain, span, _ = chains(points, edges, np.zeros((4, 1), dtype=bool))
    assert len(set(chain.tolist())) == 4 and (span == [0.0, 1.0]).all()
    middle = np.insert(points, 1, (5e-201, 0.0), axis=0)
    edges = np.array([(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)], dtype=np.int32)
    _, chain, span, _ = chains(middle, edges, np.zeros((5, 1), dtype=bool))
    assert len(set(chain.tolist())) == 4 and chain[0] == chain[1]
    assert np.sort(span[:2].ravel()) == pytest.approx([0, 0.5, 0.5, 1])
