"""Machine code that is kept on disk runs until something that was compiled into it changes, and no longer."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module, invalidate_caches
from inspect import isfunction
from pathlib import Path
from typing import Any

import numba
import pytest

ROOT = Path(__file__).parents[2]
HEAD = "import numpy as np\nfrom rigkit.compiled import njit\n"
FILES = {
    "kept_gains": "import numpy as np\nGAIN, PAIR, ROW, UNUSED = 2.0, (1.0, 3), np.array([0.25, 0.5]), 1\n",
    "kept_inner": HEAD + "SHIFT = 0.5\n@njit(cache=True)\ndef inner(x, y=0.125):\n    return x + 1.0 + y\n",
    "kept_ratio": HEAD + "@njit(cache=True)\ndef ratio(x):\n    return x / (x - x)\n",
    "kept_middle": HEAD + "from kept_inner import inner\n"
    "@njit(cache=True, inline='always')\ndef middle(x):\n    return inner(x)\n",
    "kept_outer": HEAD + "import kept_inner as within\nfrom kept_gains import GAIN, PAIR, ROW\n"
    "from kept_middle import middle\nfrom kept_ratio import ratio\n"
    "@njit(cache=True, nogil=True, fastmath={'nsz', 'contract', 'reassoc'})\ndef outer(x):\n"
    "    if x < 0.0:\n        return ratio(x)\n"
    "    return middle(x) * GAIN + PAIR[0] + ROW[1] + sum([within.SHIFT for _ in range(2)])\n",
    "kept_other": HEAD + "@njit(cache=True)\ndef other(x):\n    return x\n",
    "kept_plain": "import numba\nfrom kept_gains import GAIN\n"
    "@numba.njit(cache=True)\ndef plain(x):\n    return GAIN * x\n",
}
"""What is called, `outer`, and what it is made of, all but the last two."""
RESULT = 2.0 * (1.0 + 1.0 + 0.125) + 1.0 + 0.5 + 1.0
"""Of `outer(1.0)`."""


class Written:
    """The files in a folder that is imported from; each import is as a new process would see them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name, text in FILES.items():
            (folder / f"{name}.py").write_text(text)

    def change(self, name: str, old: str, new: str) -> None:
        """Change a file; what has been imported of it stays as it is."""
        file = self.folder / f"{name}.py"
        assert file.read_text().count(old) == 1
        file.write_text(file.read_text().replace(old, new))

    def imported(self, name: str = "outer") -> Any:
        """Import all of it anew, and return a function."""
        for each in FILES:
            sys.modules.pop(each, None)
        invalidate_caches()
        return getattr(import_module(f"kept_{name}"), name)

    def kept(self, pattern: str) -> set[str]:
        """Return the names of files of machine code, wherever they are."""
        return {file.name for file in self.folder.rglob(pattern)}


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Written:
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which knows seconds and sizes
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "compiled"))
    return Written(tmp_path)


def hits(kernel: Any) -> int:
    """Return how often machine code came from the disk."""
    return sum(kernel.stats.cache_hits.values())


CHANGES = {
    "a kernel that is called by one that it calls": ("kept_inner", "x + 1.0", "x + 3.0", RESULT + 4.0),
    "a default of it": ("kept_inner", "0.125", "0.625", RESULT + 1.0),
    "a constant": ("kept_gains", "GAIN, PAIR, ROW, UNUSED = 2.0", "GAIN, PAIR, ROW, UNUSED = 4.0", RESULT + 4.25),
    "a constant by its module": ("kept_inner", "SHIFT = 0.5", "SHIFT = 1.0", RESULT + 1.0),
    "one of several constants": ("kept_gains", "(1.0, 3)", "(2.0, 3)", RESULT + 1.0),
    "an array": ("kept_gains", "[0.25, 0.5]", "[0.25, 0.75]", RESULT + 0.25),
}


@pytest.mark.parametrize(("name", "old", "new", "result"), CHANGES.values(), ids=CHANGES)
def test_what_is_compiled_in_and_has_changed_is_compiled_anew(
    written: Written, name: str, old: str, new: str, result: float
) -> None:
    assert written.imported()(1.0) == pytest.approx(RESULT, abs=1e-12)
    before = written.kept("kept_outer*.nb[ic]")
    written.change(name, old, new)
    changed = written.imported()
    assert (changed(1.0), hits(changed)) == (pytest.approx(result, abs=1e-12), 0)
    again = written.imported()
    assert (again(1.0), hits(again)) == (pytest.approx(result, abs=1e-12), 1)
    after = written.kept("kept_outer*.nb[ic]")
    assert len(before) == len(after) == 2  # what was kept before is gone
    assert not before & after  # nor could index and machine code of two states be one pair


def test_an_option_of_a_kernel_that_is_called_is_compiled_in(written: Written) -> None:
    with pytest.raises(ZeroDivisionError):
        written.imported()(-1.0)
    written.change("kept_ratio", "@njit(cache=True)", "@njit(cache=True, error_model='numpy')")
    assert written.imported()(-1.0) == -float("inf")


SAME: dict[str, Callable[[Written], None]] = {
    "nothing": lambda _: None,
    "a file of another kernel": lambda files: files.change("kept_other", "return x", "return 2.0 * x"),
    "a constant that it has not": lambda files: files.change("kept_gains", "1\n", "2\n"),
    "a comment": lambda files: files.change("kept_inner", "SHIFT", "# a comment\nSHIFT"),
}


@pytest.mark.parametrize("change", SAME.values(), ids=SAME)
def test_what_changes_elsewhere_compiles_nothing(written: Written, change: Callable[[Written], None]) -> None:
    written.imported()(1.0)
    before = written.kept("*.nb[ic]")
    change(written)
    again = written.imported()
    assert (again(1.0), hits(again)) == (pytest.approx(RESULT, abs=1e-12), 1)
    assert written.kept("*.nb[ic]") == before


def test_a_process_with_old_code_leaves_none_to_one_with_new_code(written: Written) -> None:
    old = written.imported()
    written.change("kept_inner", "x + 1.0", "x + 3.0")
    assert written.imported()(1.0) == pytest.approx(RESULT + 4.0, abs=1e-12)
    assert old(1.0) == pytest.approx(RESULT, abs=1e-12)
    assert written.imported()(1.0) == pytest.approx(RESULT + 4.0, abs=1e-12)


@pytest.mark.parametrize("is_writable", [True, False])
def test_it_is_kept_beside_the_file_or_for_the_user(
    written: Written, monkeypatch: pytest.MonkeyPatch, is_writable: bool
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(written.folder / "user"))
    here, user = written.folder / "__pycache__", written.folder / "user" / "numba"
    if not is_writable:
        here.write_text("no folder, so that there is none to write into")
    written.imported()(1.0)
    written.change("kept_inner", "x + 1.0", "x + 3.0")
    assert written.imported()(1.0) == pytest.approx(RESULT + 4.0, abs=1e-12)
    again = written.imported()
    assert (again(1.0), hits(again)) == (pytest.approx(RESULT + 4.0, abs=1e-12), 1)
    assert {file.parts[: len(user.parts)] == user.parts for file in written.folder.rglob("*.nbi")} == {not is_writable}
    assert is_writable == any(here.glob("*.nbi"))


ANOTHER_PROCESS = """\
import json, sys
sys.path.insert(0, sys.argv[1])
from kept_outer import outer
print(json.dumps([outer(1.0), sum(outer.stats.cache_hits.values())]))
"""


def test_another_process_takes_what_is_kept(written: Written) -> None:
    """Whatever the order of its sets, and from wherever it is started."""
    got = []
    for seed, folder in (("1", ROOT), ("2", written.folder)):
        apart = {"PYTHONHASHSEED": seed, "NUMBA_CACHE_DIR": str(numba.config.CACHE_DIR), "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-B", "-c", ANOTHER_PROCESS, str(written.folder)]
        done = subprocess.run(command, cwd=folder, env=os.environ | apart, capture_output=True, check=True)
        got.append(json.loads(done.stdout))
    assert got == [[pytest.approx(RESULT, abs=1e-12), 0], [pytest.approx(RESULT, abs=1e-12), 1]]


def test_numbas_own_decorator_keeps_by_its_own_names(written: Written) -> None:
    plain = written.imported("plain")
    assert plain(1.0) == 2.0
    (name,) = written.kept("kept_plain*.nbi")
    version = f"py{sys.version_info[0]}{sys.version_info[1]}{sys.abiflags}"
    assert name == f"kept_plain.plain-3.{version}.nbi"


def test_without_compilation_it_stays_a_python_function(written: Written, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "DISABLE_JIT", True)
    outer = written.imported()
    assert isfunction(outer)
    assert outer(1.0) == pytest.approx(RESULT, abs=1e-12)
    assert not written.kept("*.nb[ic]")
