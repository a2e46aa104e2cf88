"""The one program that writes notebooks: two runs write equal bytes, a failing cell writes nothing."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import nbformat
import pytest
from book_files import ROOT
from nbclient.exceptions import CellExecutionError


def load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


sys.path.append(str(ROOT / "site"))  # pages.py imports what is beside it
execute = load(ROOT / "book" / "execute.py")
pages = load(ROOT / "site" / "pages.py")

PLAYER = """
import ipywidgets
from unstruct import view
from unstruct.view import frames as fr
steps = [fr.frame(f"</script> {k}", fr.dots("vertex", [[0, 0], [1, k]])) for k in range(3)]
box = ipywidgets.VBox([view.player(steps, alt="Two points"), ipywidgets.IntSlider(description="k")])
"""


def write(path: Path, *cells: nbformat.NotebookNode) -> None:
    nbformat.write(nbformat.v4.new_notebook(cells=list(cells), metadata={"widgets": {"old": 1}}), path)


def test_two_runs_write_equal_bytes(tmp_path: Path) -> None:
    path = tmp_path / "1-x.ipynb"
    folded = nbformat.v4.new_code_cell("1 + 1", metadata={"tags": ["hide-cell"], "collapsed": True})
    title = nbformat.v4.new_markdown_cell("# A title")
    write(path, title, nbformat.v4.new_code_cell(PLAYER), nbformat.v4.new_code_cell("box"), folded)
    execute.run(path)
    first = path.read_bytes()
    execute.run(path)
    assert path.read_bytes() == first

    _, _, shown, solution = nbformat.read(path, as_version=4).cells
    assert solution.metadata == {"tags": ["hide-cell"], "jupyter": {"source_hidden": True}}
    assert [solution.execution_count, solution.id] == [3, "c003"]
    box = shown.outputs[0].metadata.widget
    player, slider = box.children
    assert [box.kind, player.kind, slider.kind] == ["column", "anywidget", "control"]
    assert [player.script, player.style] == ["player.js", "player.css"]
    assert len(player.traits.frames) == 3 and slider.description == "k"

    site = tmp_path / "site"
    site.mkdir()
    write(tmp_path / "index.ipynb", title)
    (site / "gone.ipynb").write_text("{}")
    pages.write_pages(tmp_path, site)
    assert sorted(page.name for page in site.iterdir()) == ["1-x.ipynb", "index.ipynb"]
    place = nbformat.read(site / "1-x.ipynb", as_version=4).cells[2].outputs[0].data["text/html"]
    assert place.count("</script>") == 1, "a caption closes the element that holds the state"
    assert "1-x" in nbformat.read(site / "index.ipynb", as_version=4).cells[-1].source


def test_a_failing_cell_stops_and_writes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "x.ipynb"
    write(path, nbformat.v4.new_code_cell("print(1)"), nbformat.v4.new_code_cell("assert False"))
    before = path.read_bytes()
    with pytest.raises(CellExecutionError):
        execute.run(path)
    assert path.read_bytes() == before


def test_an_unknown_name_is_told() -> None:
    with pytest.raises(SystemExit, match="starts with 99"):
        execute.notebooks(["99"])


def test_entries_of_the_index_stand_beyond_a_fold() -> None:
    """HTML takes no anchor: what stood before a fold at the beginning of a cell led nowhere."""
    stored = "<details><summary>Answer</summary>\n\nFive.\n\n</details>\n\n## The algorithm\n\nA *cavity*."
    made = pages.with_entries(stored, stored, {"The-algorithm": ["cavity", "star"]})
    entries = "```{index} single: cavity\n```\n\n```{index} single: star\n```\n\n"
    assert made == stored.replace("## The", entries + "## The")
    assert pages.with_entries(stored, stored, {}) == stored
    plain = "Some words.\n\n## The algorithm"
    assert pages.with_entries(plain, plain, {"The-algorithm": ["star"]}).startswith("```{index} single: star")
