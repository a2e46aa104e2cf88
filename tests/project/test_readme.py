"""The README says what is so: its code runs, its chapters exist, its numbers are the measured ones."""

from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from book_files import BOOK, ROOT, chapters, notebooks

from unstruct import Domain

README = (ROOT / "README.md").read_text(encoding="utf-8")


# What a light installation does not have: everything that only extras bring.
LIGHT = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in set("{}".split()):
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Missing())
"""
OPTIONAL = (
    "IPython PIL anywidget contourpy gmsh h5py ipywidgets matplotlib meshio pandas shapefile skfem sympy "
    "traitlets triangle vega_datasets"
)


def light(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run code as in an installation without extras."""
    words = [sys.executable, "-c", LIGHT.format(OPTIONAL) + code]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True)


def test_every_extra_is_missing_in_a_light_installation() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = {re.split(r"[<>=\[]", name)[0] for name in project["dependencies"]}
    assert needed == {"numpy", "scipy", "numba", "tqdm", "click"}
    modules = {"pyshp": "shapefile", "scikit-fem": "skfem", "vega-datasets": "vega_datasets"}
    extras = {
        re.split(r"[<>=\[]", name)[0]
        for extra in ("io", "hdf", "plot", "fem")
        for name in project["optional-dependencies"][extra]
    }
    assert {modules.get(name, name) for name in extras - {"unstruct"}} <= set(OPTIONAL.split())
    assert all(f"`{extra}`" in README or f"[{extra}," in README for extra in ("io", "hdf", "plot", "fem"))
    text = README.split("needs only ")[1].split(": ")[0]
    assert set(re.split(r", | and ", text)) == needed


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, str, Path]]:
    """The examples: code, what it prints in a light installation, and its folder."""
    found = []
    for code in re.findall(r"^```python\n(.*?)^```", README, flags=re.M | re.S):
        folder = tmp_path_factory.mktemp("example")
        result = light(code, folder)
        assert result.returncode == 0, result.stderr
        found.append((code, result.stdout, folder))
    return found


def test_what_is_missing_is_named_with_its_extra(tmp_path: Path) -> None:
    calls = {
        "mesh.write('a.vtu')": "io",
        "unstruct.Mesh.read('a.stl')": "io",
        "unstruct.Domain.read('a.shp')": "io",
        "mesh.to_meshio()": "io",
        "mesh.plot()": "plot",
        "unstruct.view.plot(mesh)": "plot",
        "unstruct.Domain.letters('a')": "plot",
        "unstruct.examples.coastline()": "plot",
        "mesh.to_skfem()": "fem",
    }
    (tmp_path / "a.stl").write_text("solid")
    (tmp_path / "a.shp").write_bytes(b"\0\0\x27\x0a")
    code = "import unstruct\nmesh = unstruct.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])\n"
    code += "assert '<svg' in mesh._repr_html_() or mesh._repr_html_()\n"
    for call, extra in calls.items():
        code += f"try:\n    {call}\nexcept unstruct.UnstructError as error:\n"
        code += f"    assert \"pip install 'unstruct[{extra}]'\" in str(error), error\n"
        code += f"else:\n    raise AssertionError({call!r})\n"
    result = light(code, tmp_path)
    assert result.returncode == 0, result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.shp", "a.stl"]


def test_the_commands_run_in_a_light_installation(tmp_path: Path) -> None:
    ring = [[0, 0], [0.3, 0], [0.3, 0.2], [0, 0.2], [0, 0]]
    (tmp_path / "coast.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    Domain.ball(size=0.5).write(tmp_path / "part.stl")
    (block,) = re.findall(r"^```\n(unstruct mesh.*?)^```", README, flags=re.M | re.S)
    for line in block.splitlines():
        name, *words = line.split()
        assert name == "unstruct"
        code = f"from unstruct.command import main\nmain({words!r}, prog_name='unstruct')\n"
        result = light(code, tmp_path)
        assert result.returncode == 0, result.stdout + result.stderr
        assert words[0] == "mesh" or result.stdout.startswith("valid")


def test_the_taste_runs(examples: list[tuple[str, str, Path]]) -> None:
    code, printed, folder = examples[0]
    assert 8 <= len([line for line in code.splitlines() if line.strip()]) <= 13
    degrees, cubes = printed.splitlines()
    assert 0 < float(degrees) < 60
    assert re.fullmatch(r"\d+ tetrahedra, total volume 512\.0", cubes)
    assert (folder / "points.msh").stat().st_size > 100_000


def test_the_region_is_meshed(examples: list[tuple[str, str, Path]]) -> None:
    *figures, last = examples[1][1].splitlines()
    assert any(line.startswith("mean 2r/R") and float(line.split()[-1]) > 0.95 for line in figures)
    complete, degrees = last.split()
    assert complete == "True" and float(degrees) >= 30.0


def test_the_body_is_filled(examples: list[tuple[str, str, Path]]) -> None:
    _, printed, folder = examples[2]
    degrees, faces = re.search(r"([\d.]+) (\d+) faces on top", printed).groups()  # type: ignore[union-attr]
    assert float(degrees) > 20 and int(faces) > 1000
    assert (folder / "polyMesh" / "boundary").exists()


def test_the_trees_grow(examples: list[tuple[str, str, Path]]) -> None:
    tree, counts, ball = examples[-1][1].splitlines()
    assert tree.startswith("<quadtree: ") and "leaf of the center" in tree and "leaves inside" in counts
    assert ball.startswith("<octree: ") and "hexahedra" in ball and "complete" not in ball


def test_links_lead_somewhere() -> None:
    for file in ("README.md", "CONTRIBUTING.md"):
        text = (ROOT / file).read_text(encoding="utf-8")
        for alt, target in re.findall(r"(!?\[[^\]]*\])\(([^)#:]+)\)", text):
            assert (ROOT / target).exists(), f"{file} links to {target}"
            assert not alt.startswith("![") or len(alt) > 60, f"{file}: {target} needs a text in its place"


def test_every_chapter_is_listed() -> None:
    linked = re.findall(r"^\| \[.*?\]\(book/(.*?\.ipynb)\)", README, flags=re.M)
    assert [name for name in linked if name[0].isdigit()] == [path.name for path in chapters()]
    assert {"index.ipynb", "ledger.ipynb", "errata.ipynb", "benchmarks.ipynb"} <= set(linked)


def test_the_front_page_leads_to_every_notebook() -> None:
    page = (BOOK / "index.ipynb").read_text(encoding="utf-8")
    linked = set(re.findall(r"\]\(([^()\s]+\.ipynb)\)", page))
    assert linked == {path.name for path in notebooks()} - {"index.ipynb"}


def test_the_cover_is_a_picture() -> None:
    data = (BOOK / "cover.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", data[16:24])
    assert 600 <= width <= 1600 and 200 <= height <= 900 and len(data) < 400_000


def test_the_table_of_speed_is_the_measured_one() -> None:
    from benchmarks.readme import BLOCK, speed

    blocks = BLOCK.findall(README)
    assert len(blocks) == 1
    assert BLOCK.search(README)[0] == blocks[0][0] + speed() + blocks[0][1], "run python -m benchmarks.readme"
