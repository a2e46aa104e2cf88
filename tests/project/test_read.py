"""Reading the book changes no tracked file: the reader's working copy, and how a page is put back."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from book_files import BOOK, ROOT, notebooks


@pytest.fixture(scope="module")
def read() -> ModuleType:
    spec = importlib.util.spec_from_file_location("read", BOOK / "read.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    book, reading = tmp_path / "book", tmp_path / "reading"
    book.mkdir()
    for name in ("index.ipynb", "2.1-x.ipynb", "claims.toml"):
        (book / name).write_text(f"{name}, first", encoding="utf-8")
    (book / "execute.py").write_text("not a page", encoding="utf-8")
    return book, reading


def test_all_pages_are_copied_and_nothing_else(read: ModuleType, folders: tuple[Path, Path]) -> None:
    book, reading = folders
    assert read.update(book, reading) == []
    assert {p.name for p in reading.iterdir()} == {"index.ipynb", "2.1-x.ipynb", "claims.toml", read.COPIED}
    (book / "index.ipynb").write_text("second", encoding="utf-8")
    assert read.update(book, reading) == []
    assert (reading / "index.ipynb").read_text(encoding="utf-8") == "second"


def test_what_a_reader_changed_is_kept(read: ModuleType, folders: tuple[Path, Path]) -> None:
    book, reading = folders
    read.update(book, reading)
    (reading / "2.1-x.ipynb").write_text("mine", encoding="utf-8")
    assert read.update(book, reading) == []  # nothing new in the book: nothing to say
    (book / "2.1-x.ipynb").write_text("second", encoding="utf-8")
    for _ in range(2):
        (sentence,) = read.update(book, reading)
        assert sentence.startswith("2.1-x.ipynb: the book has a newer one; yours was kept")
        assert (reading / "2.1-x.ipynb").read_text(encoding="utf-8") == "mine"


def test_pristine_puts_back_and_moves_aside(read: ModuleType, folders: tuple[Path, Path]) -> None:
    book, reading = folders
    read.update(book, reading)
    for text in ("mine", "mine again"):
        for name in ("index.ipynb", "2.1-x.ipynb"):
            (reading / name).write_text(text, encoding="utf-8")
        (sentence,) = read.update(book, reading, ("2.1",))
        assert "2.1-x.ipynb: yours is now reading" in sentence
        assert (reading / "2.1-x.ipynb").read_text(encoding="utf-8") == "2.1-x.ipynb, first"
        assert (reading / "index.ipynb").read_text(encoding="utf-8") == text
    assert (reading / "yours" / "2.1-x.ipynb").read_text(encoding="utf-8") == "mine"
    assert (reading / "yours" / "2.1-x-2.ipynb").read_text(encoding="utf-8") == "mine again"
    assert len(read.update(book, reading, ())) == 1
    assert (reading / "index.ipynb").read_text(encoding="utf-8") == "index.ipynb, first"


def test_root_is_allowed_only_where_it_is_needed(read: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(read.os, "geteuid", lambda: 1000, raising=False)
    assert "--allow-root" not in read.lab([])
    monkeypatch.setattr(read.os, "geteuid", lambda: 0, raising=False)
    assert {"--allow-root", "--no-browser"} <= set(read.lab(["--no-browser"]))


def test_the_command_copies_every_notebook(tmp_path: Path) -> None:
    """Run as a reader runs it, on a copy of the project without the library."""
    project = tmp_path / "project"
    shutil.copytree(BOOK, project / "book", ignore=shutil.ignore_patterns(".ipynb_checkpoints"))
    subprocess.run([sys.executable, "book/read.py", "--copy"], cwd=project, check=True)
    assert {p.name for p in (project / "reading").glob("*.ipynb")} == {p.name for p in notebooks()}
    assert "reading/" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
