"""Suites of benchmarks in the process of the tests: what is made counts, not how long it takes."""

from __future__ import annotations

import gc
from collections.abc import Callable
from typing import Any

import pytest

from benchmarks import worker
from benchmarks.run import Workers


def no_processes(
    monkeypatch: pytest.MonkeyPatch, but: Callable[[str, dict[str, Any]], bool] = lambda job, case: False
) -> None:
    """The worker is another process: but for some cases, what it would do is done here, and once a turn."""
    answer = Workers.answer

    def here(self: Workers, job: str, case: dict[str, Any]) -> Any:
        return answer(self, job, case) if but(job, case) else worker.JOBS[job](case)

    monkeypatch.setattr(Workers, "answer", here)
    monkeypatch.setattr(worker, "SHORT", 0.0)
    monkeypatch.setattr(gc, "collect", lambda: 0)  # here it would look at all that other tests have imported
