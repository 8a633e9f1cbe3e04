"""A stage, or a robot cell, under the daemon's authority, without processes."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rigkit import config as rig_file
from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.rig import Rig
from rigkit.service.show import Gauge
from rigkit.service.state import State
from stagectl.config import StageConfig
from stagectl.daemon.stage.rig import PiezoStage
from tests.rigkit.service.told_once import check_told_once
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.until import until

CHOSEN = {
    "bandwidth": "[200.0, 50.0, 50.0]",
    "drive": "[0.27, 0.9, 0.9]",
    "trust": "[1.0, 1.0, 1.0]",
    "doubt": "[0.0, 0.0, 0.0]",
    "caution": "[3.0, 0.0, 1.0]",
    "feedforward": "[1.0, 1.0, 1.0]",
}
QUICK = ["session.recording=wav", "session.lead=0.5", "session.seconds=0.5"]


@dataclass
class Lab:
    """A rig, its control and the rig file it reads."""

    rig: Any
    control: Control
    key: str
    file: Path
    data: Path

    @property
    def state(self) -> State:
        return self.control.machine.state

    @property
    def why(self) -> str:
        return self.control.machine.last.why

    def run_folder(self) -> Path:
        return self.data / "runs" / "one"

    def gauge(self, name: str) -> Gauge:
        return next(gauge for gauge in self.rig.gauges() if gauge.name == name)

    def begin(self, procedure: str = "follow", **options: Any) -> None:
        if self.state is State.DISARMED:
            self.control.arm(self.key, "a test")
        self.control.begin(self.key, procedure, {"run": "one", **options}, "")

    def ended(self) -> None:
        until(lambda: self.control.settle() or not self.control.machine.busy)
        check_told_once(self.control)

    def until_follows(self) -> None:
        """Return when an error of the run proper is measured."""
        until(lambda: self._follows() or not self.control.machine.busy)
        assert self._follows(), f"{self.state.name}: {self.why}"

    def _follows(self) -> bool:
        return any(gauge.name == "mae_x" and gauge.value is not None for gauge in self.rig.gauges())

    def events(self, name: str) -> list[dict[str, Any]]:
        return [entry for entry in self.control.journal.since(0) if entry["event"] == name]

    def close(self) -> None:
        self.control.close(60)
        self.control.journal.close()


def lab_in(folder: Path, *settings: str) -> Lab:
    """Return a stage that has been calibrated, in a folder."""
    data, file = folder / "data", folder / "stage.toml"
    (data / "runs").mkdir(parents=True)
    for model in write_models(data):
        model.rename(data / f"stage-{model.name}")
    edit(file, data, *settings)
    return lab_of(PiezoStage(lambda: rig_file.load(file, StageConfig)), file, data)


def lab_of(rig: Rig, file: Path, data: Path) -> Lab:
    """Return a rig with its control."""
    control = Control(rig, Lease(1e6), Journal(data / "events.jsonl"))
    return Lab(rig, control, control.take_control("Ada", False)["key"], file, data)


def edit(file: Path, data: Path, *settings: str) -> None:
    """Write the rig file anew."""
    chosen = [f"weights.{name}={values}" for name, values in CHOSEN.items()]
    quick = [*QUICK, "outer.mistuning=0.0"]
    whole = rig_file.load(None, StageConfig, [*quick, *chosen, f"daemon.data={data}", *settings])
    file.write_text(rig_file.dump(whole))
