"""What a person does at the page: look, take control, arm, begin, pause, end, stop."""

import os
import signal
from pathlib import Path

import pytest
from selenium.webdriver.common.keys import Keys

from tests.rigkit.service.page.browser import Browser
from tests.rigkit.service.page.visit import Visit
from tests.rigkit.service.served import served
from tests.until import until


def test_it_asks_for_a_token_and_says_what_is_wrong_with_one(visit: Visit) -> None:
    tab = visit.tab
    visit.open()
    until(lambda: tab.shows("login"))
    assert not tab.shows("rig")
    tab.type("token", "x" * 43)
    tab.find("token").send_keys(Keys.ENTER)
    until(lambda: "not this daemon's" in tab.text("login-fault"))
    tab.type("token", visit.daemon.tokens.view)
    tab.find("token").send_keys(Keys.ENTER)
    tab.until_state("DISARMED")
    assert not tab.shows("login")


def test_a_token_in_the_address_does_not_stay_there(visit: Visit) -> None:
    assert "token" not in visit.tab.driver.current_url


def test_a_person_takes_control_arms_with_a_reason_begins_pauses_goes_on_and_ends(visit: Visit) -> None:
    tab = visit.tab
    assert "Nobody has control" in tab.text("owner")
    assert not tab.shows("reasoned")
    visit.take_control()
    assert tab.text("owner") == "You have control."
    tab.press("arm")
    until(lambda: "say why" in tab.text("told"))
    assert visit.state() == "DISARMED"
    visit.begin()
    until(lambda: "left" in tab.text("procedure-done"))
    assert tab.text("light-recording") == "Recording"
    assert "it pauses after this step" in tab.text("on-pause")
    assert "it ends after this step" in tab.text("on-abort")
    tab.press("hold")
    tab.until_state("HOLD")
    until(lambda: tab.text("light-recording") == "Not recording")
    tab.press("resume")
    tab.until_state("RUNNING")
    tab.press("abort")
    tab.until_state("ARMED")
    until(lambda: not tab.shows("procedure"))
    tab.press("disarm")
    tab.until_state("DISARMED")
    tab.press("give-back")
    until(lambda: "Nobody has control" in tab.text("owner"))
    until(lambda: visit.daemon.newest("arm", "why") == "to see it")


def test_control_of_another_is_taken_over_and_the_other_page_knows(visit: Visit) -> None:
    visit.take_control()
    with visit.daemon.client() as client, client.control("Bob", over=True):
        until(lambda: visit.tab.text("take-button") == "Take over from Bob")
        assert visit.tab.text("owner") == "Bob has control."
        assert not visit.tab.shows("reasoned")


@pytest.mark.slow
def test_control_outlives_a_reload_of_the_page(visit: Visit) -> None:
    visit.take_control()
    visit.tab.driver.refresh()
    visit.tab.until_state("DISARMED")
    until(lambda: visit.tab.text("owner") == "You have control.")


def test_the_space_bar_stops_whoever_has_control(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    visit.tab.until_state("RUNNING")
    visit.tab.key(" ")
    visit.tab.until_state("DISARMED")
    assert visit.state() == "DISARMED"
    until(lambda: visit.daemon.newest("stop", "why") == "space bar")
    until(lambda: visit.tab.text("stop-told") == "STOP: RUNNING → DISARMED")


@pytest.mark.slow
def test_the_space_bar_stops_and_presses_no_button_that_has_the_focus(visit: Visit) -> None:
    visit.take_control()
    visit.begin()
    visit.tab.run("document.getElementById('hold').focus()")
    holds = len(visit.daemon.named("hold"))
    visit.tab.key(" ")
    visit.tab.until_state("DISARMED")
    until(lambda: not visit.tab.shows("procedure"))
    assert len(visit.daemon.named("hold")) == holds


@pytest.mark.slow
def test_the_space_bar_is_a_letter_where_text_is_typed(visit: Visit) -> None:
    visit.take_control()
    visit.begin()
    visit.tab.type("why", "a word and another")
    assert visit.tab.find("why").get_attribute("value") == "a word and another"
    assert visit.state() == "RUNNING"


@pytest.mark.slow
def test_the_button_stops_by_the_keyboard_as_well(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    visit.tab.until_state("RUNNING")
    visit.tab.press("stop")
    visit.tab.until_state("DISARMED")
    until(lambda: visit.daemon.newest("stop", "why") == "STOP of the page")


@pytest.mark.slow
def test_a_finger_stops_when_it_comes_down(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    visit.tab.until_state("RUNNING")
    stops = len(visit.daemon.named("stop"))
    visit.tab.hold_down("stop")
    visit.tab.until_state("DISARMED")
    visit.tab.let_go()
    until(lambda: visit.tab.text("stop-told") == "STOP: RUNNING → DISARMED")
    until(lambda: len(visit.daemon.named("stop")) > stops)
    assert len(visit.daemon.named("stop")) == stops + 1


def test_who_may_only_look_sees_no_commands_and_can_stop(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    visit.open(visit.daemon.tokens.view)
    visit.tab.until_state("RUNNING")
    assert not visit.tab.shows("command")
    assert not visit.tab.shows("hold")
    visit.tab.press("stop")
    visit.tab.until_state("DISARMED")
    until(lambda: visit.tab.text("stop-told") == "STOP: RUNNING → DISARMED")
    assert not visit.tab.shows("alarm")
    until(lambda: visit.daemon.newest("stop", "why") == "STOP of the page")


def test_a_fault_is_shown_with_its_reason_and_acknowledged_with_another(visit: Visit) -> None:
    visit.daemon.begin(steps=10, breaks_at=1)
    visit.tab.until_state("FAULT")
    assert visit.tab.text("state-why") == "the bench has broken"
    assert visit.tab.run("return document.getElementById('state').dataset.tone") == "fault"
    visit.take_control()
    visit.tab.type("why", "mended")
    visit.tab.press("acknowledge")
    visit.tab.until_state("DISARMED")


@pytest.mark.slow
def test_how_far_a_procedure_is_stands_in_the_head_until_it_has_ended(visit: Visit) -> None:
    visit.daemon.begin(steps=100_000)
    until(lambda: " of 100000 steps\n" in visit.tab.text("summary"))
    visit.tab.press("stop")
    until(lambda: visit.tab.text("summary") == "")


def test_what_people_write_is_text_and_never_part_of_the_page(visit: Visit) -> None:
    with visit.daemon.client() as client, client.control("<img src=x>"):
        client.command("arm", "<b id=planted>why</b>")
        visit.tab.until_state("ARMED")
        until(lambda: "<b id=planted>" in visit.tab.text("events"))
    assert visit.tab.text("state-why") == "<b id=planted>why</b>"
    assert visit.tab.run("return document.querySelectorAll('#planted, #rig img').length") == 0


@pytest.mark.slow
def test_it_greys_out_when_the_rig_gives_no_sign_of_life_and_comes_back(visit: Visit) -> None:
    process = visit.daemon.process
    os.kill(process.pid, signal.SIGSTOP)
    until(lambda: "No sign of life" in visit.tab.text("alarm"))
    assert "grayscale" in visit.tab.run("return getComputedStyle(document.querySelector('main')).filter")
    os.kill(process.pid, signal.SIGCONT)
    until(lambda: not visit.tab.shows("alarm"))
    assert visit.tab.run("return getComputedStyle(document.querySelector('main')).filter") == "none"


@pytest.mark.slow
def test_after_a_restart_it_shows_the_new_daemon_and_nothing_of_the_old(tab: Browser, tmp_path: Path) -> None:
    with served(tmp_path) as before:
        address = before.settings.address
        Visit(tab, before).open(before.tokens.operate)
        before.begin(steps=3)
        until(lambda: tab.driver.find_elements("css selector", ".panel"))
        tab.until_state("ARMED")
    until(lambda: "No sign of life" in tab.text("alarm"))
    with served(tmp_path, address=address):
        tab.until_state("DISARMED")
        until(lambda: not tab.shows("alarm"))
        assert not tab.driver.find_elements("css selector", ".panel")
        until(lambda: tab.run("return document.querySelector('#events li:not([hidden]) b').textContent") == "started")


def test_it_greys_out_when_the_rigs_process_is_killed_and_says_that_a_stop_did_not_get_through(
    tab: Browser, tmp_path: Path
) -> None:
    with served(tmp_path) as doomed:
        Visit(tab, doomed).open(doomed.tokens.operate)
        tab.until_state("DISARMED")
        doomed.process.kill()
        until(lambda: "No sign of life" in tab.text("alarm"))
        assert tab.run("return document.body.classList.contains('old')")
        tab.key(" ")
        until(lambda: "STOP was not carried out" in tab.text("stop-told"))
