"""The registry of experiments: what it names is there, and naming it imports none of it."""

import subprocess
import sys

import pytest

from rigkit.code_name import resolve
from rigkit.config import Section
from rigkit.experiment.kind import Kind
from rigkit.experiment.registration import Registration
from stagectl.experiments.kinds import KINDS
from stagectl.experiments.registry import EXPERIMENTS


@pytest.mark.parametrize("each", EXPERIMENTS, ids=lambda each: each.name)
def test_what_it_names_is_there(each: Registration) -> None:
    assert callable(resolve(each.command))
    assert not each.kind or isinstance(resolve(each.kind), Kind)
    if each.served is not None:
        assert issubclass(resolve(each.served.options), Section)
        assert callable(resolve(each.served.maker))


def test_no_two_have_one_name() -> None:
    assert len({each.name for each in EXPERIMENTS}) == len(EXPERIMENTS)
    assert len(KINDS) == sum(bool(each.kind) for each in EXPERIMENTS)


def test_the_help_lists_all_and_imports_none() -> None:
    code = """
import sys
sys.argv[1:] = ["--help"]
from stagectl.application import PROGRAM
PROGRAM.run()
sys.stderr.write(" ".join(name for name in sys.modules if name.startswith("stagectl.")))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert all(f" {each.name} " in done.stdout for each in EXPERIMENTS)
    assert set(done.stderr.split()) == {"stagectl.application", "stagectl.experiments", "stagectl.experiments.registry"}
