"""Scrolled, the page still shows state, reason, output and STOP, and hides nothing that one may want to use."""

import pytest

from tests.rigkit.service.page.browser import PHONE, Browser
from tests.rigkit.service.page.visit import Visit
from tests.until import until

SIZES = [(1920, 1080), (1366, 768), PHONE]
HIT = """
const of = (name) => document.getElementById(name);
const hit = (element) => {
  const box = element.getBoundingClientRect();
  const inside = box.width > 0 && box.top >= 0 && box.left >= 0 && box.bottom <= innerHeight && box.right <= innerWidth;
  const there = document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2);
  return inside && (element === there || element.contains(there) || there?.contains(element));
};
"""


@pytest.fixture
def faulted(visit: Visit) -> Visit:
    """Return the page of a rig in FAULT."""
    visit.daemon.begin(steps=5, seconds=0.0, breaks_at=2)
    visit.tab.until_state("FAULT")
    return visit


def shown(tab: Browser) -> dict[str, bool]:
    """Return whether state, reason, output and STOP can be seen and are under nothing."""
    pairs = {"state": "strip-state", "why": "strip-why", "output": "strip-output"}
    script = HIT + "return arguments[0].some((name) => hit(of(name)))"
    header = {"state": "state-name", "why": "state-why", "output": "light-output"}
    seen = {what: bool(tab.run(script, [pairs[what], header[what]])) for what in pairs}
    return {**seen, "stop": bool(tab.run(script, ["stop"]))}


@pytest.mark.sample(1)
@pytest.mark.parametrize("size", SIZES)
def test_state_reason_output_and_stop_are_seen_wherever_one_has_scrolled(faulted: Visit, size: tuple[int, int]) -> None:
    tab = faulted.tab
    tab.resize(size)
    for part in (0.0, 0.05, 0.2, 0.5, 0.8, 1.0):
        tab.run("scrollTo(0, arguments[0] * (document.documentElement.scrollHeight - innerHeight))", part)
        until(lambda: all(shown(tab).values()))
    assert tab.text("strip-state") == "FAULT"
    assert tab.text("strip-why") == "the bench has broken"
    assert tab.text("strip-output") == "Output zero"


def reach(tab: Browser, name: str) -> None:
    """Scroll to what has that id, each time anew, since events that come make the page longer, until it is seen."""
    script = f"{HIT}of(arguments[0]).scrollIntoView({{ block: 'nearest' }}); return hit(of(arguments[0]))"
    until(lambda: tab.run(script, name))


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES)
def test_nothing_that_can_be_used_stays_under_the_strip_or_stop(faulted: Visit, size: tuple[int, int]) -> None:
    tab = faulted.tab
    tab.resize(size)
    names = tab.run(
        "return [...document.querySelectorAll('main button, main input, main select, main summary, #events')]"
        ".filter((each) => each.checkVisibility()).map((each, number) => (each.id ||= `unnamed-${number}`))"
    )
    assert "forget" in names
    for name in names:
        reach(tab, name)
    down = "scrollTo(0, document.documentElement.scrollHeight);"
    until(lambda: tab.run(f"{down}{HIT}return hit(of('forget'))"))
