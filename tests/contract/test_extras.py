"""Each extra that is not installed is named, with the line that installs it, where it is needed."""

import subprocess
import sys
import tomllib

import pytest

from tests.contract.source_tree import ROOT
from tests.until import EVER

EXTRAS = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"])
NOT_USED = {
    "pin": "compared with by a test, which is skipped without it",
    "peers": "compared with by benchmarks",
    "mutants": "make mutants installs it",
    "site": "make site installs it",
    "dev": "make setup installs it",
}
"""Extras that no program and no door imports."""
WITHOUT = {
    "control": (
        "control",
        "from calibration.state_space.conversion import control_package; control_package()",
    ),
    "gym": ("gymnasium", "import stagectl.planning.environment"),
    "jack": ("jack", "from firmware_sim.jack_client import _connect; _connect('shaker')"),
    "cluster": ("distributed", "from vibrostage.study_command import _hands; _hands('tcp://lab:8786', None, None)"),
    "export": ("mcap", "from rigkit.export.optional import refuse_missing; refuse_missing(['mcap'])"),
}
"""By extra: the package that is hidden, and what needs it."""


def test_every_extra_is_tried_or_imported_by_nothing() -> None:
    assert set(WITHOUT) | set(NOT_USED) == EXTRAS


@pytest.mark.parametrize("extra", WITHOUT)
def test_without_an_extra_one_is_told_how_to_install_it(extra: str) -> None:
    package, code = WITHOUT[extra]
    hidden = f"import sys; sys.modules[{package!r}] = None; {code}"
    done = subprocess.run([sys.executable, "-c", hidden], capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 1
    assert f"pip install 'vibrostage[{extra}]'" in done.stderr.splitlines()[-1]


@pytest.mark.slow
@pytest.mark.parametrize("program", ["vibractl", "stagectl", "calibration", "firmware_sim", "vibrostage"])
def test_no_command_imports_one_that_it_does_not_need(program: str) -> None:
    names = [package for package, _ in WITHOUT.values()] + ["pyarrow", "pyuff", "segyio", "pinocchio", "pyfftw"]
    hidden = f"import sys; sys.modules.update(dict.fromkeys({names!r})); "
    code = f"{hidden}from {program}.application import PROGRAM; PROGRAM.only()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=EVER, check=False)
    assert (done.returncode, done.stderr) == (0, "")
