"""The other procedures of the cell under the daemon, and which rig a file is of."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.config import ConfigError
from rigkit.experiment.kept import records_of
from rigkit.service.reload import Reach
from rigkit.service.state import State
from stagectl.daemon.kinds import CELL, STAGE, kind_of
from stagectl.experiments.feed.options import ForceOptions
from stagectl.experiments.feed.pocketed import Kept
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.read_back import read_back
from stagectl.experiments.midranging.options import MidrangeOptions
from stagectl.experiments.toroid.options import CellOptions
from stagectl.experiments.toroid.plan import SETUPS
from stagectl.planning.pocket import PLANNERS
from stagectl.robot.midranging.controllers import CONTROLLERS
from tests.stagectl.daemon.bench import Lab
from tests.stagectl.daemon.cell.bench import cell_in, edit
from tests.stagectl.experiments.feed.small_pocket import QUICK
from tests.stagectl.experiments.feed.test_command import POCKET
from tests.stagectl.experiments.toroid.short_cell import SHORT
from tests.until import until


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = cell_in(tmp_path, *QUICK, *SHORT, "midranging.session.lead=0.2")
    (made.data / "small.json").write_text(json.dumps(POCKET))
    yield made
    made.close()


def pockets(lab: Lab) -> list[Kept]:
    records = records_of(lab.run_folder())
    made = read_back(lab.run_folder(), records)
    assert isinstance(made, Pockets)
    return made.kept(records)


def test_a_pocket_is_milled_by_force_and_what_is_believed_of_it_is_shown(lab: Lab) -> None:
    lab.begin("force", task="small.json", force=8.0, planner="uncertain", prior="prior.json")
    until(lambda: any(gauge.name == "kappa" and gauge.interval for gauge in lab.rig.gauges()))
    kappa = lab.gauge("kappa")
    assert kappa.interval is not None
    assert kappa.interval[0] < kappa.value < kappa.interval[1]
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert json.loads((lab.data / "prior.json").read_text())["lots"]
    (kept,) = pockets(lab)
    assert kept.plan.cell.force.force == 8.0
    assert not kept.done.reason
    assert (lab.run_folder() / "report.html").is_file()
    panels = lab.control.board
    assert set(panels.revisions()) == {"force", "feed", "kappa", "beta", "pockets", "types"}
    (trace,) = panels.panel("beta")["traces"]
    known = np.isfinite(trace["y"])
    assert known.any()
    assert (trace["low"][known] < trace["y"][known]).all()


def test_a_stop_holds_the_robot_that_mills_by_force_and_keeps_the_pocket(lab: Lab) -> None:
    lab.begin("force", task="small.json", pockets=2)
    until(lambda: any(gauge.name == "feed" and (gauge.value or 0.0) > 1e-3 for gauge in lab.rig.gauges()))
    lab.control.stop("Ada", "smoke")
    lab.ended()
    assert lab.state is State.DISARMED
    (kept,) = pockets(lab)
    assert kept.done.reason == "stopped by its user"
    asked = kept.done.recording.select([f"reference_{joint}" for joint in range(1, 7)]).data
    assert np.ptp(asked[-50:], axis=0).max() < 1e-9
    assert np.abs(np.diff(asked[-400:], axis=0)).max() > 1e-6


def test_a_setup_of_the_toroid_is_milled_and_measured(lab: Lab) -> None:
    lab.begin("cell", setup="A")
    until(lambda: any(gauge.name == "deviation_y" for gauge in lab.rig.gauges()))
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert (lab.run_folder() / "report.html").is_file()
    assert lab.control.board.panel("accuracy")["rows"][0][0] == "A"


def test_a_position_is_shared_as_a_file_says(lab: Lab) -> None:
    wanted = 1e-3 * np.sin(np.linspace(0.0, 6.0, 250))[:, None]
    recording.write(lab.data / "wave.csv", Recording(("x",), ("m",), 250.0, wanted))
    lab.begin("midrange", scenario="wave.csv", controller="vpc")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    kept = recording.read(lab.run_folder() / "recording.wav")
    np.testing.assert_allclose(kept.select(["reference"]).data[50:], wanted)  # behind the lead
    assert set(lab.control.board.revisions()) == {"position", "manipulators", "control"}
    assert lab.events("finished")[0]["iae"] > 0.0


def test_steps_are_made_and_read_off(lab: Lab) -> None:
    lab.begin("step", period=1.0, repeats=2)
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert (lab.run_folder() / "report.html").is_file()
    assert set(lab.control.board.revisions()) == {"robot", "stage", "control"}
    found = json.loads((lab.run_folder() / "summary.json").read_text())
    assert found["stage"]["time_constant"] == pytest.approx(0.098, abs=1e-3)


@pytest.mark.parametrize(
    ("procedure", "options", "words"),
    [
        ("step", {"kind": "impulse"}, 'kind is "impulse", must be "step" or "multisine"'),
        ("ilc", {"speed": 3}, "speed is 3, but ilc has no speed; "),
        ("ilc", {"run": "../x"}, 'run is "../x", must be text, matching '),
        ("ilc", {"method": "4"}, 'method is "4", must be text, matching '),
        ("ilc", {"resume": True, "run": ""}, 'run is "", must be the name of the run to go on with, since resume'),
        ("ilc", {"resume": True, "run": "a", "joints": "j.h5"}, 'joints is "j.h5", must be "" where resume is true'),
        ("ilc", {"joints": "joints.txt"}, 'joints is "joints.txt", must be text, matching '),
        ("force", {"prior": "../prior.json"}, 'prior is "../prior.json", must be text, matching '),
        ("force", {"force": None}, "force is null, must be a number >= 0 and <= 1000 N"),
        ("force", {"force": float("nan")}, "force is NaN, must be a number >= 0 and <= 1000 N"),
        ("force", {"planner": "magic"}, 'planner is "magic", must be "exact" or "sequential" or '),
        (
            "force",
            {"planner": "exact", "untrained": True},
            'planner is "exact", must be sequential or uncertain, since',
        ),
        ("cell", {"setup": "D"}, 'setup is "D", must be "A" or "B" or "C" or '),
        ("calibrate-joints", {"joints": "3-"}, 'joints is "3-", must be text, matching '),
        ("calibrate-joints", {"model": "joints.txt"}, 'model is "joints.txt", must be text, matching '),
    ],
)
def test_options_that_cannot_be_are_refused_and_the_rig_stays_armed(
    lab: Lab, procedure: str, options: dict[str, object], words: str
) -> None:
    lab.control.arm(lab.key, "a test")
    with pytest.raises(ConfigError) as refused:
        lab.control.begin(lab.key, procedure, options, "")
    assert str(refused.value).startswith(words)
    assert lab.state is State.ARMED


@pytest.mark.parametrize(
    ("procedure", "options", "words"),
    [
        ("force", {"task": "process"}, "task is 'process', must be slot, pocket, or a file in the data folder, "),
        ("force", {"model": "../x.h5"}, "model is '../x.h5', must be a file in the data folder, "),
        ("force", {"prior": "prior.json"}, "planner is 'sequential', must be uncertain to keep a prior in "),
        ("cell", {"stage": "none.toml"}, "stage is 'none.toml', must be a file in the data folder, "),
        ("step", {"of": "stage", "size": 0.05}, "size is 0.05 m, must be <= midranging.pair.travel, 0.025 m"),
        ("midrange", {"scenario": "nix"}, "scenario is 'nix', must be thesis-1, thesis-2, toroid, or a file in the "),
        ("calibrate-joints", {"joints": "3,7"}, "joints are '3,7': '7' must be a number or a range from 1 to 6"),
    ],
)
def test_files_and_joints_that_are_not_there_are_named_with_their_option(
    lab: Lab, procedure: str, options: dict[str, object], words: str
) -> None:
    lab.control.arm(lab.key, "a test")
    lab.control.begin(lab.key, procedure, options, "")
    lab.ended()
    assert lab.state is State.ARMED
    assert f" has not begun: {words}" in lab.why
    assert not any((lab.data / "runs").iterdir())


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"[" * 200_000, "objects or lists nested more than 12 deep"),
        (b'{"rows": "\xff"}', "byte 0xff in line 1 is not UTF-8"),
        (b'{"rows": NaN}', "rows is NaN, must be finite"),
        (b'{"rows": 6, "rows": 7}', 'the key "rows" is there twice'),
    ],
    ids=range(4),
)
def test_a_pocket_that_is_no_sound_json_is_refused_in_one_line_and_the_rig_stays_armed(
    lab: Lab, content: bytes, says: str
) -> None:
    (lab.data / "wrong.json").write_bytes(content)
    lab.begin("force", task="wrong.json")
    lab.ended()
    assert lab.state is State.ARMED, lab.why
    assert lab.why == f"Mill by force has not begun: {lab.data}/wrong.json: {says}"
    assert not lab.run_folder().exists()


@pytest.mark.parametrize(
    ("procedure", "key"),
    [
        ("midrange", "midranging.session.live"),
        ("step", "midranging.session.live"),
        ("calibrate-joints", "clamping.live"),
    ],
)
def test_what_is_live_is_not_paced(tmp_path: Path, procedure: str, key: str) -> None:
    lab = cell_in(tmp_path, f"{key}=true")
    lab.control.arm(lab.key, "a test")
    lab.control.begin(lab.key, procedure, {"paced": True}, "")
    lab.ended()
    assert lab.state is State.ARMED
    assert lab.why.partition(": ")[2] == f"paced is true, must be false where {key} is true: the robot is the clock"
    lab.close()


@pytest.mark.parametrize(
    ("setting", "options", "words"),
    [
        ("robot.commands=6511", {"paced": True}, "paced is true, must be false where live is true: the robot is the "),
        ("robot.commands=0", {}, "robot.commands is 0, must be the port of the robot's program: guided motion begins "),
    ],
)
def test_a_live_toroid_that_cannot_be_is_refused(
    tmp_path: Path, setting: str, options: dict[str, object], words: str
) -> None:
    lab = cell_in(tmp_path, setting)
    lab.begin("cell", setup="A", live=True, **options)
    lab.ended()
    assert lab.state is State.ARMED
    assert f" has not begun: {words}" in lab.why
    assert not any((lab.data / "runs").iterdir())
    lab.close()


def test_a_reload_holds_from_the_next_procedure_on(lab: Lab) -> None:
    edit(lab.file, lab.data, "force.force=12", "daemon.lease=20")
    change = lab.rig.reload()
    assert change.keys["force.force"] is Reach.GRAPH
    assert change.done == "from the next procedure on; [daemon] when the daemon is started again"
    assert lab.rig.config.force.force == 12.0


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("daemon.faults=true", "daemon.faults is true, must be false for a robot cell"),
        ("robot.arm='puma'", "the arm is 'puma', must be irb140, kuka, or an arm's file"),
    ],
)
def test_a_file_that_cannot_be_served_is_refused_at_the_start_and_at_a_reload(
    lab: Lab, setting: str, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        cell_in(lab.data, setting)
    before = lab.rig.config
    edit(lab.file, lab.data, setting)
    with pytest.raises(ValueError, match=words):
        lab.rig.reload()
    assert lab.rig.config is before


def test_the_choices_of_options_are_what_there_is_to_choose_from() -> None:
    assert get_args(ForceOptions.model_fields["planner"].annotation) == PLANNERS, "planner of feed/options.py"
    assert get_args(CellOptions.model_fields["setup"].annotation) == (*SETUPS, "all")
    assert get_args(MidrangeOptions.model_fields["controller"].annotation) == tuple(sorted(CONTROLLERS))


def test_a_file_tells_by_its_tables_which_rig_it_is_of(tmp_path: Path) -> None:
    file = tmp_path / "rig.toml"
    for text, kind in (("[daemon]\n", STAGE), ("[outer]\n", STAGE), ("[pocket]\n[daemon]\n", CELL)):
        file.write_text(text)
        assert kind_of(file) is kind
    assert kind_of(None, ["robot.port=6600"]) is CELL
    assert kind_of(None) is STAGE
    file.write_text("[outer]\n[robot]\n")
    with pytest.raises(ConfigError, match=r"rig.toml: \[outer\] is a stage's and \[robot\] is a robot cell's, must be"):
        kind_of(file)


def test_a_stage_s_file_that_names_foreign_code_is_refused_before_it_is_imported(lab: Lab) -> None:
    named = '[simulator]\nplant = "subprocess:Popen"\noptions = {args = ["touch", "touched"]}\n'
    (lab.data / "stage.toml").write_text(named)
    lab.begin("cell", setup="C", stage="stage.toml")
    lab.ended()
    assert lab.state is State.ARMED
    assert "simulator.plant is 'subprocess:Popen', must be code that the daemon was started with" in lab.why
    assert not Path("touched").exists()
    edit(lab.file, lab.data, "plants.robot=os:system")
    with pytest.raises(ValueError, match="plants.robot is 'os:system', must be code that the daemon was started with"):
        lab.control.reload(lab.key)
