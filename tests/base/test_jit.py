"""Compiled kernels: an honest cache, and the same answers where numba is off or missing."""

from __future__ import annotations

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from alone import run

import unstruct
import unstruct.base.jit
from unstruct.base.inside_numba import KNOWN
from unstruct.base.jit import apart, inline, kernel, lean

# The package without its face: what is not imported by its path is not loaded, which saves half of the time.
FACELESS = f"""
import sys, types
package = sys.modules["unstruct"] = types.ModuleType("unstruct")
package.__path__ = {list(unstruct.__path__)!r}
"""


def run_kernels(module: str, folder: Path, code: str = "") -> str:
    """What a module of this folder prints, with a cache of its own; ``code`` runs after its import."""
    # files change within a second, which the dates in Python's own cache do not tell
    own = {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    return run(f"{FACELESS}import {module}\n{code}", folder, **own)


MISSING = "import sys; sys.modules['numba'] = None\n"
LATTICE = """
import json, numpy as np, unstruct, unstruct.base.jit
from unstruct.predicates import in_sphere, orient
points = np.array([[x, y] for x in range(4) for y in range(3)], dtype=float)
points = np.vstack([points, [[0.5, 0.25], [1.0, 1.0], [1e-20, 1e20]]])
space = np.array([[x, y, z] for x in range(2) for y in range(2) for z in range(3)], dtype=float)
meshes = [unstruct.delaunay(points), unstruct.delaunay(space)]
signs = [int(orient(points[[0, 1, 5]])), int(in_sphere(points[[0, 3, 1]], points[4]))]
print(json.dumps([unstruct.base.jit.numba is None, [m.simplices.tolist() for m in meshes], signs]))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_without_numba_the_answers_are_the_same() -> None:
    compiled = json.loads(run(LATTICE))
    missing = json.loads(run(MISSING + LATTICE))
    switched_off = json.loads(run(LATTICE, NUMBA_DISABLE_JIT="1"))
    assert [compiled[0], missing[0], switched_off[0]] == [False, True, False]
    assert missing[1:] == compiled[1:]
    assert switched_off[1:] == compiled[1:]


NUMBER = "AMOUNT = {amount}"
HELPER = """
from number import AMOUNT
from unstruct.base.jit import inline

@inline
def step(x):
    return x + AMOUNT
"""
MIDDLE = """
from unstruct.base.jit import kernel
from helper import step

@kernel
def twice(x):
    return step(step(x))
"""
CALLER = """
from unstruct.base.jit import kernel
from middle import twice

@kernel
def four_times(x):
    return twice(twice(x))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_the_cache_sees_edits_two_files_away_and_nothing_else(tmp_path: Path) -> None:
    """numba's own cache would answer 4 again after the helper's edit, or that of a number without kernels.

    What counts is what a kernel does, not dates and comments; machine code of a callee may have been lost.
    """
    code = "print(caller.four_times(0), sum(caller.four_times.stats.cache_hits.values()))"
    for name, text in {"middle": MIDDLE, "caller": CALLER, "helper": HELPER}.items():
        (tmp_path / f"{name}.py").write_text(text)
    (tmp_path / "number.py").write_text(NUMBER.format(amount=1))
    assert run_kernels("caller", tmp_path, code).split() == ["4", "0"]
    (tmp_path / "helper.py").write_text("# a comment\n" + HELPER)
    (tmp_path / "middle.py").touch()
    lost = list((tmp_path / "cache").rglob("middle.twice*"))
    assert lost, "the kernel that the other one calls is kept by itself"
    assert run_kernels("caller", tmp_path, code).split() == ["4", "1"], "the second run compiles again"
    for path in lost:
        path.unlink()
    assert run_kernels("caller", tmp_path, code).split() == ["4", "1"], (
        "compiled again when its caller was read"
    )
    (tmp_path / "number.py").write_text(NUMBER.format(amount=10))
    assert run_kernels("caller", tmp_path, code).split() == ["40", "0"], "old code after another number"
    (tmp_path / "helper.py").write_text(HELPER.replace("x +", "x + 1 +"))
    assert run_kernels("caller", tmp_path, code).split() == ["44", "0"], "old machine code after an edit"


RULED = """
from typing import NamedTuple
from unstruct.base.jit import kernel

class {name}(NamedTuple):
    step: int

@kernel
def ahead(rule, x):
    return x + rule.step

print(ahead({name}({step}), 0))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_a_cache_that_names_a_class_of_yesterday_is_stale(tmp_path: Path) -> None:
    """numba would fail to read the index of its cache after an upgrade that renames a class."""
    for name, step in (("Rule", 1), ("Law", 2), ("Law", 3)):
        (tmp_path / "ruled.py").write_text(RULED.format(name=name, step=step))
        assert run_kernels("ruled", tmp_path).split() == [str(step)]


RECORD = """
from typing import NamedTuple
from unstruct.base.jit import kernel

class Pair(NamedTuple):
    {fields}

@kernel
def first(pair):
    return pair.x

print(first(Pair(1.0, 2.0)))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_the_cache_sees_that_fields_of_a_record_change_places(tmp_path: Path) -> None:
    for fields, wanted in (("x: float; y: float", "1.0"), ("y: float; x: float", "2.0")):
        (tmp_path / "record.py").write_text(RECORD.format(fields=fields))
        assert run_kernels("record", tmp_path).split() == [wanted]


INTEGERS = """
import numpy as np
from unstruct.base.jit import kernel

@kernel
def twice(x):
    return 2 * x

@kernel
def several(small):
    return twice(1) + twice(2) + twice(small[0]) + twice(np.int64(4))

print(several(np.ones(1, dtype=np.int32)), len(twice.inner.compiler().overloads), len(twice.overloads))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_one_form_for_all_integers(tmp_path: Path) -> None:
    (tmp_path / "integers.py").write_text(INTEGERS)
    assert run_kernels("integers", tmp_path).split() == ["16", "1", "0"]


LEAN_FIRST = """
from unstruct.base.jit import lean
from unstruct.predicates.kernels import incircle

@lean
def on_circle(x):
    return incircle(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, x, 1.0)

print(on_circle(1.0), on_circle(0.5))
"""


def test_the_exact_stage_makes_its_arrays_whoever_asks_first(tmp_path: Path) -> None:
    """Compiled for a function that counts no references, it used to inherit that it may make none."""
    (tmp_path / "lean_first.py").write_text(LEAN_FIRST)
    assert run_kernels("lean_first", tmp_path).split() == ["0", "1"]


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
@pytest.mark.parametrize("declare", [kernel, lean, apart, inline])
def test_kernels_let_go_of_the_lock(declare: Any) -> None:
    assert declare(lambda x: x).targetoptions["nogil"] is True


def refined(size: float) -> list[bytes]:
    """The arrays of a mesh with small angles, curves and a size; made anew, domain and all."""
    domain = unstruct.Domain.polygon(
        [(0, 0), (3, 0), (3, 1), (1.2, 0.2), (0, 2)], holes=[[(0.3, 0.3), (0.6, 0.3), (0.4, 0.6)]]
    )
    mesh = unstruct.refine(domain, size=size, min_angle=25)
    spread = unstruct.voronoi_segment(domain, 2 * size)
    space = unstruct.delaunay(np.random.default_rng(5).random((400, 3)))
    return [
        np.ascontiguousarray(a).tobytes()
        for m in (mesh, spread, space)
        for a in (m.points, m.simplices, m.neighbors)
    ]


def test_threads_at_once_make_the_same_meshes() -> None:
    """No kernel keeps anything between calls that another thread could find half done."""
    sizes = [0.05, 0.04, 0.05, 0.06]
    one_by_one = [refined(size) for size in sizes]
    with ThreadPoolExecutor(max_workers=len(sizes)) as pool:
        at_once = list(pool.map(refined, sizes))
    assert at_once == one_by_one


ANOTHER = """
import numba, {module}
del {module}.{part}
from typing import NamedTuple
import numpy as np
from unstruct.base.inside_numba import KNOWN
from unstruct.base.jit import apart, inline, kernel, lean

class Pair(NamedTuple):
    xs: np.ndarray
    y: float

@inline
def first(pair):
    return pair.xs[0]

@lean
def second(pair):
    return pair.xs[1] + first(pair)

@apart
def third(pair):
    return second(pair) + pair.y

@kernel
def total(pair):
    pairs = Pair(pair.xs.copy(), pair.y)
    return third(pairs) + second(pair)

print(KNOWN, total(Pair(np.array([1.0, 2.0]), 0.5)), type(total).__name__)
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
@pytest.mark.parametrize("part", ["IndexDataCacheFile", "Cache._load_overload"])
def test_another_numba_compiles_kernels_plainly(tmp_path: Path, part: str) -> None:
    """A class, or a method of a class, that a later numba may name differently."""
    (tmp_path / "another.py").write_text(ANOTHER.format(module="numba.core.caching", part=part))
    found = run_kernels("another", tmp_path).split()
    assert found == ["False", "6.5", "CPUDispatcher"]
    assert not list(tmp_path.rglob("*.nbi")), "numba's own cache would not see edits in other files"


RECORDS = (
    ANOTHER.split("print", maxsplit=1)[0].split("\n", 3)[3]
    + """
@kernel
def given(pair):
    return pair

@kernel
def back(pair):
    kept = given(pair)
    if pair.y > 0.0:
        kept = Pair(pair.xs, 2.0 * pair.y)
    return kept

made = back(Pair(np.array([1.0, 2.0]), 0.5))
print(KNOWN, total(made), type(made).__name__, given(back(made)).y)
"""
)


@pytest.mark.skipif(
    unstruct.base.jit.numba is None or not KNOWN, reason="records are one argument only in a numba we know"
)
def test_records_go_in_and_come_out_whole(tmp_path: Path) -> None:
    """A record as it was given and one made anew are the same type to the caller."""
    (tmp_path / "records.py").write_text(RECORDS)
    for _ in range(2):  # compiled, then from the disk
        found = run_kernels("records", tmp_path).split()
        assert found == ["True", "7.0", "Pair", "2.0"]


WAITING = """
import gc
from numba.core import event
from numba.core.errors import TypingError
from unstruct.base.jit import inline, kernel, lean

@inline
def once(x):
    return x + 1

@lean
def twice(x):
    return once(once(x))

@kernel
def four_times(x):
    return twice(twice(x))

@kernel
def wrong(x):
    return four_times(x).nothing

class Passes(event.Listener):
    seen, stop = [], False

    def on_start(self, event):
        self.seen.append(gc.isenabled())
        if self.stop:
            raise KeyboardInterrupt

    def on_end(self, event):
        pass

passes = Passes()
event.register("numba:run_pass", passes)
answers = [four_times(0), gc.isenabled()]
try:
    wrong(0.5)
except TypingError:
    answers.append(gc.isenabled())
passes.stop = True
try:
    four_times(0.5)
except KeyboardInterrupt:
    answers.append(gc.isenabled())
passes.stop = False
answers += [four_times(0.5), gc.isenabled()]
gc.disable()
answers += [four_times(True), gc.isenabled()]
results = twice.inner.compiler().overloads.values()
places = [r.library.get_pointer_to_function(r.fndesc.llvm_func_name) for r in results]
print(*answers, any(places), any(passes.seen))
"""


@pytest.mark.skipif(
    unstruct.base.jit.numba is None or not KNOWN, reason="the compiler is ours only in a numba we know"
)
def test_the_garbage_collector_waits_and_copied_kernels_have_no_machine_code(tmp_path: Path) -> None:
    """After errors and Ctrl-C the collector is as it was, and the kernel can be compiled again."""
    (tmp_path / "waiting.py").write_text(WAITING)
    for _ in range(2):  # the copied ones compiled, then from the disk
        found = run_kernels("waiting", tmp_path).split()
        assert found == "4 True True True 4.5 True 5 False False False".split()
        for path in (tmp_path / "cache").rglob("waiting.four_times*"):
            path.unlink()


OTHERS = """
import numba, numpy as np
from unstruct.base.jit import kernel

@kernel
def added(x, y):
    return x + y

@numba.njit
def plain(x, y):
    return x + y

print(added(1, 2), added(0.5, 2), added(np.ones(2), 1).sum(), added(1j, 1).real)
print(plain(1, 2), plain("a", "b"), plain((1,), (2,)))
print(added("a", "b"), added((1,), (2,)), added(1, 2))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None, reason="numba is not installed")
def test_what_is_known_of_operators_holds_for_all_types(tmp_path: Path) -> None:
    """Kernels remember what operators do with numbers; other functions are compiled as ever."""
    (tmp_path / "others.py").write_text(OTHERS)
    assert run_kernels("others", tmp_path).split() == "3 2.5 4.0 1.0 3 ab (1, 2) ab (1, 2) 3".split()


def test_the_import_compiles_nothing():
    """No kernel is called while modules are loaded: it would be compiled, or read from the disk."""
    code = (
        "import gc, unstruct\n"
        "from numba.core.dispatcher import Dispatcher\n"
        "print([d.py_func.__name__ for d in gc.get_objects() if isinstance(d, Dispatcher) and d.overloads\n"
        "       and d.py_func.__module__.startswith('unstruct')])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert run.stdout.strip() == "[]", run.stdout + run.stderr


def test_kernels_from_the_disk_can_be_copied_into_new_ones(tmp_path: Path) -> None:
    """The source of a kernel that was read from the disk is parsed when another kernel needs it."""
    script = tmp_path / "copied.py"
    for square in ("x * x", "x * x + 0.0"):  # the second time `outer` is compiled anew, `once` is read
        script.write_text(
            "from unstruct.base.jit import kernel\n"
            "@kernel\ndef once(x):\n    return x + 1.0\n"
            f"@kernel\ndef outer(x):\n    return once({square})\n"
            "print(once(1.0), outer(3.0))\n"
        )
        for _ in range(2):
            assert run_kernels("copied", tmp_path).split() == ["2.0", "10.0"]


LENT = """
from typing import NamedTuple
import numpy as np
from unstruct.base.jit import inline, kernel, lean, lending

class Pair(NamedTuple):
    xs: np.ndarray
    y: float

@{decorator}
def paired(xs):
    return Pair(xs, 1.0)

@{caller}
def total(xs):
    pair = paired(xs)
    return pair.xs[1] + pair.y

print(total(np.arange(4.0)))
"""


@pytest.mark.skipif(unstruct.base.jit.numba is None or not KNOWN, reason="only a numba we know is told so")
@pytest.mark.parametrize(("decorator", "caller"), [("inline", "kernel"), ("lending", "lean")])
def test_helpers_that_count_no_references_return_no_records_of_arrays(
    tmp_path: Path, decorator: str, caller: str
) -> None:
    """The caller, if it counts references, would count one too few."""
    (tmp_path / "lent.py").write_text(LENT.format(decorator=decorator, caller=caller))
    (tmp_path / "tried.py").write_text("try:\n    import lent\nexcept TypeError as error:\n    print(error)")
    found = run_kernels("tried", tmp_path)
    assert found.strip() == ("2.0" if decorator == "lending" else "paired returns an array: make it a kernel")
