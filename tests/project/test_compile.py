"""The command that compiles all kernels: its tasks run, and a wrong name is refused."""

from __future__ import annotations

import pytest

from unstruct.compile import TASKS, main


@pytest.mark.parametrize("name", TASKS)
def test_each_task_runs(name: str) -> None:
    TASKS[name]()


def test_names(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["everything"]) == 2
    assert "everything" in capsys.readouterr().err
    assert main(["higher dimensions"]) == 0
    assert "compiled" in capsys.readouterr().out
