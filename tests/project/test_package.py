"""What a reader installs: the wheel by itself, the same constraints everywhere, a light import."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from book_files import ROOT, tracked

import unstruct

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
HEAVY = [
    "matplotlib",
    "sympy",
    "ipywidgets",
    "anywidget",
    "meshio",
    "pandas",
    "scipy.spatial",
    "scipy.sparse",
]


def python(code: str, *flags: str, **options) -> str:
    result = subprocess.run([sys.executable, *flags, "-c", code], capture_output=True, text=True, **options)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_wheel_works_by_itself(tmp_path: Path) -> None:
    source, wheels, target = tmp_path / "source", tmp_path / "wheels", tmp_path / "site"
    for path in tracked():  # a copy, for setuptools leaves a build folder behind
        copy = source / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, copy)
    pip = [sys.executable, "-m", "pip", "-q", "--no-input", "--disable-pip-version-check"]
    build = [*pip, "wheel", "--no-deps", "--no-build-isolation", "-w", str(wheels), str(source)]
    subprocess.run(build, check=True, capture_output=True)
    (wheel,) = wheels.glob("unstruct-*.whl")
    install = [*pip, "install", "--no-deps", "--no-index", "--target", str(target), str(wheel)]
    subprocess.run(install, check=True, capture_output=True)

    empty = tmp_path / "empty"
    empty.mkdir()
    code = (
        f"import sys; sys.path.insert(0, {str(target)!r})\n"
        "import unstruct, json, numpy as np\n"
        "points = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0], [1.0, 1.0]])\n"
        "mesh = unstruct.delaunay(points)\n"
        "assert unstruct.check(mesh, delaunay=True)\n"
        "print(json.dumps([unstruct.__file__, len(mesh.simplices)]))\n"
    )
    quick = {**os.environ, "NUMBA_DISABLE_JIT": "1"}  # the kernels themselves are tested elsewhere
    place, triangles = json.loads(python(code, cwd=empty, env=quick))
    assert Path(place).is_relative_to(target)
    assert triangles == 4
    installed = {path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_file()}
    wanted = [path for path in tracked() if path.is_relative_to(ROOT / "unstruct")]
    missing = [path.name for path in wanted if path.relative_to(ROOT).as_posix() not in installed]
    assert not missing, f"not in the wheel: {missing}"
    assert not [name for name in installed if name.startswith(("book/", "tests/", "benchmarks/", "site/"))]


def test_import_is_light() -> None:
    loaded = json.loads(python("import unstruct, sys, json; print(json.dumps(list(sys.modules)))"))
    assert not [name for name in HEAVY if name in loaded]


def test_environment_is_pyproject_under_the_same_constraints() -> None:
    # Read by hand, for YAML has no reader in the standard library and the file is short.
    lines = (ROOT / "environment.yml").read_text(encoding="utf-8").splitlines()
    items = [line.strip().removeprefix("- ") for line in lines if line.strip().startswith("- ")]
    python_needed = f"python{PYPROJECT['project']['requires-python']}"
    assert items == [python_needed, "pip", "pip:", "-c constraints.txt", "-e .[dev]"]
    assert lines[0] == f"name: {PYPROJECT['project']['name']}"
    assert "dev" in PYPROJECT["project"]["optional-dependencies"]


def test_constraints_pin_everything_and_hold_no_address() -> None:
    text = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    pins = [line for line in text.splitlines() if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.+!]+( ; .+)?", line) for line in pins)
    assert "://" not in text and "@" not in text and "--index" not in text
    pinned = {line.split("==")[0] for line in pins}
    extras = PYPROJECT["project"]["optional-dependencies"].values()
    wanted = [*PYPROJECT["project"]["dependencies"], *(name for extra in extras for name in extra)]
    names = {re.split(r"[<>=\[ ;]", name)[0].lower() for name in wanted} - {"unstruct"}
    assert names <= pinned, f"not pinned: {sorted(names - pinned)}"


def test_ci_runs_what_the_readme_says() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"^python3 -m venv .*$", readme, flags=re.M)
    assert len(commands) == 2, "the README gives two commands, each one line"
    (tests,) = [command for command in commands if "-m pytest" in command]
    assert tests in script.splitlines()
    assert all("-c constraints.txt" in command for command in commands)
    assert "set -euo pipefail" in script and "NUMBA_CACHE_DIR" in script
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111


def test_versions_agree() -> None:
    version = PYPROJECT["project"]["version"]
    assert unstruct.__version__ == version
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(rf"^version: {re.escape(version)}$", citation, flags=re.M)
