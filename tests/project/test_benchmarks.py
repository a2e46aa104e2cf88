"""The benchmark harness on tiny inputs, and its report on made-up rows."""

from __future__ import annotations

import csv
import json
from typing import Any

import numpy as np
import pytest
from suites import no_processes

from benchmarks import (
    __main__,
    contestants,
    delaunay,
    inputs,
    layers,
    layers_report,
    machine,
    meshers,
    parallel,
    planar,
    planar_report,
    quality,
    regions,
    report,
    small,
    small_report,
    threads,
)
from benchmarks.run import RESULTS, Workers

RUN = ["--repeats", "2", "--timeout", "0", "--results"]  # no limit: kernels may have to be compiled first


@pytest.mark.parametrize("kind", inputs.KINDS)
@pytest.mark.parametrize("d", [2, 3])
def test_inputs_are_reproducible_and_distinct(kind, d):
    points = inputs.KINDS[kind](1000, d)
    assert np.array_equal(points, inputs.KINDS[kind](1000, d))
    assert abs(len(points) - 1000) < 50 and points.shape[1] == d
    assert len(np.unique(points, axis=0)) == len(points)


def test_who_is_not_installed_is_left_out():
    ghost = contestants.Contestant("ghost", "no-such-package-anywhere", (2, 3), contestants._scipy)
    names = [c.name for c, _ in contestants.find([*contestants.DELAUNAY, ghost], 2)]
    assert "unstruct" in names and "ghost" not in names
    assert "Triangle" not in [c.name for c, _ in contestants.find(contestants.DELAUNAY, 3)]


def test_the_machine_is_described_in_words():
    text = machine.describe()
    assert "core" in text and "Python" in text
    assert machine.load() >= 0.0


def test_a_job_that_fails_is_reported(capsys):
    workers = Workers()
    assert workers.ask("no such job", {}) is None
    assert len(workers.failures) == 1 and "KeyError" in workers.failures[0]
    assert "FAILED" in capsys.readouterr().err
    hasty = Workers(timeout=0.01)
    assert hasty.ask("start", {}) is None and "no answer" in hasty.failures[0]


def test_a_tiny_run(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(delaunay, "PLAN", {2: (("uniform", "lattice"), (100, 400)), 3: (("sphere",), (100,))})
    monkeypatch.setattr(delaunay, "MEMORY", {2: 400})
    no_processes(monkeypatch, but=lambda job, case: job == "start")
    assert __main__.main(["delaunay", "--max", "400", *RUN, str(tmp_path)]) == 0
    result = json.loads((tmp_path / "delaunay.json").read_text())
    cases = report.times(result["rows"])
    planar = {(2, kind, n) for kind in ("uniform", "lattice") for n in (100, 400)}
    assert set(cases) == planar | {(3, "sphere", 100)}
    for case in cases.values():
        assert "unstruct" in case
        for row in case.values():
            assert len(row["cpu"]) == len(row["wall"]) == 2
            assert row["seconds"] == pytest.approx(np.median(row["cpu"]))
    # a lattice of 20 x 20 has 2 * 19^2 triangles, whoever makes them
    assert {row["cells"] for row in cases[2, "lattice", 400].values()} == {722}
    assert [r["what"] for r in result["rows"] if r["measure"] == "start"] == list(report.START)
    assert any(r["measure"] == "memory" and r["contestant"] == "unstruct" for r in result["rows"])
    with (tmp_path / "delaunay.csv").open() as file:
        assert len(list(csv.DictReader(file))) == len(result["rows"])
    assert (tmp_path / "delaunay.png").stat().st_size > 5000
    text = (tmp_path / "delaunay.md").read_text()
    assert "unstruct µs/point" in text and text.strip() == capsys.readouterr().out.strip()


def test_two_threads(tmp_path, monkeypatch, capsys):
    """That they make the same meshes is tested elsewhere; what they gain depends on who else works here."""
    monkeypatch.setattr(threads, "SIZES", (400,))
    no_processes(monkeypatch)
    assert __main__.main(["threads", *RUN, str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "threads.json").read_text())["rows"]
    assert [row["work"] for row in rows] == list(threads.WORKS)
    assert all(len(row["at once"]) == len(row["one by one"]) == 2 and row["ratio"] > 0 for row in rows)
    assert "one by one ÷ at once" in capsys.readouterr().out


def test_in_parts(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(parallel, "SIZES", {"strong": (2000,), "weak": (1000,), "overhead": (1000,)})
    monkeypatch.setattr(parallel, "EXECUTORS", (("map", 1), ("threads", 2)))
    no_processes(monkeypatch)
    assert __main__.main(["parallel", *RUN, str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "parallel.json").read_text())["rows"]
    assert [row["parts"] for row in rows] == [8, 8, 4, 8, 40, 40]
    assert rows[0]["cells"] == rows[1]["cells"] > 1500
    assert "ms a part" in capsys.readouterr().out


def made_up(name: str, n: int, seconds: float, **more: Any) -> dict[str, Any]:
    case = {"measure": "time", "dimension": 2, "kind": "uniform", "n": n}
    return {**case, "contestant": name, "seconds": seconds, **more}


def test_ratios_growth_and_bold_losses():
    rows = [made_up("unstruct", n, 1e-6 * n) for n in (10**3, 10**4, 10**5)]
    rows += [made_up("Fast", n, 5e-10 * n**1.5) for n in (10**3, 10**4, 10**5, 10**6)]
    rows += [made_up("Wrapped", 10**5, 0.3, inner=[0.05, 0.04])]
    case = report.times(rows)[2, "uniform", 10**5]
    assert report.ratio(case, "Wrapped") == pytest.approx(3.0)
    found = report.growth(rows)
    assert found[2, "uniform", "unstruct"] == pytest.approx(1.0)
    assert found[2, "uniform", "Fast"] == pytest.approx(1.5)
    assert (2, "uniform", "Wrapped") not in found
    lines = report.table(rows, 2).splitlines()
    assert len(lines) == 5, "sizes that we did not run are left out"
    assert lines[2] == "| uniform | 10³ | 1 | **0.02** | – |"
    assert lines[4] == "| uniform | 10⁵ | 1 | **0.16** | 3.00 (itself **0.45**) |"


@pytest.mark.parametrize("reporter", [report, planar_report, small_report, threads, parallel])
def test_a_run_without_a_case_has_no_plot(tmp_path, reporter):
    result = {"suite": "none", "machine": "it", "load": [0, 0], "versions": {}, "failures": [], "rows": []}
    paths = report.write(result, tmp_path, reporter)
    assert [path.suffix for path in paths] == [".json", ".csv", ".md"] and all(p.exists() for p in paths)
    assert sorted(tmp_path.iterdir()) == sorted(paths)


def test_numbers_are_short():
    counts = {1000: "10³", 99_856: "10⁵", 97_336: "9.7·10⁴", 10_648: "1.1·10⁴", 1: "10⁰", 20: "2·10¹"}
    assert {n: report.short(n) for n in counts} == counts
    assert [report.figures(x) for x in (0.51234, 12.345, 4338.2)] == ["0.512", "12.3", "4338"]


def test_committed_rows_are_whole():
    result = json.loads((RESULTS / "delaunay.json").read_text(encoding="utf-8"))
    assert not [text for text in result["failures"] if '"unstruct"' in text]
    cases = report.times(result["rows"])
    largest = {(d, kind): n for d, kind, n in sorted(cases)}
    for d, last in ((2, "circle"), (3, "sphere")):
        for kind in ("uniform", "clustered", "lattice", last):
            assert largest[d, kind] > 90_000
    assert (RESULTS / "delaunay.md").read_text(encoding="utf-8") == report.markdown(result)


# ---------------------------------------------------------------------- the planar suite


@pytest.mark.parametrize("kind", regions.GRAPHS)
def test_graphs_are_domains(kind):
    from unstruct import Domain

    graph = regions.GRAPHS[kind](400)
    assert 300 <= len(graph.points) <= 400
    empty = np.empty((0, 2), dtype=np.int32)
    Domain(graph.points, empty, inner=graph.segments)  # raises where segments cross or touch
    again = regions.GRAPHS[kind](400)
    assert np.array_equal(graph.points, again.points) and np.array_equal(graph.segments, again.segments)


def test_who_meshes_what():
    for work in planar.PLAN:
        assert report.OURS in [mesher.name for mesher, _ in meshers.find(work)]
    ghost = meshers.Mesher("ghost", "no-such-package-anywhere", "refined", meshers._refine)
    assert "ghost" not in [mesher.name for mesher, _ in meshers.find("refined", [*meshers.MESHERS, ghost])]


def test_quality_by_hand():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    found = quality.measures(square, np.array([[0, 1, 2], [0, 2, 3]]), "uniform", 1.01)
    assert found["cells"] == 2 and found["conforming"] == 1.0
    assert found["min_angle"] == 45.0 and found["max_angle"] == 90.0
    assert found["mean_2r_R"] == pytest.approx(2 * (np.sqrt(2) - 1), abs=1e-5)
    assert sum(found["angles"]) == 6 and found["angles"][18] == 2
    assert quality.measures(square, np.array([[0, 1, 2]]), "constrained", None) == {"cells": 1}


def test_a_tiny_planar_run(tmp_path, monkeypatch, capsys):
    tiny = {"constrained": {"matches": (200,)}, "refined": {"plate": (500,)},
            "uniform": {"holed square": (500,)}}  # fmt: skip
    monkeypatch.setattr(planar, "PLAN", tiny)
    no_processes(monkeypatch)
    monkeypatch.setattr(
        planar, "find", lambda work: [m for m in meshers.find(work) if m[0].package == "unstruct"]
    )
    assert __main__.main(["planar", *RUN, str(tmp_path)]) == 0
    result = json.loads((tmp_path / "planar.json").read_text())
    cases = planar_report.times(result["rows"])
    assert set(cases) == {
        ("constrained", "matches", 200),
        ("refined", "plate", 500),
        ("uniform", "holed square", 500),
    }
    assert cases["refined", "plate", 500]["unstruct"]["min_angle"] >= 30.0
    assert set(cases["uniform", "holed square", 500]) == {"unstruct", planar_report.RAW}
    assert cases["uniform", "holed square", 500]["unstruct"]["mean_2r_R"] > 0.95
    text = (tmp_path / "planar.md").read_text()
    assert "Constrained Delaunay" in text and text.strip() == capsys.readouterr().out.strip()
    assert (tmp_path / "planar.png").stat().st_size > 5000


def test_losses_of_the_planar_suite_are_bold():
    case = {"measure": "time", "work": "constrained", "kind": "matches", "n": 1000, "cells": 2000}
    seconds = {"unstruct": 1.0, "Fast": 0.5, "Slow": 20.0}
    rows = [{**case, "contestant": name, "seconds": time} for name, time in seconds.items()]
    text = planar_report.table(rows, "constrained")
    assert "| **0.50** |" in text and "| 20 |" in text


# ---------------------------------------------------------------------- the suite of layers


def test_a_tiny_run_of_layers(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(layers, "PLAN", {"layers": {"5e-2 1e-2": 2000}, "stretched": {"turning": 2000}})
    monkeypatch.setattr(layers, "LENGTHS", {"turning": layers.COARSE_LENGTH})
    no_processes(monkeypatch)
    names = ["unstruct", "unstruct, springs"]
    ours = [mesher for mesher in layers.MESHERS if mesher.package == "unstruct"]
    monkeypatch.setattr(layers, "MESHERS", ours)
    assert __main__.main(["layers", "--repeats", "2", "--results", str(tmp_path)]) == 0
    cases = layers_report.times(json.loads((tmp_path / "layers.json").read_text())["rows"])
    wing, square = cases["layers", "5e-2 1e-2", 2000], cases["stretched", "turning", 2000]
    assert list(wing) == names and list(square) == names[:1]
    assert all(row["max_angle"] < 120 and row["min_angle"] > 30 for row in wing.values())
    assert 0 < wing["unstruct"]["layer_cells"] < wing["unstruct"]["cells"]
    assert square["unstruct"]["valid"] and square["unstruct"]["conforming"] > 0.95
    text = (tmp_path / "layers.md").read_text()
    assert "wing" in text and text.strip() == capsys.readouterr().out.strip()


def test_losses_of_layers_are_bold():
    row = {"measure": "time", "work": "layers", "kind": "1e-2 1e-3", "n": 1000, "cells": 2000}
    row |= {"max_angle": 109.2, "min_angle": 40.0, "mean_2r_R": 0.97, "area_ratio": 1.7}
    seconds = {"unstruct": 1.0, "unstruct, springs": 2.0, "Fast": 0.5}
    text = layers_report.table([row | {"contestant": k, "seconds": t} for k, t in seconds.items()], "layers")
    assert text.count("**") == 2 and "| **0.50** | 109° | 40.0° | 0.970 | 1.70 |" in text


# ---------------------------------------------------------------------- the small suite


@pytest.mark.parametrize("name", small.BARE | small.GRAPHS)
def test_examples_are_as_listed(name):
    pytest.importorskip("triangle")
    found = small.example(name)
    assert len(found.points) == (small.BARE | small.GRAPHS)[name]
    assert (len(found.facets) == 0) == (name in small.BARE)
    assert found.points.flags.writeable, "as a caller's own arrays are"


def test_a_tiny_small_run(tmp_path, monkeypatch, capsys):
    pytest.importorskip("triangle")
    tiny = {"constrained": {"A": (29,)}, "refined": {"A": (29,)}, "sized": {"A": (100,)},
            "round holes": {"coarse": (260,)}}  # fmt: skip
    monkeypatch.setattr(small, "PLAN", tiny)
    no_processes(monkeypatch)
    assert __main__.main(["small", "--repeats", "2", "--results", str(tmp_path)]) == 0
    cases = planar_report.times(json.loads((tmp_path / "small.json").read_text())["rows"])
    assert cases["constrained", "A", 29]["unstruct"]["cells"] == 29
    assert cases["constrained", "A", 29]["Triangle p"]["cells"] == 29
    for work, n in (("refined", 29), ("sized", 100)):
        ours, its = cases[work, "A", n]["unstruct"], cases[work, "A", n]["Triangle pq30"]
        assert ours["min_angle"] >= 30.0 <= its["min_angle"]
        assert 0.8 < ours["cells"] / its["cells"] < 1.25
    assert set(cases["round holes", "coarse", 260]) == {"unstruct"}
    text = (tmp_path / "small.md").read_text()
    assert "64 round holes" in text and text.strip() == capsys.readouterr().out.strip()
    assert not (tmp_path / "small.png").exists()


def test_losses_of_the_small_suite_are_bold():
    case = {"measure": "time", "work": "refined", "kind": "A", "n": 29, "cells": 100}
    seconds = {"unstruct": 1e-4, "Fast": 5e-5, "Slow": 2e-3}
    rows = [{**case, "contestant": name, "seconds": time} for name, time in seconds.items()]
    line = small_report.table(rows, "refined").splitlines()[2]
    assert line == "| A | 100 | 100 | 1 | 100 | 50 | **0.50** | 100 | 2000 | 20 |"
