"""What is there already, at the page's forms: refused with its ways out, and each way out taken there."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from selenium.webdriver.support.ui import Select

from calibration.vibrator import KIND
from rigkit import config as rig_file
from rigkit.origin import RUN, checksum, read_origin
from tests.rigkit.service.page.browser import DESKTOP, browser, hindrance
from tests.rigkit.service.page.visit import Visit
from tests.rigkit.service.served import ROOT, Served, answering, free_port
from tests.scenario.lab import left
from tests.scenario.lab_week import RIG, WIDER
from tests.until import until
from vibractl.config import RigConfig

WIDTH = WIDER.partition("=")[0]


@pytest.fixture
def visit(tmp_path: Path) -> Iterator[Visit]:
    """Open the page of a vibrator's daemon that has been calibrated, armed by who has control."""
    if why := hindrance():
        pytest.skip(why)
    rig, given = tmp_path / "rig.toml", (f"daemon.data={tmp_path}", f"daemon.address=127.0.0.1:{free_port()}")
    config = rig_file.load(None, RigConfig, (*RIG, "session.shots=1000", *given))
    rig.write_text(rig_file.dump(config))
    left(tmp_path / "model.h5", KIND, config)
    command = [sys.executable, "-m", "vibractl", "daemon", "--config", str(rig)]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    with answering(Served(config.daemon, process)) as daemon, browser() as tab:
        made = Visit(tab, daemon)
        tab.resize(DESKTOP)
        made.open(daemon.tokens.operate)
        made.take_control()
        tab.type("why", "a test")
        tab.press("arm")
        tab.until_state("ARMED")
        yield made


def begin(visit: Visit, procedure: str, **options: str) -> None:
    """Begin a procedure with the form, and with these options in it and no others."""
    tab = visit.tab
    Select(tab.find("which")).select_by_value(procedure)
    tab.run("document.getElementById('which').dispatchEvent(new Event('change'))")
    tab.run("document.getElementById('more').open = true")
    for name, text in options.items():
        field = tab.find(f"option-{name}")
        Select(field).select_by_value(text) if field.tag_name == "select" else tab.type(f"option-{name}", text)
    tab.press("begin-button")


def refused(visit: Visit) -> str:
    """Return what the form says, when it says something."""
    until(lambda: visit.tab.text("told") not in ("", "…"))
    return visit.tab.text("told")


def models(folder: Path) -> dict[str, str]:
    return {path.name: checksum(path) for path in folder.glob("model*.h5")}


@pytest.mark.slow
def test_a_name_that_is_taken_is_measured_anew_computed_again_and_accepted_at_the_page(
    visit: Visit, tmp_path: Path
) -> None:
    daemon, there = visit.daemon, checksum(tmp_path / "model.h5")
    begin(visit, "calibrate")
    assert "is finished; again measures again and renames the earlier result, recompute computes" in refused(visit)
    until(lambda: visit.tab.shows("option-again"))
    assert visit.tab.run("return document.getElementById('command').scrollWidth <= command.clientWidth")
    begin(visit, "calibrate", again="true")
    until(lambda: daemon.named("calibrated"))
    measured = models(tmp_path)
    assert len(measured) == 2
    assert there in measured.values()
    assert measured["model.h5"] != there
    sounds = {checksum(path) for path in (tmp_path / "model.raw").rglob("*.wav")}
    begin(visit, "calibrate", recompute="true")
    until(lambda: len(daemon.named("calibrated")) == 2)
    assert models(tmp_path).keys() == measured.keys()
    assert sounds == {checksum(path) for path in (tmp_path / "model.raw").rglob("*.wav")}

    rig = tmp_path / "rig.toml"
    rig.write_text(rig_file.dump(rig_file.load(rig, RigConfig, [WIDER])))
    with daemon.client() as client, client.control("Ada", over=True):
        client.reload()
    visit.take_control()
    begin(visit, "run", run="one")
    assert refused(visit).endswith(f"or go on all the same with accept {WIDTH}")
    assert not (tmp_path / "runs" / "one").exists()
    begin(visit, "run", run="one", accept=WIDTH)
    until(lambda: daemon.named("shot"))
    visit.tab.press("stop")
    visit.tab.until_state("DISARMED")
    origin = read_origin(tmp_path / "runs" / "one" / RUN)
    assert origin is not None
    assert origin.accepted == (WIDTH,)
