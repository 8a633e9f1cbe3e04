"""The command, its scenarios, recording and report."""

import json
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.clock import ASKED
from ctlblocks.recording import Recording, read, write
from rigkit import config as rig_file
from rigkit.experiment.again import replayed
from rigkit.run_folder import read_events
from rigkit.stop import Stopped, StopRequest
from stagectl.application import PROGRAM
from stagectl.experiments.midranging.measures import iae
from stagectl.experiments.midranging.read_back import MIDRANGING
from stagectl.experiments.midranging.scenario import Scenario, scenario, scenarios
from stagectl.experiments.midranging.schedule import simulate, without_lead
from stagectl.link.bus import LinkError
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging_config import MidrangeConfig


def _run(*arguments: str) -> None:
    PROGRAM.only("midrange")(["midrange", *arguments], standalone_mode=False)


def test_a_run_is_recorded_and_reported(tmp_path: Path) -> None:
    _run("--scenario", "thesis-2", "--out", str(tmp_path / "run"), "--json", str(tmp_path / "found.json"),
         "--png", str(tmp_path / "png"))  # fmt: skip
    found = json.loads((tmp_path / "found.json").read_text())
    assert {"iae", "control_over_limit", "fast_model", "slow_model", "changes"} <= set(found)
    kept = read(tmp_path / "run/recording.wav", rate=250.0)
    assert {"reference", "relative", "fast", "slow", "control", "share", "fast_model_1", "slow_model_2"} <= set(
        kept.names
    )
    assert kept.provenance["controller"] == "aimc"
    assert iae(without_lead(kept, MidrangeConfig())) == pytest.approx(found["iae"], rel=1e-12)
    assert "IAE" in (tmp_path / "run/report.html").read_text()
    assert {file.name for file in (tmp_path / "png").iterdir()} == {
        "positions.png", "error.png", "control-signal.png", "models.png"}  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["mvpc", "mvpc-aw", "vpc"])
def test_a_reference_from_a_file_under_every_other_controller(tmp_path: Path, name: str) -> None:
    wave = 1e-3 * np.sin(2.0 * np.pi * np.arange(1000) / 500.0)[:, None]
    write(tmp_path / "wave.csv", Recording(("position",), ("m",), 250.0, wave))
    _run("--scenario", str(tmp_path / "wave.csv"), "--controller", name, "--out", str(tmp_path / "run"),
         "--json", str(tmp_path / "found.json"))  # fmt: skip
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["seconds"] == 4.0
    assert 0.0 < found["iae"] < 1e-3 * 4.0
    assert "share" not in read(tmp_path / "run/recording.wav", rate=250.0).names


def test_the_toroid_is_followed_by_an_axis_each_and_judged_by_its_circle(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _run("--scenario", "toroid", "--out", str(tmp_path / "run"), "--json", str(tmp_path / "found.json"))
    assert "mid-ranging 100 %" in capsys.readouterr().err
    found = json.loads((tmp_path / "found.json").read_text())
    assert set(found["axes"]) == {"y", "z"}
    assert found["seconds"] == pytest.approx(2 * np.pi * 35e-3 / 5e-3 + 1, abs=0.01)
    assert found["circle"]["mean_absolute"] < 5e-6
    assert found["fast_peak"] < 5.1e-3  # what the slow loop lags at 5 mm/s
    assert "Off the circle" in (tmp_path / "run/report.html").read_text()
    y, z = (read(tmp_path / f"run/recording-{axis}.wav", rate=250.0) for axis in "yz")
    np.testing.assert_allclose(np.hypot(y.data[:, 0], z.data[:, 0] - 35e-3), 35e-3, atol=1e-9)


def test_a_file_with_several_channels_is_an_axis_each(tmp_path: Path) -> None:
    wave = 1e-3 * np.ones((50, 2))
    write(tmp_path / "wave.csv", Recording(("x", "z"), ("m", "m"), 250.0, wave))
    assert list(scenarios(str(tmp_path / "wave.csv"), 250.0)) == ["x", "z"]


def test_the_table_is_a_list_of_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stagectl.experiments.midranging.table.ROWS", (("sim, r = 1.5", 1.5e-3, 0.0),))
    _run("--scenario", "table-3.1", "--json", str(tmp_path / "rows.json"))
    (row,) = json.loads((tmp_path / "rows.json").read_text())["setups"]
    assert row["setup"] == "sim, r = 1.5"
    assert {"mvpc_aw", "mvpc", "aimc_iae"} <= set(row)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scenario", "thesis-3"], "scenario is 'thesis-3', must be table-3.1, thesis-1, thesis-2, toroid, or"),
        (
            ["--scenario", "thesis-1", "--controller", "pid"],
            "controller is 'pid', must be one of aimc",
        ),
        (["--scenario", "thesis-1", "--png", "x"], "--png goes with --out"),
        (["--scenario", "table-3.1", "--out", "x"], "takes no --out"),
        (
            ["--scenario", "thesis-1", "--set", "midranging.estimating.seconds=20"],
            "not accurate after session.lead of 14 s",
        ),
        (["--scenario", "thesis-1", "--set", "midranging.simulator.options.mass=1"], "does not take these options"),
        (
            ["--scenario", "thesis-1", "--set", "midranging.simulator.plant=numpy:array"],
            "numpy:array is a builtin_function_or_method, must be the class of a Block",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_in_a_line(arguments: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _run(*arguments)


@pytest.mark.parametrize(
    ("unit", "size", "message"),
    [("V", 1e-3, "channel wanted is in V, must be in m"), ("m", 1.5e3, "goes 1500 m far, must stay within 10 m")],
)
def test_a_reference_of_another_unit_or_far_too_large_is_refused(
    tmp_path: Path, unit: str, size: float, message: str
) -> None:
    file = tmp_path / "wanted.csv"
    write(file, Recording(("wanted",), (unit,), 250.0, np.full((10, 1), size)))
    with pytest.raises(ValueError, match=message):
        _run("--scenario", str(file))


def test_a_live_run_whose_wire_cannot_be_had_leaves_no_folder(tmp_path: Path) -> None:
    wire, out = f"link.channel={tmp_path}/can", tmp_path / "run"
    far = "midranging.pair.travel=1e-4"
    with pytest.raises(LinkError, match="cannot open link.channel"):
        _run("--scenario", "thesis-1", "--controller", "mvpc", "--live", "--set", wire, "--set", far, "--out", str(out))
    assert not out.exists()


def test_a_live_run_that_asks_for_more_than_the_stage_moves_is_refused() -> None:
    with pytest.raises(ValueError, match=r"midranging.pair.travel is 0.025 m, must be <= 0.000328 m in a live run"):
        _run("--scenario", "thesis-1", "--live")


def test_feeding_the_slow_loop_forward_takes_it_out_of_the_error() -> None:
    config = rig_file.load(None, MidrangeConfig, ["valve.feed=1.0"])
    chosen = Scenario("step", np.full(1125, 1.5e-3))
    assert iae(simulate(controller("mvpc", config), chosen, config)) == pytest.approx(0.15e-3, rel=0.05)


def test_the_scenarios_are_those_of_section_3_3() -> None:
    first, second = scenario("thesis-1", 250.0), scenario("thesis-2", 250.0)
    assert (first.options["disturbance"], first.options["disturbed_at"]) == (5e-3, 18.0)
    assert second.gains == ((8.0, 1.5), (16.0, 0.6))
    np.testing.assert_allclose((first.reference[: len(second.reference)] - second.reference) * 250.0 / 0.5e-3,
                               np.arange(len(second.reference)), atol=1e-9)  # fmt: skip


@pytest.mark.slow
def test_a_toroid_that_is_stopped_on_its_last_axis_is_kept_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _stop_after(monkeypatch, 1.7 * 59)
    with pytest.raises(Stopped, match=r"^stopped by its user: .*; what is recorded is in .*run/$"):
        _run("--scenario", "toroid", "--out", str(tmp_path / "run"))
    y, z = (read(tmp_path / f"run/recording-{axis}.wav", rate=250.0) for axis in "yz")
    assert 0 < len(z.data) < len(y.data)
    assert "Off the circle" in (tmp_path / "run/report.html").read_text()


def test_a_run_that_is_stopped_in_its_lead_says_that_there_is_nothing_to_judge(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _stop_after(monkeypatch, 5.0)
    with pytest.raises(Stopped, match=r"stopped by its user: nothing .* had not begun; what is recorded is in .*run/$"):
        _run("--scenario", "thesis-1", "--out", str(tmp_path / "run"))
    assert len(read(tmp_path / "run/recording.wav").data) == pytest.approx(5.0 * 250, abs=100)
    assert read_events(tmp_path / "run")[-1]["reason"] == "stopped by its user"
    assert all(each.identical for each in replayed(tmp_path / "run", MIDRANGING))


def test_a_toroid_that_is_stopped_on_its_first_axis_has_figures_of_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _stop_after(monkeypatch, 62.0)
    with pytest.raises(Stopped, match="these are the figures of what was run until then"):
        _run("--scenario", "toroid", "--controller", "mvpc", "--out", str(tmp_path / "run"))
    assert list(json.loads((tmp_path / "run/summary.json").read_text())["axes"]) == ["y"]


def _stop_after(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    """Have a run stopped after about so many seconds of its own time, of all parts."""
    asked = round(seconds * ASKED)

    class After(StopRequest):
        @property
        def made(self) -> bool:  # type: ignore[override]
            nonlocal asked
            asked -= 1
            return asked < 0

    monkeypatch.setattr("rigkit.experiment.command.stoppable", lambda: nullcontext(After()))
