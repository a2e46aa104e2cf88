"""The suite ``tree`` on small trees: the same leaves as discretize, rows, tables; works by themselves."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from suites import no_processes

from benchmarks import __main__, merging, stuffing, tree, tree_cubes, tree_report
from benchmarks.run import RESULTS
from unstruct import Mesh

SIZES = {"stuffing": 3000, "fields": 2, "hexahedra": 600}  # where it is not 1500


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tree, "FEW", 100)
    plan = {work: dict.fromkeys(kinds, (SIZES.get(work, 1500),)) for work, kinds in tree.PLAN.items()}
    plan["boundary"] = {kind: plan["boundary"][kind] for kind in ("disc", "coast 1")}
    plan["stuffing"] = {kind: plan["stuffing"][kind] for kind in ("torus", "graded ball 1")}
    plan["hexahedra"] = {"ball": plan["hexahedra"]["ball"]}
    monkeypatch.setattr(tree, "PLAN", plan)
    monkeypatch.setattr(tree, "QUERIES", 2000)
    no_processes(monkeypatch)


def run(folder: Path, *words: str) -> dict[str, Any]:
    assert __main__.main(["tree", "--repeats", "2", "--results", str(folder), *words]) == 0
    return json.loads((folder / "tree.json").read_text())


def test_a_tiny_run(tmp_path: Path, small: None, capsys: pytest.CaptureFixture[str]) -> None:
    whole = run(tmp_path)
    cases = tree_report.times(whole["rows"])
    assert set(cases) == {
        (work, kind, n) for work, kinds in tree.PLAN.items() for kind, (n,) in kinds.items()
    }
    for (work, kind, _), case in cases.items():
        ours = case["unstruct"]
        assert len(ours["cpu"]) == (1 if work == "fields" else 2) and ours["cells"] > 500
        for peer in case:
            assert tree_report.same(case, peer) in ("", "yes"), (work, kind, peer)
        if work == "conforming":
            assert ours["least"] == pytest.approx(45.0 if kind == "plane" else 19.4, abs=0.2)
        if work in ("stuffing", "fields"):
            low, high = stuffing.GRADED_BOUNDS if "graded" in kind else stuffing.BOUNDS
            assert low < ours["least"] < ours["most"] < high
            assert ours["inverted"] == ours["open"] == 0 and sum(ours["angles"]) == 6 * ours["cells"]
            assert work == "fields" or 0 < ours["bare"]
    for kind in ("disc", "coast 1"):
        case = cases["boundary", kind, 1500]
        assert set(case) == {"unstruct", "quads", "warped", "voronoi_segment", "refine"}
        assert case["unstruct"]["away"] >= (30 if kind == "disc" else 25)
    ball = cases["hexahedra", "ball", 600]
    assert ball["unstruct"]["filled"] == pytest.approx(1.0) and ball["unstruct"]["complete"]
    assert all(row["positive"] and 0.1 < row["share"] < 1 for row in ball.values())
    assert (
        ball["unstruct"]["hexahedra"] < ball[tree_cubes.INNER]["hexahedra"] == ball[tree_cubes.INNER]["cells"]
    )
    text = (tmp_path / "tree.md").read_text()
    assert all(title in text for title in tree_report.TITLES.values())
    assert text.strip() == capsys.readouterr().out.strip()
    assert (tmp_path / "tree.png").stat().st_size > 5000
    assert tree_report.marks(whole["rows"]) is not None

    again = run(tmp_path, "--only", "locate")
    assert [row["work"] for row in again["rows"]] == [row["work"] for row in whole["rows"]]
    assert "measured again, locate, with" in (tmp_path / "tree.md").read_text()
    for row, old in zip(again["rows"], whole["rows"]):
        assert (row == old) == (row["work"] != "locate")
    with pytest.raises(SystemExit):
        run(tmp_path, "--only", "locate", "nothing")
    assert "nothing is no work of this suite, which has build, growth, locate" in capsys.readouterr().err


def test_rows_of_chosen_works_replace_the_old_ones() -> None:
    def rows(**values: int) -> list[dict[str, Any]]:
        return [{"work": work, "kind": kind, "value": v} for work, v in values.items() for kind in "ab"]

    old = {"machine": "it", "load": [0, 0], "versions": {"x": "1"}, "rows": rows(one=1, two=2, three=3)}
    old["failures"] = ['{"work": "two"}: no answer', '{"work": "three"}: no answer']
    new = {**old, "load": [1, 2], "versions": {"y": "3"}, "failures": [], "rows": rows(two=5, four=6)}
    found = merging.merged(old, new, ["two", "four"])
    assert found["rows"] == rows(one=1, two=5, three=3, four=6)
    assert found["failures"] == ['{"work": "three"}: no answer'] and found["versions"] == {"x": "1", "y": "3"}
    assert found["load"] == [0, 0] and found["again"] == {"two": [1, 2], "four": [1, 2]}
    with pytest.raises(ValueError, match="run the whole suite"):
        merging.merged(old, {**new, "machine": "another"}, ["two"])


def test_sizes_make_about_as_many_leaves_as_are_named() -> None:
    for kind in tree.DIMENSION:
        given = tree.task("conforming", kind, 20_000)
        assert 0.7 < len(given.tree) / 20_000 < 1.4
        centers, levels = tree.leaves_of(given.tree)
        assert len(centers) == len(levels) == len(given.tree)
        assert (given.tree.sides <= given.size(given.tree.centers)).all()


def test_open_surfaces_are_seen() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = Mesh(points, [[0, 1, 2, 3]])
    assert stuffing.is_closed(mesh)
    assert not stuffing.is_closed(SimpleNamespace(points=points, boundary=mesh.boundary[:3]))


def test_losses_and_other_leaves_are_bold() -> None:
    row: dict[str, Any] = {"measure": "time", "work": "build", "kind": "plane", "n": 1000, "cells": 1000}
    rows = [{**row, "contestant": "unstruct", "seconds": 1.0, "checksum": 1}]
    rows += [{**row, "contestant": "discretize", "seconds": 0.5, "checksum": 2}]
    assert "| **0.50** | **no** |" in tree_report.table(rows, "build")
    rows = [{**r, "work": "growth"} for r in rows]
    assert tree_report.summary(rows).splitlines()[2] == "| build, plane | 10³ | 0.001 | **0.50** |"
    rows += [{**r, "n": 10_000, "cells": 10_000, "seconds": 10 * r["seconds"]} for r in rows]
    first, second = tree_report.table(rows, "growth").splitlines()[2:]
    assert first == "| plane | 1,000 | 1 | 1000000 | – | 500000 | – | **0.50** |"
    assert second == "| plane | 10,000 | 10 | 1000000 | 1.00 | 500000 | 1.00 | **0.50** |"


def test_committed_rows_of_trees_are_whole() -> None:
    result = json.loads((RESULTS / "tree.json").read_text(encoding="utf-8"))
    assert not result["failures"]
    cases = tree_report.times(result["rows"])
    assert set(cases) == {
        (work, kind, n) for work, kinds in tree.PLAN.items() for kind, sizes in kinds.items() for n in sizes
    }
    assert (RESULTS / "tree.md").read_text(encoding="utf-8") == tree_report.markdown(result)
