"""The suite ``volume`` on small bodies: its surfaces, its machine parts (also through STL), its measures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from suites import no_processes

from benchmarks import (
    __main__,
    bodies,
    parts,
    solids,
    volume,
    volume_meshers,
    volume_quality,
    volume_report,
)
from unstruct import Domain, check, tetrahedralize

TETRAHEDRON = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]], dtype=np.int32)


def lengths(domain: Domain) -> np.ndarray:
    corners = domain.points[domain.triangulated.triangles]
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).ravel()


@pytest.mark.parametrize("name", bodies.GOOD)
def test_surfaces_are_even_and_closed(name: str) -> None:
    make, volume_ = bodies.GOOD[name]
    h = 0.17 if name == "pipe tee" else 0.25  # samples have to be dense where walls are thin
    domain = make(h)  # a `Domain` refuses open, crossing and non-manifold surfaces
    found = lengths(domain) / h
    assert 0.3 < found.min() and found.max() < 2 and 0.85 < found.mean() < 1.2
    corners = domain.points[domain.triangulated.triangles]
    enclosed = (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert enclosed == pytest.approx(volume_, rel=0.12), "triangles point outward"
    if name == "bone" or not name.startswith(("pipe", "noisy")):  # one of those by formulas
        assert np.array_equal(domain.points, make(h).points)


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("name", parts.PARTS)
def test_machine_parts_through_stl(name: str, binary: bool, tmp_path: Path) -> None:
    """They are read as they were written: as text the same points, in binary those of 32 bits."""
    part = parts.PARTS[name][0](0.15)
    path = tmp_path / "part.stl"
    part.write(path, binary=binary)
    again = Domain.read(path)
    assert len(again.points) == len(part.points) and len(again.facets) == len(part.facets)
    assert [repair.kind for repair in again.repairs] == ["duplicate points"]
    stored = part.points.astype(np.float32).astype(float) if binary else part.points
    assert {*map(tuple, again.points.tolist())} == {*map(tuple, (stored + 0.0).tolist())}
    if binary:
        return
    mesh = tetrahedralize(again, 0.15)
    assert check(mesh, domain=again)
    assert mesh.complete and len(mesh.steiner) == 0
    assert mesh.quality("min_dihedral").min() > 15


def test_void_of_round_holes_needs_points_outside() -> None:
    """Found here: without lattice points in the holes, a diagonal of a wall was in no triangulation."""
    part = parts.bracket(0.18)
    mesh = tetrahedralize(part, 0.18)
    assert mesh.complete and len(mesh.steiner) == 0
    bare = tetrahedralize(part, optimize=False)
    assert bare.complete and len(bare.steiner) == 0 and check(bare, domain=part)


@pytest.mark.parametrize("name", bodies.GRADED)
def test_sizes_that_vary(name: str) -> None:
    domain, size, text = bodies.GRADED[name](3000)
    x = np.random.default_rng(0).uniform(-1, 1, (50, 3))
    names = {"x": x[:, 0], "y": x[:, 1], "z": x[:, 2], "Sqrt": np.sqrt, "Fabs": np.abs}
    assert np.allclose(eval(text, {"__builtins__": {}}, names), size(x), rtol=1e-6), "the formula for Gmsh"
    mesh = tetrahedralize(domain, size)
    assert check(mesh, domain=domain)
    assert mesh.complete and len(mesh.steiner) == 0
    assert mesh.quality("min_dihedral").min() > 20


def test_measures_by_hand() -> None:
    given = volume_meshers.Given(TETRAHEDRON, FACES, 1.0, "1")
    cell = np.array([[0, 1, 3, 2]])
    found = volume_quality.measures(TETRAHEDRON, cell, "good", given)
    assert found["min_dihedral"] == found["max_dihedral"] == pytest.approx(70.529, abs=1e-3)
    assert found["mean_3r_R"] == pytest.approx(1.0) and found["sharp"] == 0.0
    assert found["exact"] and found["valid"] and found["steiner"] == 0
    turned = volume_quality.measures(TETRAHEDRON, cell[:, [0, 2, 1, 3]], "good", given)
    assert turned == found, "some libraries number vertices the other way round"
    middle = np.concatenate([TETRAHEDRON, TETRAHEDRON[1:].mean(axis=0)[None]])
    split = np.array([[0, 4, 1, 2], [0, 4, 2, 3], [0, 4, 3, 1]])
    found = volume_quality.measures(middle, split, "good", given)
    assert found["valid"] and not found["exact"] and found["steiner"] == 1 and found["cells"] == 3
    assert not volume_quality.measures(middle, split[:2], "good", given)["valid"]


def test_a_tiny_run_of_volumes(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    tiny = {"good": {"ball": 1500}, "parts": {"bracket": 3000}, "bare": {"torus": 300}}
    monkeypatch.setattr(volume, "PLAN", tiny)
    no_processes(monkeypatch)
    ours = [mesher for mesher in volume_meshers.MESHERS if mesher.package == "unstruct"]
    monkeypatch.setattr(volume, "MESHERS", ours)
    assert __main__.main(["volume", "--repeats", "2", "--results", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "volume.json").read_text())["rows"]
    assert len(rows) == 4 and all(row["exact"] and row["valid"] and row["steiner"] == 0 for row in rows)
    assert all(row["min_dihedral"] > 15 and row["sharp"] < 0.002 for row in rows[:2])
    text = (tmp_path / "volume.md").read_text()
    assert "Machine parts" in text and text.strip() == capsys.readouterr().out.strip()
    assert (tmp_path / "volume.png").stat().st_size > 5000


def test_losses_of_volumes_are_bold() -> None:
    row = {"measure": "time", "work": "good", "kind": "ball", "n": 1000, "cells": 2000, "valid": True}
    row |= {"min_dihedral": 30.0, "sharp": 0.0, "mean_3r_R": 0.9, "exact": True, "steiner": 0}
    seconds = {"unstruct": 1.0, "Fast": 0.5, "Slow": 20.0}
    rows = [row | {"contestant": name, "seconds": time} for name, time in seconds.items()]
    text = volume_report.table(rows, "good")
    assert text.count("**") == 2 and "| **0.50** | 30.0° | 0.000 % | 0.900 | 0 | yes |" in text
    assert "Fast **0.50**, Slow 20" in volume_report.summary(rows)


def test_booleans_are_judged() -> None:
    pytest.importorskip("manifold3d")
    points, triangles = solids.boolean(3)
    assert np.array_equal(points, solids.boolean(3)[0])
    (found,) = solids.judged({"seeds": [3], "contestant": "unstruct"})
    assert found["word"] == "exact" and found["triangles"] == len(triangles)
