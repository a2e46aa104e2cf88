"""The suite ``prisms`` on small bodies: rows, tables, exact counts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import __main__, prism_meshers, prisms, prisms_report, worker
from benchmarks.run import Workers


def test_a_tiny_run_of_prisms(tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    tiny = {"layers": {"notch": (300,), "torus": (500,)}, "growth": {"sphere": (6_000, 20_000)}}
    monkeypatch.setattr(prisms, "PLAN", tiny)
    monkeypatch.setattr(prisms, "FEW_TRIANGLES", 200)
    # The worker is another process: what it would do is done here.
    monkeypatch.setattr(Workers, "ask", lambda self, job, case: worker.JOBS[job](case))
    ours = [mesher for mesher in prism_meshers.MESHERS if mesher.package == "unstruct"]
    monkeypatch.setattr(prisms, "MESHERS", ours)
    assert __main__.main(["prisms", "--repeats", "2", "--results", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "prisms.json").read_text())["rows"]
    assert len(rows) == 6 and all(row["bad"] == 0 for row in rows)
    assert all(row["wedges"] == 30 * row["triangles"] for row in rows)
    assert {row["contestant"] for row in rows} == {"unstruct", "unstruct, checks of the surface"}
    assert all(0 < row["figure: least scaled Jacobian"] <= 1 for row in rows)
    text = (tmp_path / "prisms.md").read_text()
    assert "Thirty layers" in text and text.strip() == capsys.readouterr().out.strip()


@pytest.mark.parametrize("kind", prisms.BODIES)
def test_bodies_have_about_as_many_triangles_as_are_named(kind: str) -> None:
    given = prisms.task("layers", kind, 3_000 if kind == "wing-body" else 1_500)
    count = len(given.domain.facets)
    assert 0.7 < count / (3_000 if kind == "wing-body" else 1_500) < 1.6
    assert len(given.heights) == prisms.COUNT and np.all(np.diff(given.heights) > 0)


def test_losses_and_wrong_wedges_are_bold() -> None:
    row: dict[str, Any] = {"measure": "time", "work": "layers", "kind": "sphere", "n": 1000, "cells": 30_000}
    row |= {"wedges": 30_000, "triangles": 1000, "figure: share of full heights": 1.0}
    rows = [{**row, "contestant": "unstruct", "seconds": 1.0, "bad": 0}]
    rows += [{**row, "contestant": "Gmsh extrudeBoundaryLayer", "seconds": 0.5, "bad": 7}]
    assert "| **0.50** | **7** |" in prisms_report.layers(rows)
    assert prisms_report.summary(rows).splitlines()[2] == "| sphere | 0.0 | 0.03 | 0 | **0.50** | 7 |"
    rows += [{**r, "work": "growth", "wedges": w, "seconds": w / 1e6} for r in rows for w in (1000, 10_000)]
    assert prisms_report.growth(rows).count("| 1.00 |") == 2
    joined = {**rows[0], "work": "joined", "valid": True, "min_dihedral": 13.0, "below_12": 0}
    assert "| yes | 0 | 13.0° | 0 |" in prisms_report.joined([joined])
