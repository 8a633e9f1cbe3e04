"""What holds for every test: random cases are the same ones each time, and what takes longest comes first."""

import gc
import os
import tempfile
from collections import Counter
from fnmatch import fnmatch

import hypothesis
import pytest
from matplotlib.figure import Figure

from rigkit import report
from rigkit.figure_style import styled
from rigkit.machine_lock import FOLDER

pytest_plugins = ["tests.deadlines"]
hypothesis.settings.register_profile("repeatable", derandomize=True, deadline=None)
hypothesis.settings.load_profile("repeatable")

LOCKS = tempfile.TemporaryDirectory(prefix="locks-")  # beside a rig at work, and beside the other worker
os.environ[FOLDER] = LOCKS.name
RARE = 50_000
"""Objects after which garbage is searched for."""
LONGEST = (
    "contract/test_every_block.py",
    "rigkit/service/page/test_use.py",
    "rigkit/service/page/test_looks.py",
    "rigkit/service/page/test_runs.py",
    "rigkit/service/page/test_strip.py",
    "rigkit/service/test_daemon.py",
    "scenario/test_audio_through_jack.py",
    "scenario/test_a_disk_that_fails.py",
    "calibration/test_main.py",
    "vibractl/test_audio_process.py",
    "stagectl/daemon/test_killed.py",
    "stagectl/daemon/test_rig.py",
    "vibractl/daemon/test_any_order_of_commands.py",
    "vibractl/test_session.py",
)
"""Files of which one would be left over at the end, while the other core has nothing to do.  The first compiles most of
what there is to compile; beside it are those that compile next to nothing, lest two workers compile the same.  The
commands of docs/commands.md are not among them: by their turn their kernels are there."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put those first; the rest stays in its order.  What is beyond a sample of cases is slow."""
    seen: Counter[tuple[str, str]] = Counter()
    for item in items:
        sample, case = item.get_closest_marker("sample"), (str(item.path), getattr(item, "originalname", item.name))
        seen[case] += 1
        if sample is not None and seen[case] > sample.args[0]:
            item.add_marker("slow")
    items.sort(key=lambda item: next((n for n, name in enumerate(LONGEST) if item.path.match(name)), len(LONGEST)))


def pytest_collection_finish() -> None:
    """Leave what was imported and collected out of the search for garbage, which is rarer then: a tenth of all time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(RARE, *gc.get_threshold()[1:])


LAID_OUT = ("*report*", "*figures*", "*toroid*", "*page*")
"""Tests of how a figure looks."""
RENDERED = (*LAID_OUT, "*commands*", "*joints_in_a_clamp*", "*full_disk*", "*force_command*")
"""Tests whose figures become the files that a person gets; elsewhere they are drawn, every artist, into no file."""
_lay_out, _rendered = report.lay_out, report._rendered  # noqa: SLF001 (half of what a report takes)


def _leave(figure: Figure) -> None:
    figure.set_layout_engine("none")


def _only_drawn(figure: Figure, kind: str) -> bytes:
    """Draw a figure that has changed since it was drawn last, for nobody to see."""
    if figure.stale:
        with styled():
            report.lay_out(figure)
            figure.draw_without_rendering()
    return f"a figure as {kind}".encode()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Lay figures out and render them where a test is of figures; elsewhere that is most of what a report takes."""
    path = str(item.path)
    report.lay_out = _lay_out if any(fnmatch(path, name) for name in LAID_OUT) else _leave
    rendered = any(fnmatch(path, name) for name in RENDERED)
    report._rendered = _rendered if rendered else _only_drawn  # noqa: SLF001 (as above)
