"""How the page looks and reads: on a phone, to a screen reader, by what is measured, with nothing from elsewhere."""

from itertools import combinations
from typing import Any
from urllib.parse import urlsplit

import pytest
from selenium.webdriver.common.keys import Keys

from tests.rigkit.service.page.browser import PHONE, Browser
from tests.rigkit.service.page.visit import Visit
from tests.rigkit.service.served import Served
from tests.until import until

PANELS = 5
LEADING = 8
"""Pixels by which letters' boxes may reach into the lines above and below."""
NAMED = {"button", "textbox", "combobox", "progressbar", "image", "checkbox", "spinbutton", "list", "region", "form"}


@pytest.fixture(scope="module")
def page(tab: Browser, daemon: Served) -> Visit:
    """Open the page once for tests that change nothing."""
    made = Visit(tab, daemon)
    made.quiet()
    made.open(daemon.tokens.operate)
    tab.until_state("DISARMED")
    return made


def _drawn(tab: Browser) -> None:
    """Wait until each panel of the demonstration is there."""
    until(lambda: len(tab.driver.find_elements("css selector", ".panel")) == PANELS)


def test_nothing_comes_from_elsewhere_and_nothing_is_complained_of(visit: Visit) -> None:
    visit.tab.requested()
    visit.tab.complaints()
    visit.open(visit.daemon.tokens.operate)
    visit.take_control()
    visit.begin()
    _drawn(visit.tab)
    asked = visit.tab.requested()
    assert any(url.endswith("/api/stream") for url in asked)
    assert {urlsplit(url).netloc for url in asked} == {visit.daemon.settings.address}
    assert visit.tab.complaints() == []


def test_a_script_that_is_not_a_file_of_the_page_does_not_run(visit: Visit) -> None:
    visit.tab.run(
        "const planted = document.createElement('script'); planted.textContent = 'window.planted = 1';"
        "document.body.append(planted)"
    )
    assert visit.tab.run("return window.planted") is None
    assert any("Content Security Policy" in text for text in visit.tab.complaints())


@pytest.mark.sample(1)
@pytest.mark.parametrize("dark", [False, True])
def test_a_phone_needs_no_scrolling_sideways_and_always_shows_stop(visit: Visit, dark: bool) -> None:
    tab = visit.tab
    visit.take_control()
    visit.begin()
    _drawn(tab)
    tab.resize(PHONE, dark)
    for where in ("0", "document.documentElement.scrollHeight"):
        tab.run(f"scrollTo(0, {where})")
        assert tab.run("return document.documentElement.scrollWidth") == PHONE[0]
        stop = tab.run(
            "const box = document.getElementById('stop').getBoundingClientRect();"
            "return [box.left, box.right, box.top, box.bottom, box.height]"
        )
        assert stop[0] >= 0
        assert stop[1] <= PHONE[0]
        assert stop[2] >= 0
        assert stop[3] <= PHONE[1]
        assert stop[4] >= 60
    small = tab.run(
        "return [...document.querySelectorAll('button, input, select')].filter(e => e.checkVisibility())"
        ".filter(e => e.getBoundingClientRect().height < 34).map(e => e.id)"
    )
    assert small == []


@pytest.mark.slow
def test_every_control_and_panel_has_a_name_for_a_screen_reader(visit: Visit) -> None:
    visit.take_control()
    visit.begin()
    _drawn(visit.tab)
    nodes = visit.tab.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    found = [node for node in nodes if not node.get("ignored") and node["role"]["value"] in NAMED]
    nameless = [node["role"]["value"] for node in found if not node.get("name", {}).get("value")]
    assert nameless == []
    names = {node["name"]["value"] for node in found}
    assert {"STOP", "Pause", "End", "Why (for the event log)", "Give control back"} <= names
    assert any(name.startswith("Convergence: error over step. error: last ") for name in names)
    assert any(name.startswith("Spectrogram: level from") for name in names)


@pytest.mark.slow
def test_a_table_has_its_numbers_in_columns_of_equal_places(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    _drawn(visit.tab)
    rows = visit.tab.run(
        "return [...document.querySelectorAll('tbody tr')].map(r => [...r.cells].map(c => c.textContent))"
    )
    assert rows == [["1", "120.0", "−2.5"], ["2", "180.5", "-"]]


@pytest.mark.slow
def test_a_table_wider_than_a_panel_has_the_whole_row(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    _drawn(visit.tab)
    is_broad = "return document.querySelector('.panel table').closest('.panel').classList.contains('broad')"
    assert not visit.tab.run(is_broad)
    visit.tab.run("document.getElementById('panels').style.gridTemplateColumns = '10rem 10rem 10rem'")
    until(lambda: visit.tab.run(is_broad))
    assert not visit.tab.run("const box = document.querySelector('.wide'); return box.scrollWidth > box.clientWidth")


@pytest.mark.slow
@pytest.mark.sample(2)
@pytest.mark.parametrize("width", [1000, 1280, 1440, 1920, 2560])
def test_the_name_of_the_state_and_how_much_is_done_stand_apart(visit: Visit, width: int) -> None:
    visit.tab.resize((width, 1000))
    with visit.daemon.client() as client, client.control("Ada", over=True):
        client.command("arm", "a test")
        client.begin("measure", steps=100_000)
        until(lambda: "left" in visit.tab.text("summary"))
    texts = visit.tab.run(
        "return ['state-name', 'state-why', 'lights', 'summary', 'stop'].map((id) => {"
        "  const range = document.createRange(); range.selectNodeContents(document.getElementById(id));"
        "  const { left, right, top, bottom } = range.getBoundingClientRect(); return [left, right, top, bottom] })"
    )
    for one, other in combinations(texts, 2):
        assert max(one[0], other[0]) >= min(one[1], other[1]) or max(one[2], other[2]) > min(one[3], other[3]) - LEADING


@pytest.mark.slow
def test_options_are_told_in_the_event_log_as_words(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000, seconds=0.123456)
    until(lambda: "options steps 100000, seconds 0.123" in visit.tab.text("events"))


@pytest.mark.slow
def test_every_control_that_can_be_pressed_is_reached_by_the_tab_key(visit: Visit) -> None:
    visit.take_control()
    visit.begin()
    wanted = set(
        visit.tab.run(
            "return [...document.querySelectorAll('button, input, select')]"
            ".filter(e => e.checkVisibility() && !e.disabled).map(e => e.id)"
        )
    )
    assert {"stop", "hold", "abort", "why", "give-back"} <= wanted
    reached = set()
    for _ in range(40):
        visit.tab.key(Keys.TAB)
        reached.add(visit.tab.run("return document.activeElement.id"))
    assert wanted <= reached


@pytest.mark.parametrize(
    ("state", "runs", "output", "tone", "light"),
    [
        ("DISARMED", False, "unknown", "quiet", "Output not measured"),
        ("DISARMED", True, "unknown", "live", "Output not measured"),
        ("DISARMED", False, "zero", "quiet", "Output zero"),
        ("DISARMED", False, "on", "fault", "Output on"),
        ("ARMED", False, "unknown", "ready", "Output not measured"),
        ("ARMED", False, "zero", "ready", "Output zero"),
        ("RUNNING", True, "zero", "ready", "Output zero"),
        ("RUNNING", True, "on", "live", "Output on"),
        ("RUNNING", True, "unknown", "live", "Output not measured"),
        ("CALIBRATING", True, "unknown", "live", "Output not measured"),
        ("HOLD", True, "unknown", "live", "Output not measured"),
        ("FAULT", False, "zero", "fault", "Output zero"),
        ("FAULT", True, "unknown", "fault", "Output not measured"),
    ],
)
def test_the_head_has_the_colour_of_what_is_measured_and_amber_of_what_is_not(
    page: Visit, state: str, runs: bool, output: str, tone: str, light: str
) -> None:
    with page.daemon.client() as client:
        shown: dict[str, Any] = client.snapshot()
    shown["state"]["name"] = state
    shown["faults"] = {"response_1": "stuck"}
    shown |= {"output": output, "procedure": {} if runs else None}
    found = page.tab.driver.execute_async_script(
        "const [shown, done] = arguments; import('/state.js').then(({ showState }) => { showState(shown);"
        "done([document.getElementById('state').dataset.tone, document.getElementById('light-output').textContent,"
        "document.getElementById('light-faults').textContent]) })",
        shown,
    )
    assert found == [tone, light, "Fault on purpose: response_1 stuck"]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ("quantity(-9.2e-7, 'm')", "−920 nm"),
        ("quantity(0.0315, 'm/s^2')", "0.032 m/s²"),
        ("quantity(2.1e10, 'byte')", "21.0 GB"),
        ("quantity(null, 'V')", "-"),
        ("quantity(3, '1')", "3"),
        ("quantity(0, 'V')", "0 V"),
        ("quantity(0.392, 'N m', 0, 200)", "0.392 N m"),
        ("quantity(329, 'V', 0, 1000)", "329 V"),
        ("quantity(0.00213, 'm/(N s)')", "0.00213 m/(N s)"),
        ("quantity(0.0251, 'm/s')", "25.1 mm/s"),
        ("quantity(-39.96, 'dB')", "−40.0 dB"),
        ("duration(59.7)", "1 min 00 s"),
        ("duration(8070)", "2 h 14 min"),
        ("duration(-1)", "0 s"),
    ],
)
def test_quantities_are_written_with_three_digits_and_a_fitting_unit(page: Visit, call: str, text: str) -> None:
    script = f"const done = arguments[0]; import('/numbers.js').then(({{ quantity, duration }}) => done({call}))"
    assert page.tab.driver.execute_async_script(script) == text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("call", "ticks"),
    [
        ("scale([0, 650], false, 7)", [0, 100, 200, 300, 400, 500, 600]),
        ("scale([-1, 1], false, 4)", [-1, -0.5, 0, 0.5, 1]),
        ("scale([3, 3], false, 3)", [2, 3, 4]),
        ("scale([0.01, 1], true, 4)", [0.01, 0.1, 1]),
        ("scale([0.1, 1e9], true, 4)", [1, 1e3, 1e6, 1e9]),
    ],
)
def test_axes_have_round_ticks(page: Visit, call: str, ticks: list[float]) -> None:
    script = f"const done = arguments[0]; import('/scale.js').then(({{ scale }}) => done({call}.ticks))"
    assert page.tab.driver.execute_async_script(script) == pytest.approx(ticks)


def _along(page: Visit, unit: str, last: float) -> dict[str, float]:
    """Return how far each text along an abscissa reaches, as a pen writes it into a panel 300 pixels wide."""
    script = """
    const [unit, last, done] = arguments;
    import("/frame.js").then(({ drawFrame }) => {
      const pen = document.createElement("canvas").getContext("2d");
      const reach = {};
      pen.fillText = (text, x) => {
        if (pen.textAlign === "center") reach[text] = x + pen.measureText(text).width / 2;
      };
      const axis = (title, unit) => ({ title, unit, scale: "linear" });
      drawFrame(pen, 300, 200, { x: axis("across", unit), y: axis("error", "dB") }, [[0, last], [-40, 0]]);
      done(reach);
    });
    """
    reach: dict[str, float] = page.tab.driver.execute_async_script(script, unit, last)
    return reach


def test_the_last_number_of_an_axis_is_whole(page: Visit) -> None:
    reach = _along(page, "Hz", 2000)
    assert "2000" in reach
    assert max(reach.values()) <= 300


def test_trials_are_counted_by_whole_numbers(page: Visit) -> None:
    assert [text for text in _along(page, "1", 1) if text[0].isdigit()] == ["0", "1"]
    assert "0.5" in _along(page, "s", 1)
