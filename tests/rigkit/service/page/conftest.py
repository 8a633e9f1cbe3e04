"""A browser and a demonstration for the tests of the page."""

from collections.abc import Iterator

import pytest

from tests.rigkit.service.page.browser import DESKTOP, Browser, browser, hindrance
from tests.rigkit.service.page.visit import Visit
from tests.rigkit.service.served import Served, served


def _skip_without_a_browser() -> None:
    why = hindrance()
    if why:
        pytest.skip(why)


@pytest.fixture(scope="module")
def tab() -> Iterator[Browser]:
    """Open one browser for a file of tests."""
    _skip_without_a_browser()
    with browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Start one demonstration for a file of tests."""
    _skip_without_a_browser()
    with served(tmp_path_factory.mktemp("page"), requests=1000) as made:
        yield made


@pytest.fixture
def visit(tab: Browser, daemon: Served) -> Iterator[Visit]:
    """Open the page, fresh, of a rig that is DISARMED, in the hands of somebody with the token to operate."""
    made = Visit(tab, daemon)
    made.quiet()
    tab.resize(DESKTOP)
    made.open(daemon.tokens.operate)
    tab.until_state("DISARMED")
    yield made
    made.quiet()
