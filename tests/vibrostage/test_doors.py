"""The doors for people at a prompt: they open quickly, say what they have, and their page's code runs."""

import importlib
import re
import subprocess
import sys

import pytest

from tests.contract.source_tree import ROOT

DOORS = ("ilc", "midranging", "planning", "sysid")
HEAVY = (
    "matplotlib", "scipy.signal", "scipy.stats", "pyfftw", "httpx", "fastapi", "sounddevice", "dask", "pyarrow",
)  # fmt: skip
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
NOTEBOOK = (ROOT / "docs" / "tutorial-python.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("door", DOORS)
def test_a_door_with_all_its_names_brings_nothing_that_draws_or_speaks(door: str) -> None:
    """Nor scipy.signal, which alone takes as long as the rest."""
    code = f"import sys; from vibrostage.{door} import *; print([name for name in {HEAVY!r} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


@pytest.mark.parametrize("door", DOORS)
def test_all_that_a_door_names_is_there_and_has_a_docstring(door: str) -> None:
    module = importlib.import_module(f"vibrostage.{door}")
    for name in module.__all__:
        found = getattr(module, name)
        assert not callable(found) or found.__doc__, name
    assert set(module.__all__) <= set(dir(module))
    with pytest.raises(AttributeError):
        module.nothing  # noqa: B018 (asked for on purpose)


def test_the_code_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    parts = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(parts) >= 5
    names: dict[str, object] = {}
    for part in parts:
        exec(part, names)  # noqa: S102 (the page's own code)
    assert "after 20 trials" in capsys.readouterr().out
    assert all(f"`vibrostage.{door}`" in PAGE for door in DOORS)


def test_the_readme_names_every_door_and_no_other() -> None:
    table = (
        (ROOT / "README.md").read_text(encoding="utf-8").partition("`from vibrostage import`")[2].partition("\n\n")[0]
    )
    assert sorted(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == sorted(DOORS)


def test_the_code_of_the_notebook_s_tutorial_runs(capsys: pytest.CaptureFixture[str]) -> None:
    parts = re.findall(r"```python\n(.*?)```", NOTEBOOK, re.DOTALL)
    assert len(parts) == 8
    names: dict[str, object] = {}
    for part in parts:
        exec(part, names)  # noqa: S102 (the page's own code)
    assert capsys.readouterr().out.count("resonance x") == 6
