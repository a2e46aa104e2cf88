"""A description of the machine: what a reader needs to judge the numbers, without its name."""

from __future__ import annotations

import os
import platform
import re
from pathlib import Path


def describe() -> str:
    """Processor, cores, memory, system and Python."""
    parts = [
        _processor(),
        f"{os.cpu_count()} cores",
        _memory(),
        platform.system(),
        f"Python {platform.python_version()}",
    ]
    return ", ".join(part for part in parts if part)


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    text = info.read_text() if info.exists() else ""
    model = re.search(r"model name\s*: (.+)", text)
    clock = re.search(r"cpu MHz\s*: ([\d.]+)", text)
    name = model[1].strip() if model else platform.machine()
    return f"{name} at {float(clock[1]) / 1000:.1f} GHz" if clock and "GHz" not in name else name


def _memory() -> str:
    if not hasattr(os, "sysconf") or "SC_PHYS_PAGES" not in os.sysconf_names:
        return ""
    return f"{os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE') / 2**30:.0f} GB of memory"


def load() -> float:
    """The load average over the last minute; 0 if it is not known."""
    return round(os.getloadavg()[0], 1) if hasattr(os, "getloadavg") else 0.0
