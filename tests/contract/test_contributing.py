"""CONTRIBUTING.md's plant, robot, laws, planner and experiment are what they say: taken by their names, and run."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from ctlblocks import Block
from rigkit import config as rig_file
from rigkit.config import ConfigError
from rigkit.experiment.runner import Conduct, remembered
from stagectl.config import StageConfig
from stagectl.experiments.piezo.experiment import StageRun
from stagectl.experiments.piezo.setup import setup
from stagectl.experiments.trials.methods import ByModels, Milled
from stagectl.planning import pocket_check
from stagectl.planning.milling import mill
from stagectl.planning.problem import Pocket
from stagectl.robot.config import CellConfig
from stagectl.robot.conversation import PortState
from stagectl.robot.force_inbox import ForceInbox
from stagectl.robot.milling.learning import PathLaw
from stagectl.robot.port import RobotPort
from stagectl.robot.tracker_inbox import TrackerInbox
from stagectl.wire.force_sensor import SATURATED, Record
from stagectl.wire.makes import FORCE_SENSORS, ROBOTS, TRACKERS
from stagectl.wire.robot import RATE
from stagectl.wire.tracker import Sample, Sighting
from tests.contract.conformance import CHECKS, Example
from tests.contract.source_tree import ROOT
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.stagectl.robot.milling.trial_models import axis, square
from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS, KindOfLaw

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
LONGEST = 60
"""Lines of a module of the page."""


def source_of(begin: str) -> str:
    """Return the page's code that begins so."""
    parts = [textwrap.dedent(part.split("```")[0]) for part in PAGE.split("```python\n")]
    source = next(part for part in parts if part.startswith(begin))
    assert len(source.splitlines()) <= LONGEST
    return source


def from_page(name: str) -> ModuleType:
    """Make the page's module of that name."""
    source = source_of(f'"""{name}')
    module = ModuleType(name)
    exec(source, module.__dict__)  # noqa: S102 (the page's own code)
    return module


@pytest.fixture
def plant(monkeypatch: pytest.MonkeyPatch) -> type[Block]:
    """Import the page's plant as `own_plant`."""
    module = from_page("own_plant")
    monkeypatch.setitem(sys.modules, "own_plant", module)
    made: type[Block] = module.LaggingStage
    return made


def test_it_does_what_every_block_does(plant: type[Block]) -> None:
    for check in CHECKS:
        check(Example(plant, rate=10_000.0))


@pytest.mark.usefixtures("plant")
def test_a_stage_is_run_on_it(tmp_path: Path) -> None:
    quick = ["simulator.plant=own_plant:LaggingStage", "session.lead=0.5", "session.seconds=0.2", "outer.mistuning=0.0"]
    (part,) = StageRun(setup(rig_file.load(None, StageConfig, quick), write_models(tmp_path))).parts()
    records, _ = remembered(part, Conduct())
    position = records["recording"].select(["position_x", "position_y", "position_z"]).data
    assert position.std(axis=0).min() > 1e-5  # m: the voltages have risen to rest, and it has followed them


def test_the_law_learns_but_for_what_it_lets_fade(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a model that is right, U = 0.99 U + 0.5 G^+ (R - G U) leaves E = 0.01 / 0.51 of R."""
    half = Gains((0.5,), ())
    monkeypatch.setitem(KINDS, "thesis", KindOfLaw("", from_page("leaky_law").LeakyLaw(), half, half))
    true = modal(2, 2)
    law = law_of(matrix_of(true), law="thesis", epsilon=0.0, floor=0.0)
    algorithm, plant = Algorithm(law, Adaptation(), Watch(on=False), -40.0), LinePlant(true, law, 1e-12)
    error = np.zeros(0)
    for _ in range(30):
        shot = plant.shot(algorithm.lines)
        error = law.reference - shot.response
        algorithm.step(shot)
    left = 0.01 / 0.51 * np.abs(law.reference).max()
    assert np.abs(error).max() == pytest.approx(left, rel=1e-3)


def test_the_law_can_be_named_by_the_registry_which_the_rig_file_reads() -> None:
    """A law that imports what reads the rig file is a circle, which only a fresh process sees."""
    source = source_of('"""leaky_law')
    code = f"import sys\n{source}\nsys.exit('vibractl.config' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"a law must not import vibractl.config, which imports the registry: {done.stderr}"


def test_the_law_of_milling_goes_half_as_far() -> None:
    wanted = square()
    law, off = PathLaw((axis(2),) * 3), np.asarray(1e-4 * np.sin(np.arange(len(wanted)) / 20))[:, None]
    milled = Milled(wanted, [wanted], [wanted - off], [None])
    whole, half = (each.next(law, milled) - wanted for each in (ByModels(), from_page("half_steps").HalfSteps()))
    assert np.abs(whole).max() > 1e-5
    np.testing.assert_allclose(half, 0.5 * whole, atol=1e-15)


def test_the_planner_mills_a_pocket() -> None:
    pocket = Pocket(4, 6, 2, "EW", {f"{way}{strip}": 1.0 for way in "EW" for strip in ("2", "1u", "1d")})
    path = [each.in_path for each in mill(pocket, from_page("widest").WidestPlanner(pocket))]
    assert pocket_check.check(pocket, path).complete


def test_bounds_of_the_law_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a model that is right: what fades of the drive counts."""
    half = Gains((0.5,), ())
    monkeypatch.setitem(KINDS, "thesis", KindOfLaw("", from_page("leaky_law").LeakyLaw(), half, half))
    true = modal(2, 2)
    law = law_of(matrix_of(true), law="thesis", epsilon=0.0, floor=0.0)
    algorithm, plant = Algorithm(law, Adaptation(), Watch(on=False), -40.0), LinePlant(true, law, 1e-12)
    inside = []
    for number in range(12):
        shot = plant.shot(algorithm.lines)
        error = np.linalg.norm(law.reference - shot.response, axis=1)
        if number:
            inside.append(float(np.mean(error <= algorithm.daring.computed_bound + 1e-9)))
        algorithm.step(shot)
    assert min(inside) > 0.98


def test_a_robot_of_another_make_is_a_line_of_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ConfigError, match='robot.wire is "lines": must be one of egm, rsi'):
        rig_file.load(None, CellConfig, ["robot.wire=lines"])
    monkeypatch.setitem(ROBOTS, "lines", from_page("own_robot").Lines)
    talk = RobotPort(rig_file.load(None, CellConfig, ["robot.wire=lines"])).conversation
    for counter, angle in enumerate(("5", "5", "nan", "five", "5")):
        talk.take(f"{counter},0,0,0,0,30,{angle}".encode(), ("127.0.0.1", 1), counter / RATE)
        if talk.report is not None and talk.state is PortState.IDLE:
            assert talk.give() == b"%d,0,0,0,0,30,5" % counter
            talk.begin()
    home = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 5.0])
    talk.wanted.put(home, home + np.radians(0.01))
    assert talk.give() == b"4,0.01,0.01,0.01,0.01,30.01,5.01"
    assert (talk.reason, talk.counts.garbled, talk.counts.lost) == ("", 2, 2)


def test_a_tracker_of_another_make_is_a_line_of_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    class Spoken:
        """Says a counter and where frame 7 is, m, in a line of text."""

        modulus, garbled = 1 << 32, 0

        def take(self, data: bytes) -> list[Sample]:
            rows = [[float(each) for each in line.split()] for line in data.splitlines()]
            return [
                Sample(int(n), n / 100, (Sighting(7, 5, 0.0, np.array([*place, 1.0, 0.0, 0.0, 0.0])),))
                for n, *place in rows
            ]

        def forget(self) -> None: ...

    monkeypatch.setitem(TRACKERS, "spoken", Spoken)
    inbox = TrackerInbox(rig_file.load(None, CellConfig, ["tracker.wire=spoken"]).tracker, print)
    inbox.take(b"1 0.1 0.2 0.3\n2 0.1 0.2 0.4\n", 0.0)
    np.testing.assert_allclose(inbox.pose[:3], [0.1, 0.2, 0.4])


def test_a_force_sensor_of_another_make_is_a_line_of_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    class Spoken:
        """Says a counter, whether it is at the end of its range, and six counts, in a line of text."""

        modulus, start, stop = 1 << 32, b"start", b"stop"

        def read(self, data: bytes, counts: np.ndarray) -> list[Record]:
            rows = [[int(each) for each in line.split()] for line in data.splitlines()]
            return [Record(n, n, SATURATED if full else 0, np.array(six) / counts) for n, full, *six in rows]

    with pytest.raises(ConfigError, match='force_sensor.wire is "spoken": must be one of netft'):
        rig_file.load(None, CellConfig, ["force_sensor.wire=spoken"])
    monkeypatch.setitem(FORCE_SENSORS, "spoken", Spoken)
    sensor = rig_file.load(None, CellConfig, ["force_sensor.wire=spoken", "force_sensor.saturated=0"]).force_sensor
    inbox = ForceInbox(sensor, print)
    for record in FORCE_SENSORS[sensor.wire]().read(b"1 0 0 0 2000000 0 0 0\n3 0 0 0 3000000 0 0 0", sensor.counts):
        inbox.accept(record, 0.0)
    np.testing.assert_allclose(inbox.wrench, [0, 0, 3, 0, 0, 0])
    assert (inbox.counts.lost, inbox.counts.saturated) == (1, 0)
    for record in FORCE_SENSORS[sensor.wire]().read(b"4 1 0 0 0 0 0 0", sensor.counts):
        inbox.accept(record, 0.0)
    assert inbox.counts.saturated == 1


REGISTERED = """
import sys
from rigkit.experiment.registration import Registration, Served
from stagectl.experiments import registry
own = ({entry},)
registry.CELL += own
registry.EXPERIMENTS += own
from stagectl.application import PROGRAM
from stagectl.daemon.cell.procedures import procedures
for words in (
    ["--help"],
    ["ramp", "--of", "stage", "--period", "1", "--repeats", "2", "--out", "RUN"],
    ["report", "RUN"],
    ["replay", "RUN"],
    ["export", "RUN", "--to", "parquet"],
):
    sys.argv[1:] = words
    assert PROGRAM.run() == 0, words
made = next(each for each in procedures(lambda maker: maker) if each.name == "ramp")
print(made.run, sorted(made.options.model_fields))
"""


def test_its_experiment_is_run_reported_replayed_exported_and_served(tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "__init__.py").touch()
    (tmp_path / "own" / "ramps.py").write_text(source_of('"""own/ramps.py'), encoding="utf-8")
    code = REGISTERED.format(entry=source_of("Registration("))
    paths = {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=os.environ | paths, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Ask robot and stage for ramps" in done.stdout
    assert " µm off" in done.stdout
    assert "own.ramps:procedure ['highest', 'kind', 'of', 'paced', 'period', 'repeats', 'run', 'size']" in done.stdout
    assert {each.name for each in (tmp_path / "RUN").iterdir()} >= {
        "steps.wav",
        "report.html",
        "summary.json",
        "export",
    }
