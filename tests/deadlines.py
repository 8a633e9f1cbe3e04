"""A pytest plugin: a test in real time that fails is run again, if the machine stood still for longer than it may.

`deadline(seconds)`: a time limit is what is tested; run apart, alone.  `stall(seconds)`: something in it gives up after
so long, and cannot be told to wait longer.  What keeps time cannot keep it while nothing of it runs; but a failure that
the machine does not excuse is one, and so is one that each of its repetitions has.
"""

from collections.abc import Iterator

import pytest

from tests.standstill import Standstill

TRIES = 8
"""Repetitions of a test; each must be excused by the machine."""
STOOD = pytest.StashKey[Standstill]()
SAID = "stood still"
"""Under this name a report says for how long, which goes with it from a worker to who prints."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let a test in real time be repeated, but only where the machine stood still for longer than it may."""
    for item in items:
        if (seconds := limit(item)) is not None:
            item.add_marker(pytest.mark.flaky(reruns=TRIES, condition=Excuse(item, seconds)))


def limit(item: pytest.Item) -> float | None:
    """Return for how long the machine may stand still, s; None where it does not matter."""
    marker = item.get_closest_marker("deadline") or item.get_closest_marker("stall")
    return float(marker.args[0]) if marker else None


class Excuse:
    """Whether the machine is why a test has failed; asked once it has."""

    def __init__(self, item: pytest.Item, seconds: float) -> None:
        self._item, self._seconds = item, seconds

    def __call__(self, fault: BaseException | None) -> bool:
        return fault is not None and self._item.stash[STOOD].longest > self._seconds


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Watch the clock from here on."""
    if limit(item) is not None:
        item.stash[STOOD] = Standstill().__enter__()
    return (yield)


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    """Watch it no longer."""
    try:
        return (yield)
    finally:
        if limit(item) is not None:
            item.stash[STOOD].__exit__(None, None, None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Write into the report of a failure for how long the machine stood still."""
    report: pytest.TestReport = yield  # type: ignore[misc]
    if report.failed and (seconds := limit(item)) is not None:
        longest = item.stash[STOOD].longest
        report.user_properties.append((SAID, f"{longest:.3f} s, the limit is {seconds:g} s"))
    return report  # type: ignore[return-value]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what was repeated, and why."""
    for report in terminalreporter.stats.get("rerun", []):
        for name, text in report.user_properties:
            if name == SAID:
                terminalreporter.write_line(f"repeated: {report.nodeid}: the machine stood still for {text}")
