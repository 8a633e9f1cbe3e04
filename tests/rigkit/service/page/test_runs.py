"""The runs on the page: their files are listed, and fetched whole."""

import os
import shutil
from pathlib import Path

import pytest
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from tests.rigkit.service.page.browser import PHONE
from tests.rigkit.service.page.visit import Visit
from tests.until import until


@pytest.fixture
def runs(visit: Visit) -> Path:
    """Return the daemon's folder of runs, with one in it, and the page opened after that."""
    folder = Path(visit.daemon.settings.data) / "runs"
    shutil.rmtree(folder, ignore_errors=True)
    shots = folder / "sea trial 4" / "shots"
    shots.mkdir(parents=True)
    (shots / "0000.wav").write_bytes(bytes(range(256)) * 8_000)
    (shots / "a #1 & <b>.csv").write_text("time\n")
    (folder / "sea trial 4" / ".lock").write_text("")
    visit.open(visit.daemon.tokens.operate)
    visit.tab.until_state("DISARMED")
    return folder


def opened(visit: Visit, name: str = "sea trial 4") -> list[WebElement]:
    """Open a run on the page and return the buttons of its files."""
    until(lambda: name in visit.tab.text("run-list"))
    summary = next(each for each in visit.tab.find("run-list").find_elements("css selector", "summary"))
    summary.send_keys(Keys.ENTER)
    until(lambda: visit.tab.find("run-list").find_elements("css selector", "li"))
    return visit.tab.find("run-list").find_elements("css selector", "li button")


@pytest.mark.slow
def test_the_files_of_a_run_are_listed_with_their_sizes_and_fetched_whole(
    visit: Visit, runs: Path, tmp_path: Path
) -> None:
    visit.tab.complaints()
    visit.tab.save_into(tmp_path)
    buttons = opened(visit)
    assert [button.text for button in buttons] == ["shots/0000.wav", "shots/a #1 & <b>.csv"]
    assert "2.05 MB" in visit.tab.text("run-list")
    for button in buttons:
        button.send_keys(Keys.ENTER)
    kept = runs / "sea trial 4" / "shots"
    until(lambda: len([path for path in tmp_path.iterdir() if path.suffix in (".wav", ".csv")]) == 2)
    assert (tmp_path / "0000.wav").read_bytes() == (kept / "0000.wav").read_bytes()
    assert next(tmp_path.glob("*.csv")).read_text() == "time\n"
    until(lambda: visit.tab.text("runs-told") == "")
    assert visit.tab.complaints() == []


@pytest.mark.slow
def test_who_may_only_look_may_fetch(visit: Visit, runs: Path, tmp_path: Path) -> None:
    assert runs.is_dir()
    visit.tab.save_into(tmp_path)
    visit.open(visit.daemon.tokens.view)
    visit.tab.until_state("DISARMED")
    opened(visit)[0].send_keys(Keys.ENTER)
    until(lambda: (tmp_path / "0000.wav").exists())


@pytest.mark.slow
def test_a_file_that_has_gone_is_missed_by_name(visit: Visit, runs: Path) -> None:
    buttons = opened(visit)
    (runs / "sea trial 4" / "shots" / "0000.wav").unlink()
    buttons[0].send_keys(Keys.ENTER)
    until(lambda: "0000.wav: there is no file 'shots/0000.wav'" in visit.tab.text("runs-told"))
    assert buttons[0].is_enabled()


@pytest.mark.slow
def test_a_run_that_is_new_stands_on_top_when_its_procedure_begins(visit: Visit, runs: Path) -> None:
    opened(visit)
    (runs / "later").mkdir()
    os.utime(runs / "sea trial 4", (1_000.0, 1_000.0))
    visit.daemon.begin(steps=100_000)
    names = "return [...document.querySelectorAll('#run-list summary span')].map(span => span.textContent)"
    until(lambda: visit.tab.run(names) == ["later", "sea trial 4"])


@pytest.mark.slow
def test_a_run_whose_folder_is_made_after_its_procedure_has_begun_is_there_as_soon_as_it_records(
    visit: Visit, runs: Path
) -> None:
    until(lambda: "sea trial 4" in visit.tab.text("run-list"))
    with visit.daemon.client() as client, client.control("Ada", over=True):
        client.command("arm", "a test")
        client.begin("demonstrate", steps=100_000)
        client.command("hold", "getting ready")
        until(lambda: visit.tab.text("light-recording") == "Not recording")
        (runs / "just begun").mkdir()
        assert "just begun" not in visit.tab.text("run-list")
        client.command("resume", "ready")
        until(lambda: "just begun" in visit.tab.text("run-list"))
        assert visit.tab.text("light-recording") == "Recording"


@pytest.mark.slow
def test_many_runs_are_shown_by_and_by_and_where_there_are_none_that_is_said(visit: Visit, runs: Path) -> None:
    for number in range(30):
        (runs / f"run-{number}").mkdir()
    visit.open(visit.daemon.tokens.operate)
    until(lambda: len(visit.tab.find("run-list").find_elements("css selector", "summary")) == 20)
    visit.tab.press("more-runs")
    until(lambda: len(visit.tab.find("run-list").find_elements("css selector", "summary")) == 31)
    assert not visit.tab.shows("more-runs")
    shutil.rmtree(runs)
    visit.open(visit.daemon.tokens.operate)
    until(lambda: visit.tab.text("runs-told") == "Nothing has been recorded yet.")


@pytest.mark.slow
def test_a_phone_needs_no_scrolling_sideways_for_a_long_name(visit: Visit, runs: Path) -> None:
    (runs / "sea trial 4" / ("a" * 120 + ".wav")).write_text("")
    visit.tab.resize(PHONE)
    assert len(opened(visit)) == 3
    assert visit.tab.run("return document.documentElement.scrollWidth") == PHONE[0]
