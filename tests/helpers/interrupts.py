"""Ctrl-C while something long runs: at a step that is counted, not after a time that depends on the load."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any

import pytest

__all__ = ["interrupt"]


def interrupt(monkeypatch: pytest.MonkeyPatch, work: Callable[[], Any], unit: str, at: int = 2) -> list[int]:
    """Press Ctrl-C at step ``at`` of the bar that counts in ``unit``, and see that ``work`` ends there.

    ``work`` must show progress: its bar moves whenever the compiled code has come back, and only there can
    an interrupt be heard. So how soon it is heard is how little is done between two moves.

    Returns
    -------
    list of int
        What was done in each step.
    """
    steps: list[int] = []

    class Bar:
        def __init__(self, *, unit: str = "", **_: Any):
            self.unit = unit.strip()

        def update(self, count: int = 1) -> None:
            if self.unit == unit:
                steps.append(count)
                if len(steps) == at:
                    signal.raise_signal(signal.SIGINT)

        def close(self) -> None:
            pass

        def __enter__(self) -> Bar:
            return self

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr("tqdm.auto.tqdm", Bar)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        signal.signal(signal.SIGINT, before)
        monkeypatch.undo()
    assert len(steps) == at, "the work went on"
    return steps
