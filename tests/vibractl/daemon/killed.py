"""A vibrator's daemon as its processes, on a plant that writes down every sample it is driven with."""

import os
import select
import signal
import subprocess
import sys
from bisect import bisect
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rigkit import config as rig_file
from rigkit.service.config import Daemon
from tests.rigkit.service.served import ROOT, Served, answering, free_port, offspring
from tests.until import EVER
from vibractl.config import Audio, Learning, Reference, RigConfig, Simulator
from vibractl.model_file import write_model
from vibractl.transfer_matrix import TransferMatrix

RATE = 44_100
ROOM = 120
"""s of drive that are written down."""


def straight_model(path: Path) -> None:
    """Write the model of a plant that follows its drive."""
    lines = np.arange(15.0, 650.5, 0.5)
    response = np.broadcast_to(np.eye(2, dtype=complex), (len(lines), 2, 2)).copy()
    about = {"rig": "simulated-vibrator"}
    write_model(path, TransferMatrix(lines, response, np.full(response.shape, 1e-6), np.ones(response.shape), about))


@dataclass
class KilledDaemon(Served):
    """A daemon, and what its plant was driven with."""

    log: Path

    def written(self) -> int:
        """Return how many samples the plant has been driven with until now, in some microseconds."""
        if not self.log.exists():
            return 0
        drive = np.memmap(self.log, np.float64, "r").reshape(-1, 2)
        return bisect(range(len(drive)), 0, key=lambda sample: int(np.isnan(drive[sample, 0])))

    def drive(self) -> np.ndarray:
        """Return what the plant has been driven with until now, (samples, coils), V."""
        drive = np.fromfile(self.log).reshape(-1, 2)
        return drive[np.isfinite(drive[:, 0])]

    def command(self, name: str, procedure: str = "run", **options: Any) -> None:
        """Take control and give one command."""
        with self.client() as client, client.control("Ada", over=True):
            client.begin(procedure, **options) if name == "begin" else client.command(name, "a test")

    def done(self) -> int:
        """Return the shots that are recorded, as the event log says."""
        return max((int(entry["shot"]) + 1 for entry in self.named("shot")), default=0)

    def kill(self) -> float:
        """Kill the rig's process; return for how long the drive went on afterwards, s."""
        others = [os.pidfd_open(pid) for pid in offspring(self.process.pid)]
        before = self.written()
        self.process.send_signal(signal.SIGKILL)
        for pid in others:
            assert select.select([pid], [], [], EVER)[0], "a process outlived the rig's"
            os.close(pid)
        self.process.wait()
        if not self.log.exists():
            return 0.0
        after = self.drive()[before:]
        loud = np.flatnonzero(after.any(axis=1))
        return float(loud[-1] + 1) / RATE if len(loud) else 0.0


def straight_rig(folder: Path, mute_after: float) -> RigConfig:
    """Return the settings of a rig whose plant follows its drive in real time."""
    log = {"file": str(folder / "log"), "capacity": ROOM * RATE}
    return RigConfig(
        audio=Audio(),
        reference=Reference(signal="chirp:40:90:1", amplitude=1.0),
        learning=Learning(law="thesis", gains=(0.5,)),
        simulator=Simulator(plant="tests.vibractl.drive_log:DriveLog", speed=1.0, options=log),
        daemon=Daemon(address=f"127.0.0.1:{free_port()}", data=str(folder / "data"), mute_after=mute_after),
    )


@contextmanager
def straight_daemon(folder: Path, mute_after: float = 1.0) -> Iterator[KilledDaemon]:
    """Start `vibractl daemon` on that rig, and see that it is gone afterwards.

    Muted is what stands still; a machine that is busy with other tests does so for a tenth of a second.
    """
    (folder / "data").mkdir(exist_ok=True)
    if not (folder / "data" / "model.h5").exists():
        straight_model(folder / "data" / "model.h5")
    config = straight_rig(folder, mute_after)
    (folder / "rig.toml").write_text(rig_file.dump(config))
    command = [sys.executable, "-m", "vibractl", "daemon", "--config", str(folder / "rig.toml")]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    with answering(KilledDaemon(config.daemon, process, folder / "log")) as made:
        yield made
