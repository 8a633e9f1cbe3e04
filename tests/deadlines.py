"""A pytest plugin: a test of a deadline that fails is run again, if the machine stood still for longer than that.

Mark it `deadline(seconds)`.  What keeps time in a test cannot keep it while nothing of it runs; but a failure that the
machine does not excuse is one, and so is one that each of its repetitions has.
"""

from collections.abc import Iterator

import pytest

from tests.standstill import Standstill

TRIES = 8
"""Repetitions of a test of a deadline; each must be excused by the machine."""
STOOD = pytest.StashKey[Standstill]()
_EXCUSED = pytest.StashKey[list[str]]()


def pytest_configure(config: pytest.Config) -> None:
    """Begin the list of what was repeated."""
    config.stash[_EXCUSED] = []


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let a test of a deadline be repeated, but only where the machine stood still for longer than the deadline."""
    for item in items:
        if (marker := item.get_closest_marker("deadline")) is not None:
            item.add_marker(pytest.mark.flaky(reruns=TRIES, condition=Excuse(item, float(marker.args[0]))))


class Excuse:
    """Whether the machine is why a test has failed; asked once it has."""

    def __init__(self, item: pytest.Item, deadline: float) -> None:
        self._item, self._deadline = item, deadline

    def __call__(self, fault: BaseException | None) -> bool:
        longest = self._item.stash[STOOD].longest
        if fault is None or not longest > self._deadline:
            return False
        self._item.config.stash[_EXCUSED].append(
            f"{self._item.nodeid}: the machine stood still for {longest:.3f} s, the deadline is {self._deadline:g} s"
        )
        return True


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Watch the clock from here on."""
    if item.get_closest_marker("deadline") is not None:
        item.stash[STOOD] = Standstill().__enter__()
    return (yield)


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    """Watch it no longer."""
    try:
        return (yield)
    finally:
        if item.get_closest_marker("deadline") is not None:
            item.stash[STOOD].__exit__(None, None, None)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say what was repeated, and why."""
    for line in config.stash[_EXCUSED]:
        terminalreporter.write_line(f"repeated: {line}")
