"""Layers on random bodies, and on those that went wrong once; spoiled surfaces are refused by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import prisms_fuzz, prisms_spoiled
from unstruct import Domain, InputError, Layers, Mesh, check, prismatic_layers

# What was wrong: a vertex without layers among columns all around it was on the base and on the cap.
ONCE_WRONG = [(15, {"cells": "tetrahedron"}), (15, {"cells": "wedge"}), (15, {"stop": "stop"})]


def faultless(row: dict[str, Any]) -> bool:
    return not any(row[fault] for fault in prisms_fuzz.FAULTS)


@pytest.mark.parametrize(("seed", "options"), ONCE_WRONG)
@pytest.mark.filterwarnings("ignore")
def test_seeds_that_were_wrong(seed: int, options: dict[str, Any]) -> None:
    given = prisms_fuzz.task(seed)
    mesh = prismatic_layers(given.domain, layers=given.layers, **given.options | options)
    assert check(mesh) and faultless(prisms_fuzz.judged(mesh))


@pytest.mark.filterwarnings("ignore")
def test_a_few_random_bodies() -> None:
    rows = prisms_fuzz.run(range(4, 10), tell=False)
    made = [row for row in rows if "cells" in row]
    assert len(made) >= 4 and all(map(faultless, made))
    text = prisms_fuzz.summary(rows)
    assert "crossings: 0" in text and "fractions disagree: 0" in text


@pytest.mark.parametrize("seed", range(0, 39, 3))
def test_spoiled_surfaces_are_refused_by_name(seed: int) -> None:
    row = prisms_spoiled.spoiled(seed)
    assert row["named"] and row["error"] in ("InputError", "DomainError"), row


@pytest.mark.parametrize("seed", [27, 144, 872])
def test_a_missing_triangle_is_no_plane_border(seed: int) -> None:
    """Found here: any three points lie in a plane, so that layers ended in that of a missing triangle."""
    row = prisms_spoiled.spoiled(seed)
    assert row["way"] == "missing" and "a loop of 3 edges" in row["text"]


def test_the_judgment_sees_faults() -> None:
    given = prisms_fuzz.task(4)
    mesh = prismatic_layers(given.domain, layers=Layers(first=0.01, growth=1.2, count=3))
    points = mesh.points.copy()
    cap = mesh.steps["cap"]
    points[cap[0, 0]] -= 2.0 * (points[cap[0, 0]] - points.mean(axis=0))
    wrong = type(mesh)(points, None, cells=mesh.cells, steps=mesh.steps, counts=mesh.counts,
                       figures=mesh.figures, faces=mesh.faces, face_piece=mesh.face_piece)  # fmt: skip
    row = prisms_fuzz.judged(wrong)
    assert row["inverted"] > 0 and row["crossings"] > 0 and row["check"]


@pytest.mark.parametrize("cells", ["wedge", "tetrahedron"])
def test_layers_below_the_rounding_of_coordinates_are_refused(cells: str) -> None:
    """Found here: without any layer there was nothing to divide."""
    with pytest.raises(InputError, match="no layer is possible: the thinnest"):
        prismatic_layers(Domain.ball(size=0.5), layers=Layers(first=1e-17, growth=1.2, count=12), cells=cells)


@pytest.mark.parametrize("stop", ["squeeze", "stop"])
def test_layers_of_nested_balls_do_not_pass_each_other(stop: str) -> None:
    """Found here: the caps of a ball and of its cavity had changed places without meeting each other."""
    sizes = (((0, 0, 0), 1.0, 0.5), ((0, 0, 0), 0.5, 0.3), ((0.05, 0, 0), 0.2, 0.15))
    balls = [Domain.ball(center, radius, size=size) for center, radius, size in sizes]
    first = np.cumsum([0, *(len(ball.points) for ball in balls)])
    facets = np.concatenate([np.asarray(ball.facets) + n for ball, n in zip(balls, first)])
    body = Domain(np.concatenate([ball.points for ball in balls]), facets)
    mesh = prismatic_layers(body, layers=Layers(first=0.01, growth=1.2, count=12), side="inside", stop=stop)
    assert check(mesh) and faultless(prisms_fuzz.judged(mesh))


@pytest.mark.parametrize("suffix", [".stl", ".off", ".ply", ".obj", ".vtu"])
def test_surfaces_from_files(suffix: str, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    body, path = Domain.torus(size=0.25), tmp_path / f"torus{suffix}"
    meshio.Mesh(body.points, [("triangle", np.asarray(body.facets))]).write(path)
    layers = Layers(first=0.005, growth=1.2, count=5)
    for surface in (Domain.read(path), Mesh.read(path)):
        mesh = prismatic_layers(surface, layers=layers)
        assert check(mesh) and mesh.counts["wedges"] == 5 * len(body.facets)
