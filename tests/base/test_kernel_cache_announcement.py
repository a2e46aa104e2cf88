"""The line for those who wait: only in a terminal, only once, and only if something is compiled for long."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import unstruct
import unstruct.base.jit
from unstruct.base.inside_numba import KNOWN

try:
    import pty
except ImportError:  # not on Windows
    pty = None  # type: ignore[assignment]

# A compilation of any length is announced at the second kernel that is not on the disk.
WAITING = """
import unstruct.base.kernel_cache as cache
from unstruct.base.jit import kernel

cache.LONG = 0.0

@kernel
def once(x):
    return x + 1

@kernel
def twice(x):
    return once(once(x))

@kernel
def four_times(x):
    return twice(twice(x))

print(four_times(0))
"""
SENTENCE = "compiling, once for this machine"

pytestmark = pytest.mark.skipif(
    unstruct.base.jit.numba is None or not KNOWN, reason="without numba, or with another one, nothing is kept"
)


def called(folder: Path, error: int) -> str:
    """Run a process that calls kernels, with this cache and its errors in this file; return its output."""
    (folder / "waiting.py").write_text(WAITING)
    environment = os.environ | {
        "NUMBA_CACHE_DIR": str(folder / "cache"),
        "PYTHONPATH": str(Path(unstruct.__file__).parents[1]),
    }
    command = [sys.executable, "-c", "import waiting"]
    done = subprocess.run(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=error, text=True, check=True
    )
    return done.stdout


def in_a_terminal(folder: Path) -> str:
    """What such a process writes to its terminal as errors."""
    try:
        terminal, end = pty.openpty()
    except OSError as error:
        pytest.skip(f"no pseudo-terminal here: {error}")
    try:
        assert called(folder, end) == "4\n"
    finally:
        os.close(end)
    text = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:  # Linux: the other end is closed
            break
        if not part:
            break
        text += part
    os.close(terminal)
    return text.decode()


@pytest.mark.skipif(pty is None, reason="there are no pseudo-terminals on this system")
def test_a_terminal_is_told_once_and_not_when_all_is_on_disk(tmp_path: Path) -> None:
    assert in_a_terminal(tmp_path).count(SENTENCE) == 1
    assert in_a_terminal(tmp_path) == "", "nothing is compiled any more"


def test_pipes_and_files_stay_as_they_are(tmp_path: Path) -> None:
    with open(tmp_path / "errors", "w") as errors:
        assert called(tmp_path, errors.fileno()) == "4\n"
    assert (tmp_path / "errors").read_text() == ""
