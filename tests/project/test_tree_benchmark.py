"""The suite ``tree`` on small trees: the same leaves as discretize, rows, tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import __main__, tree, tree_report, worker
from benchmarks.run import Workers


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tree, "FEW", 100)
    monkeypatch.setattr(
        tree, "PLAN", {work: dict.fromkeys(kinds, (1500,)) for work, kinds in tree.PLAN.items()}
    )
    monkeypatch.setattr(tree, "QUERIES", 2000)
    # The worker is another process: what it would do is done here.
    monkeypatch.setattr(Workers, "ask", lambda self, job, case: worker.JOBS[job](case))


def test_a_tiny_run(tmp_path: Path, small: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert __main__.main(["tree", "--repeats", "2", "--results", str(tmp_path)]) == 0
    cases = tree_report.times(json.loads((tmp_path / "tree.json").read_text())["rows"])
    assert set(cases) == {(work, kind, 1500) for work, kinds in tree.PLAN.items() for kind in kinds}
    for (work, kind, _), case in cases.items():
        ours = case["unstruct"]
        assert len(ours["cpu"]) == 2 and ours["cells"] > 500
        for peer in case:
            assert tree_report.same(case, peer) in ("", "yes"), (work, kind, peer)
        if work == "conforming":
            assert ours["least"] == pytest.approx(45.0 if kind == "plane" else 19.4, abs=0.2)
    text = (tmp_path / "tree.md").read_text()
    assert all(title in text for title in tree_report.TITLES.values())
    assert text.strip() == capsys.readouterr().out.strip()


def test_sizes_make_about_as_many_leaves_as_are_named() -> None:
    for kind in tree.DIMENSION:
        given = tree.task("conforming", kind, 20_000)
        assert 0.7 < len(given.tree) / 20_000 < 1.4
        centers, levels = tree.leaves_of(given.tree)
        assert len(centers) == len(levels) == len(given.tree)
        assert (given.tree.sides <= given.size(given.tree.centers)).all()


def test_losses_and_other_leaves_are_bold() -> None:
    row: dict[str, Any] = {"measure": "time", "work": "build", "kind": "plane", "n": 1000, "cells": 1000}
    rows = [{**row, "contestant": "unstruct", "seconds": 1.0, "checksum": 1}]
    rows += [{**row, "contestant": "discretize", "seconds": 0.5, "checksum": 2}]
    text = tree_report.table(rows, "build")
    assert "| **0.50** | **no** |" in text
    assert tree_report.summary(rows).splitlines()[2] == "| build, plane | 10³ | 0.001 | **0.50** |"
    rows += [{**r, "n": 10_000, "cells": 10_000, "seconds": 10 * r["seconds"]} for r in rows]
    assert tree_report.growth(rows).count("| 1.00 |") == 2
    assert np.isfinite(rows[0]["seconds"])
