"""What every run of the tests shares: how notebooks are compared, Hypothesis' profile, times a notebook."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).parent

# Equal runs on every machine: no deadline, examples drawn from a fixed seed.
common = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, **common)
settings.register_profile("explore", print_blob=True, **common)
settings.load_profile("repeatable")


def pytest_configure(config: pytest.Config) -> None:
    if (
        getattr(config.option, "nbval_sanitize_with", "") is None
    ):  # a relative name in addopts would depend on the folder
        config.option.nbval_sanitize_with = str(ROOT / "book" / "nbval_sanitize.cfg")
    # on a busy machine a kernel may start slowly, and compiled code is not in the cache at first
    config.option.nbval_kernel_startup_timeout = config.option.nbval_cell_timeout = 36_000


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the time of each notebook and test file: pytest's own list knows only single cells."""
    seconds: dict[str, float] = defaultdict(float)
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                seconds[report.nodeid.split("::")[0]] += report.duration
    terminalreporter.section("seconds a file")
    for name, total in sorted(seconds.items(), key=lambda item: -item[1]):
        if total >= 0.5:
            terminalreporter.write_line(f"{total:7.1f}  {name}")
