"""The website, built once for all tests that look at it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from book_files import ROOT


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the pages, built as readers build them, warnings being errors.

    Of several processes that share the tests, the first that needs it builds it for all.
    """
    if "PYTEST_XDIST_WORKER" not in os.environ:
        return build(ROOT / "site", tmp_path_factory.mktemp("site"))
    folder = tmp_path_factory.getbasetemp().parent / "site"
    try:
        folder.mkdir()
    except FileExistsError:
        while not (ended := list(folder.glob("built*"))):
            time.sleep(0.5)
        assert ended == [folder / "built"], "another process could not build the site: its test says why"
        return folder / "html"
    end = "built not"
    try:
        build(ROOT / "site", folder)
        end = "built"
    finally:
        (folder / end).touch()
    return folder / "html"


@pytest.fixture(scope="session")
def skeleton_site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the pages of a book that has a front page and the chapter to copy, twice."""
    folder = tmp_path_factory.mktemp("skeleton")
    shutil.copytree(ROOT / "site", folder / "site", ignore=shutil.ignore_patterns("_*d*", "*.ipynb"))
    shutil.copytree(ROOT / "unstruct" / "view", folder / "unstruct" / "view")
    shutil.copy(ROOT / "pyproject.toml", folder)
    (folder / "book").mkdir()
    shutil.copy(ROOT / "book" / "cover.png", folder / "book")
    skeleton = (ROOT / "book" / "skeleton" / "0.0-skeleton.ipynb").read_text(encoding="utf-8")
    skeleton = skeleton.replace("2.1-dirichlet-tessellation.ipynb", "0.1-second.ipynb")
    (folder / "book" / "0.0-skeleton.ipynb").write_text(skeleton, encoding="utf-8")
    second = skeleton.replace("(#equation-0-0-1)", "(0.0-skeleton.ipynb#equation-0-0-1)")
    second = second.replace('id=\\"theorem-0-0-1', 'id=\\"theorem-0-1-1').replace(
        'id=\\"equation-0-0', 'id=\\"equation-0-1'
    )
    (folder / "book" / "0.1-second.ipynb").write_text(second, encoding="utf-8")
    shutil.copy(ROOT / "book" / "errata.ipynb", folder / "book" / "index.ipynb")
    front = (folder / "book" / "index.ipynb").read_text(encoding="utf-8")
    front = front.replace("references.ipynb", "0.0-skeleton.ipynb#theorem-0-0-1")
    (folder / "book" / "index.ipynb").write_text(front, encoding="utf-8")
    return build(folder / "site", folder)


def build(source: Path, folder: Path) -> Path:
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html"]
    command += ["-d", str(folder / "doctrees"), str(source), str(folder / "html")]
    built = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert built.returncode == 0, built.stdout[-2000:] + built.stderr[-8000:]
    return folder / "html"
