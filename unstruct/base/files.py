"""Files: read as text with every common mark and encoding, and replaced only when the new one is complete."""

from __future__ import annotations

import os
import shutil
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from .errors import InputError

__all__ = ["as_path", "bytes_of", "replacing", "suffix_of", "text_of"]


def as_path(value: Any) -> Path:
    """A path from a string or anything path-like, or an error that says what was given."""
    try:
        path = Path(value)
    except TypeError:
        raise InputError(f"a path must be a string or a Path, not {type(value).__name__}") from None
    if value == "" or "\0" in str(path):
        raise InputError(f"{value!r} is no path: give the name of a file, without a zero byte")
    return path


def suffix_of(path: Path) -> str:
    """The suffix in small letters, by which formats are known; for compressed files the last two."""
    return "".join(path.suffixes[-2:] if path.suffix.lower() == ".gz" else path.suffixes[-1:]).lower()


def bytes_of(path: Path) -> bytes:
    """The contents of a file.

    Raises
    ------
    InputError
        If there is no such file, or it cannot be read. The message lists files of the same name with other
        suffixes.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        like = [p.name for p in sorted(path.parent.glob("*")) if p.stem == path.stem and p.name != path.name]
        hint = f"there is {', '.join(like[:5])}" if like else f"looked in {path.parent.resolve()}"
        raise InputError(f"there is no file {path.name}; {hint}") from None
    except IsADirectoryError:
        raise InputError(f"{path.name or path} is a folder, not a file: name a file in it") from None
    except OSError as error:
        raise InputError(f"{path.name} cannot be read: {error.strerror or error}") from None


def text_of(path: Path) -> str:
    """The contents of a text file, without its byte order mark, with line ends as they are.

    UTF-8 is assumed unless there is a mark of UTF-16; what is not UTF-8 is read as Latin-1, because such
    bytes occur in comments and names.

    Raises
    ------
    InputError
        As `bytes_of`, and for files that contain zero bytes, which are not text.
    """
    data = bytes_of(path)
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError as error:
            raise InputError(f"{path.name} is not text in UTF-16: {error}") from None
    data = data.removeprefix(BOM_UTF8)
    place = data.find(b"\0")
    if place >= 0:
        raise InputError(
            f"{path.name} is not a text file (byte {place} is zero): its suffix {path.suffix!r} stands for a "
            "format of text; rename it if it has another format"
        )
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to; when the block ends without an error, what was written replaces the old file.

    Parameters
    ----------
    path : Path

    Yields
    ------
    Path
        Of the same name, in a new folder beside. Other files that are written to this folder (the data of
        .xdmf, the partner of .node) are moved with it. Links are followed; permissions of a file that is
        replaced are kept.

    Raises
    ------
    InputError
        If the folder of ``path`` does not exist, or something cannot be written. The old files are then
        untouched.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file() and not target.is_dir():  # a device or a pipe: no rename
        yield path
        return
    if target.is_dir():
        raise InputError(f"cannot write {path}: it is a folder; add the name of a file")
    if not target.parent.is_dir():
        raise InputError(f"cannot write {path}: there is no folder {path.parent}; make it first")
    folder = None
    try:
        folder = Path(mkdtemp(prefix=".unstruct-", dir=target.parent))
        yield folder / path.name
        for made in sorted(folder.iterdir()):
            place = target if made.name == path.name else target.parent / made.name
            if place.exists():
                shutil.copymode(place, made)
            os.replace(made, place)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
