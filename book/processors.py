"""Run notebooks as on other processors, and say what their outputs depend on.

    python book/processors.py                      # every notebook and the meshes, under every setting
    python book/processors.py 2.3 2.6d             # notebooks whose names start so
    python book/processors.py meshes               # the meshes alone
    python book/processors.py --only oldest 2.3    # under one setting
    python book/processors.py --list               # the settings, and what really runs under each

Linear algebra (OpenBLAS), numpy, the C library and numba each choose their code by the processor, and what
they compute may differ in the last bits. Environment variables make them choose as on other, mostly older,
processors; those that this one cannot run are left out. Each run compares every stored output strictly
(`pytest --nbval`), and the meshes of all methods bit for bit (`tests/helpers/mesh_hashes.py`). The first run
under the setting "generic code" compiles every kernel anew: minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from execute import notebooks

ROOT = Path(__file__).resolve().parent.parent
MESHES = ROOT / "tests" / "helpers" / "mesh_hashes.py"
MANAGED = (
    "OPENBLAS_CORETYPE",
    "OPENBLAS_NUM_THREADS",
    "NPY_DISABLE_CPU_FEATURES",
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
    "GLIBC_TUNABLES",
)
# Kernels of OpenBLAS and what a processor must have for them, in numpy's words; the oldest first.
KERNELS = {
    "Prescott": (),
    "Nehalem": ("SSE42",),
    "Sandybridge": ("AVX",),
    "Haswell": ("AVX2", "FMA3"),
    "Zen": ("AVX2", "FMA3"),
    "SkylakeX": ("AVX512_SKX",),
}
WIDE = re.compile(r"AVX512|X86_V4")  # what numpy may be told to leave alone, beyond AVX2
PLAIN_LIBRARY = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable,-FMA4_Usable"

# What runs in a process under a setting: the kernels of OpenBLAS in numpy and in scipy, and the rest.
PROBE = """
import ctypes, json, math, pathlib, sys
import numpy, scipy.linalg
from numpy._core._multiarray_umath import __cpu_dispatch__ as dispatch, __cpu_features__ as features
kernels = []
for package in (numpy, scipy):
    home = pathlib.Path(package.__file__).parent
    for path in sorted(home.parent.glob(package.__name__ + ".libs/*openblas*")):
        library = ctypes.CDLL(str(path))
        for prefix, suffix in (("scipy_", "64_"), ("scipy_", ""), ("", "")):
            ask = getattr(library, f"{prefix}openblas_get_corename{suffix}", None)
            if ask is not None:
                ask.restype = ctypes.c_char_p
                kernels.append(ask().decode())
                break
values = [math.sin(k / 1000) for k in range(100000)]
print(json.dumps({
    "kernels": kernels or ["unknown"],
    "numpy": [name for name in dispatch if features.get(name)],
    "features": [name for name, has in features.items() if has],
    "library": hash(tuple(values)),
}))
"""

Setting = dict[str, str]


def environment(setting: Setting) -> dict[str, str]:
    """The environment of a run: nothing that governs these choices is inherited."""
    inherited = {name: value for name, value in os.environ.items() if name not in MANAGED}
    path = os.pathsep.join(filter(None, [str(ROOT), inherited.get("PYTHONPATH")]))
    return inherited | {"PYTHONPATH": path} | setting


def probe(setting: Setting) -> dict | None:
    """What runs under a setting; None where it does not."""
    result = subprocess.run(
        [sys.executable, "-c", PROBE], env=environment(setting), capture_output=True, text=True
    )
    return json.loads(result.stdout.splitlines()[-1]) if result.returncode == 0 else None


@cache
def settings() -> dict[str, Setting]:
    """The settings that this processor can run, and that choose differently, by name."""
    own = probe({})
    if own is None:
        raise SystemExit("numpy and scipy do not run here")
    found: dict[str, Setting] = {"as it is": {}}
    seen = [own["kernels"]]
    for name, needs in KERNELS.items():
        if set(needs) <= set(own["features"]):
            here = probe({"OPENBLAS_CORETYPE": name})
            if here is not None and here["kernels"] not in seen:
                seen.append(here["kernels"])
                found[name] = {"OPENBLAS_CORETYPE": name}
    found["one thread"] = {"OPENBLAS_NUM_THREADS": "1"}
    oldest = {"OPENBLAS_NUM_THREADS": "1"} | next((found[name] for name in KERNELS if name in found), {})
    wide = [name for name in own["numpy"] if WIDE.match(name)]
    for name, features in (("narrow numpy", wide), ("plain numpy", own["numpy"])):
        if features:
            found[name] = {"NPY_DISABLE_CPU_FEATURES": " ".join(features)}
            oldest |= found[name]
    here = probe({"GLIBC_TUNABLES": PLAIN_LIBRARY})
    if here is not None and here["library"] != own["library"]:
        found["plain C library"] = {"GLIBC_TUNABLES": PLAIN_LIBRARY}
        oldest |= found["plain C library"]
    found["oldest"] = oldest
    found["generic code"] = {"NUMBA_CPU_NAME": "generic"}
    return found


# ---------------------------------------------------------------------- runs


def compared(setting: Setting, paths: list[Path]) -> dict[str, str]:
    """The cells whose output is not the stored one under a setting: where, and what nbval says."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-o", "addopts="]
        command += ["--nbval", "--nbval-current-env", f"--junitxml={report}", *map(str, paths)]
        done = subprocess.run(command, cwd=ROOT, env=environment(setting), capture_output=True, text=True)
        if not report.exists():
            return {"pytest": done.stdout[-2000:] + done.stderr[-2000:]}
        found = {}
        for case in ElementTree.parse(report).iter("testcase"):
            for fault in (*case.findall("failure"), *case.findall("error")):
                name = case.get("classname", "").rsplit("/", 1)[-1].removeprefix("book.")
                found[f"{name} {case.get('name')}"] = re.sub(r"#x1B|\x1b?\[[0-9;]*m", "", fault.text or "")
        if done.returncode not in (0, 1):
            found["pytest"] = done.stdout[-2000:] + done.stderr[-2000:]
        return found


def hashes(setting: Setting) -> dict[str, str]:
    """The hashes of the meshes of all methods under a setting."""
    command = [sys.executable, str(MESHES)]
    done = subprocess.run(command, cwd=ROOT, env=environment(setting), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr[-4000:])
    return json.loads(done.stdout)


def shown(text: str) -> str:
    """Of what nbval says, the lines that compare."""
    start = text.find("Traceback:")
    lines = [line.rstrip() for line in text[max(start, 0) :].splitlines()[1:] if line.strip()]
    return "\n".join("    " + line for line in lines[:24])


def main(arguments: list[str] | None = None) -> int:
    """Run what is asked, print a table and then each difference; 1 where there is one."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("prefixes", nargs="*", help="beginnings of notebook names, or: meshes")
    parser.add_argument("--only", action="append", default=[], metavar="SETTING", help="may be repeated")
    parser.add_argument("--list", action="store_true", help="show the settings and run nothing")
    options = parser.parse_args(arguments)
    chosen = {name: s for name, s in settings().items() if not options.only or name in options.only}
    if unknown := set(options.only) - set(chosen):
        raise SystemExit(f"no such setting here: {', '.join(sorted(unknown))}; see --list")
    names = [name for name in options.prefixes if name != "meshes"]
    paths = notebooks(names) if names or not options.prefixes else []
    with_meshes = "meshes" in options.prefixes or not options.prefixes
    stored = json.loads(MESHES.with_suffix(".json").read_text(encoding="utf-8"))
    print(f"{'setting':16} {'OpenBLAS':12} {'cells':>5} {'meshes':>6} {'seconds':>7}  variables")
    faults: dict[str, str] = {}
    for name, setting in chosen.items():
        here = probe(setting) or {"kernels": ["fails"]}
        kernels = "/".join(dict.fromkeys(here["kernels"]))
        variables = " ".join(f"{key}={value!r}" for key, value in setting.items())
        if options.list:
            print(f"{name:16} {kernels:12} {'':20}  {variables}")
            continue
        start = time.perf_counter()
        cells = compared(setting, paths) if paths else {}
        meshes = hashes(setting) if with_meshes else stored
        differ = [key for key in {**stored, **meshes} if meshes.get(key) != stored.get(key)]
        seconds = time.perf_counter() - start
        print(
            f"{name:16} {kernels:12} {len(cells):5} {len(differ):6} {seconds:7.0f}  {variables}", flush=True
        )
        faults |= {f"{name}: {where}": shown(text) for where, text in cells.items()}
        faults |= {f"{name}: mesh of {key}": "    differs from the stored hash" for key in differ}
    for where, text in faults.items():
        print(f"\n{where}\n{text}")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
