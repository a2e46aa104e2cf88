"""The suites ``surface`` and ``space_front`` on small bodies: rows and tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import (
    __main__,
    space_front,
    surface,
    surface_intrinsic,
    surface_remeshing,
    surface_report,
    worker,
)
from benchmarks.run import Workers
from unstruct import Mesh


def here(monkeypatch: Any, module: Any) -> None:
    """The worker is another process: what it would do is done here, and only by us."""
    monkeypatch.setattr(Workers, "ask", lambda self, job, case: worker.JOBS[job](case))
    monkeypatch.setattr(module, "MESHERS", [m for m in module.MESHERS if m.package == "unstruct"])


def test_a_tiny_run_of_surfaces(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    plate, needles = (surface_remeshing, "plate with holes"), (surface_intrinsic, "needles of a cylinder")
    for module, kind in (plate, needles):
        here(monkeypatch, module)
        monkeypatch.setitem(module.PLAN, next(iter(module.PLAN)), {kind: (500,)})
    monkeypatch.setattr(surface, "MESHERS", surface_remeshing.MESHERS + surface_intrinsic.MESHERS)
    assert __main__.main(["surface", "--repeats", "1", "--results", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "surface.json").read_text())["rows"]
    made = {row["contestant"]: row for row in rows if row["work"] == "remeshing"}
    assert list(made) == ["unstruct", "surface_delaunay", "surface_front"]
    for row in made.values():
        assert row["topology"] and row["crossings"] == 0 and row["corners"] == 0 and row["unrefined"] == 0
        assert row["deviation"] < 0.3 and row["min_angle"] > 15
    (flips,) = [row for row in rows if row["work"] == "intrinsic"]
    assert flips["illegal"] == 0 and flips["flips"] > 0 and flips["flip_seconds"] <= flips["seconds"]
    text = (tmp_path / "surface.md").read_text()
    assert "Intrinsic Delaunay flips" in text and text.strip() == capsys.readouterr().out.strip()


@pytest.mark.parametrize("kind", surface_intrinsic.MADE)
def test_bad_meshes_are_surfaces_of_about_as_many_triangles_as_named(kind: str) -> None:
    points, triangles = surface_intrinsic.task("intrinsic", kind, 2_000)
    assert 0.8 < len(triangles) / 2_000 < 1.2
    assert (Mesh(points, triangles).volumes > 0).all()
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert np.unique(sides, axis=0, return_counts=True)[1].max() == 2


def test_losses_on_surfaces_are_bold() -> None:
    row: dict[str, Any] = {"measure": "time", "work": "remeshing", "kind": "torus", "n": 1000, "cells": 1000}
    row |= {"given": 9, "min_angle": 33.0, "percentile": 35.0, "deviation": 0.1, "corners": 0.0}
    row |= {"topology": True, "crossings": 0, "below_30": 0.0, "creases": 0.0}
    rows = [{**row, "contestant": "unstruct", "seconds": 1.0}]
    rows += [{**row, "contestant": "pymeshlab", "seconds": 0.5}]
    assert "| **0.50** |" in surface_report.remeshing(rows)
    flips = {**row, "work": "intrinsic", "flips": 5, "flip_seconds": 0.5}
    rows += [
        {**flips, "contestant": "unstruct", "seconds": 1.0},
        {**flips, "contestant": "libigl", "seconds": 2.0},
    ]
    assert "| 2.00 |" in surface_report.intrinsic(rows)
    assert "pymeshlab **0.50**" in surface_report.summary(rows) and "libigl 2.00" in surface_report.summary(
        rows
    )
    alone = [r for r in rows if r["contestant"] == "unstruct"]
    assert "–" in surface_report.intrinsic(alone) and "–" in surface_report.summary(alone)


def test_a_tiny_run_of_the_front_in_space(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    here(monkeypatch, space_front)
    monkeypatch.setattr(space_front, "PLAN", {"good bodies": {"ball": (1_500,)}})
    assert __main__.main(["space_front", "--repeats", "1", "--results", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "space_front.json").read_text())["rows"]
    assert [row["contestant"] for row in rows] == ["unstruct", "unstruct, unfinished", "tetrahedralize"]
    assert all(row["valid"] for row in rows) and rows[0]["by_front"] > 0.9
    assert space_front.summary(rows).splitlines()[2].startswith("| ball | 1.5·10³ | tetrahedralize ")
    text = (tmp_path / "space_front.md").read_text()
    assert "Why cells were accepted" in text and text.strip() == capsys.readouterr().out.strip()
