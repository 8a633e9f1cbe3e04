"""The gallery's scripts run, and draw."""

import subprocess
import sys

import pytest

from tests.contract.source_tree import ROOT

SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("plot_*.py"))
RUN = "import matplotlib, runpy, sys; matplotlib.use('agg'); runpy.run_path(sys.argv[1]); "
DRAWN = "import matplotlib.pyplot as plt; print(len([axes for n in plt.get_fignums() for axes in plt.figure(n).axes]))"


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_runs_and_draws(script: str) -> None:
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", RUN + DRAWN, script], capture_output=True, text=True)  # noqa: PLW1510
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[-1]) >= 1


def test_there_are_nine() -> None:
    assert len(SCRIPTS) == 9
