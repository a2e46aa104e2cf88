"""Files are replaced when they are complete, and never otherwise; text is read whatever its marks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from unstruct import InputError
from unstruct.base.files import as_path, bytes_of, replacing, suffix_of, text_of


def test_a_failure_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(RuntimeError, match="half"), replacing(path) as beside:
        beside.write_text("new, but")
        raise RuntimeError("half way")
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.txt"]
    with pytest.raises(InputError, match=r"cannot write .*a\.txt: No space left"), replacing(path):
        raise OSError(28, "No space left on device")
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.txt"]


def test_all_files_move_together(tmp_path: Path) -> None:
    path = tmp_path / "a.node"
    path.write_text("old")
    path.chmod(0o640)
    with replacing(path) as beside:
        beside.write_text("new")
        beside.with_suffix(".ele").write_text("partner")
        assert path.read_text() == "old" and not path.with_suffix(".ele").exists()
    assert path.read_text() == "new" and path.with_suffix(".ele").read_text() == "partner"
    assert path.stat().st_mode & 0o777 == 0o640 and sorted(os.listdir(tmp_path)) == ["a.ele", "a.node"]


def test_links_are_followed_and_devices_kept(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    real, link = tmp_path / "data" / "x", tmp_path / "a.txt"
    real.write_text("old")
    link.symlink_to(real)
    with replacing(link) as beside:
        assert beside.name == "a.txt"
        beside.write_text("new")
    assert link.is_symlink() and real.read_text() == "new"
    with replacing(Path(os.devnull)) as beside:
        beside.write_text("gone")
    assert not Path(os.devnull).is_file()


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no folder .*nowhere; make it first"):
        with replacing(tmp_path / "nowhere" / "a.txt"):
            pass
    with pytest.raises(InputError, match="it is a folder; add the name of a file"), replacing(tmp_path):
        pass
    with pytest.raises(InputError, match="a path must be a string or a Path, not int"):
        as_path(3)
    for name in ("", "a\0b.msh"):
        with pytest.raises(InputError, match="is no path: give the name of a file"):
            as_path(name)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_text_of_any_encoding(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "A.TXT"
    path.write_text("Göttingen 1\r\n", encoding=encoding, newline="")
    assert text_of(path) == "Göttingen 1\r\n" and suffix_of(path) == ".txt"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "a.msh").write_bytes(b"\x01\x00\x02")
    with pytest.raises(InputError, match=r"no file a\.vtu; there is a\.msh"):
        bytes_of(tmp_path / "a.vtu")
    with pytest.raises(InputError, match=r"no file b\.vtu; looked in "):
        text_of(tmp_path / "b.vtu")
    with pytest.raises(InputError, match=r"a\.msh is not a text file \(byte 1 is zero\)"):
        text_of(tmp_path / "a.msh")
    (tmp_path / "odd.txt").write_bytes(b"\xff\xfea\x00b")
    with pytest.raises(InputError, match=r"odd\.txt is not text in UTF-16"):
        text_of(tmp_path / "odd.txt")
    with pytest.raises(InputError, match="is a folder, not a file"):
        bytes_of(tmp_path)
