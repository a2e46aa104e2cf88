"""Bars: shown where wanted, silent and without tqdm where not."""

from __future__ import annotations

import subprocess
import sys

from unstruct.base.progress import progress_bar


def test_a_bar_counts(capsys):
    with progress_bar(True, " points", total=30, initial=10) as bar:
        bar.update(20)
        assert bar.n == 30
    assert "30/30" in capsys.readouterr().err


def test_no_bar_says_nothing(capsys):
    with progress_bar(False, " points", total=30) as bar:
        bar.update(20)
        bar.update()
    bar.close()
    assert capsys.readouterr() == ("", "")


def test_tqdm_is_imported_only_for_a_bar():
    code = (
        "import sys; from unstruct.base.progress import progress_bar\n"
        "progress_bar(False, 'a').close(); assert 'tqdm' not in sys.modules\n"
        "progress_bar(True, 'a').close(); assert 'tqdm' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
