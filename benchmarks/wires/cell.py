"""The simulated cell of the benchmark: its file's settings, both its other ends as processes, the live commands."""

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from stagectl.doctor.wake_up import is_real_time_granted

WIRES = {"abb": "egm", "kuka": "rsi"}
"""By the make of the robot."""
_END = 30.0
"""s for a simulator to end."""


@dataclass(frozen=True)
class Setup:
    """What stands there while some commands are run.

    Parameters
    ----------
    name : str
    commands : tuple of (str, tuple of str)
        What a command is called in the table, and what is typed; {round} and {stage} stand for folders.
    settings : tuple of str
        Of the cell.
    robot : tuple of str
        More of `firmware-sim robot`; {can} stands for the stage's folder.
    stage : tuple of str or None
        More of `firmware-sim stage`; None where there is none.
    """

    name: str
    commands: tuple[tuple[str, tuple[str, ...]], ...]
    settings: tuple[str, ...] = ()
    robot: tuple[str, ...] = ()
    stage: tuple[str, ...] | None = None


_CHANGER = "robot.changer=true"
_AXES = tuple(word for axis in "xyz" for word in ("--model", f"{{stage}}/s-{axis}.h5"))
_LOOPS = (
    "stagectl run: its loops",
    ("stagectl", "run", "--live", "--config", "{stage}/s.toml", *_AXES, "--seconds", "1", "--out", "{round}/LOOPS"),
)
_LIVE = ("--live", "--yes", "--out")
SETUPS = (
    Setup(
        "wood",
        (
            ("calibrate velocity", ("calibration", "velocity", *_LIVE, "{round}/velocity.h5")),
            (
                "stagectl force --task slot",
                ("stagectl", "force", "--task", "slot", "--model", "{round}/velocity.h5", *_LIVE, "{round}/FORCE"),
            ),
            (
                "stagectl force --planner uncertain --untrained",
                (
                    *("stagectl", "force", "--task", "slot", "--planner", "uncertain", "--untrained", "--model"),
                    *("{round}/velocity.h5", *_LIVE, "{round}/UNTRAINED"),
                ),
            ),
        ),
        (_CHANGER,),
        ("--wood",),
    ),
    Setup(
        "pair",
        (
            _LOOPS,
            (
                "stagectl midrange --controller aimc",
                ("stagectl", "midrange", "--scenario", "toroid", "--live", "--out", "{round}/MIDRANGE"),
            ),
        ),
        (
            "midranging.pair.travel=150e-6",
            "midranging.pair.slow_outputs=[0.98]",
            "midranging.pair.slow_inputs=[0.02]",
            "midranging.estimating.fast_amplitude=50e-6",
            "midranging.estimating.slow_amplitude=200e-6",
        ),
        stage=(),
    ),
    Setup(
        "toroid",
        (
            _LOOPS,
            *(
                (f"stagectl cell --setup {setup}", ("stagectl", "cell", "--setup", setup, *_LIVE, f"{{round}}/{setup}"))
                for setup in ("A", "B", "C", "C-fixed")
            ),
        ),
        ("robot.arm=kuka", "toroid.turn=0.1"),
        ("--plate", "{can}/plate"),
        (),
    ),
    Setup(
        "deflection",
        (
            (
                "stagectl run --scenario milling-y",
                (
                    *("stagectl", "run", "--live", "--config", "{stage}/s.toml", *_AXES, "--seconds", "10"),
                    *("--scenario", "milling-y", "--out", "{round}/DEFLECTION"),
                ),
            ),
        ),
        stage=("--milling", "y", "--set", "session.seconds=10"),
    ),
    Setup(
        "clamp",
        (
            (
                "calibrate joints --joints 3",
                ("calibration", "joints", "--live", "--joints", "3", "--out", "{round}/joints.h5"),
            ),
        ),
    ),
    Setup(
        "mill",
        (
            ("calibrate milling", ("calibration", "milling", *_LIVE, "{round}/milling.h5")),
            (
                "stagectl ilc --method all",
                (
                    *("stagectl", "ilc", "--method", "all", "--iterations", "1", "--model", "{round}/milling.h5"),
                    *(*_LIVE, "{round}/ILC"),
                ),
            ),
        ),
        (_CHANGER,),
        ("--mill",),
    ),
)
"""In the order in which they stand there."""


@dataclass(frozen=True)
class Bench:
    """Where the cell's wires are, and how its ends are run.

    Parameters
    ----------
    wire : str, of the robot
    port : int, UDP, of the program that leads it; TCP and force sensor have those behind
    priority : int, real-time, of the simulators, one less than the commands'; 0 for what they take themselves
    silence : int, cycles
        robot.silence; other limits are as patient.
    stage : Path, folder with the stage's rig file s.toml and its models
    """

    wire: str
    port: int
    priority: int
    silence: int
    stage: Path

    def settings(self, setup: Setup, can: Path) -> list[str]:
        """Return what is set of the cell, `--set` and all."""
        port, patience = self.port, self.silence / 250
        given = [f"robot.wire={self.wire}", f"robot.port={port}", f"robot.silence={self.silence}"]
        given += [f"robot.lag={max(0.05, patience)}", f"tracker.port={port + 3}", f"force_sensor.port={port + 4}"]
        given += [f"robot.commands={port + 1}", f"robot.signals={port + 2}"] if self.wire == "egm" else []
        given += ["robot.commands=0", "robot.signals=0"] if self.wire == "rsi" else []
        given += [f"{table}={max(least, patience)}" for table, least in _PATIENCE.items()]
        return _set([*given, *self.link(can), *setup.settings])

    def link(self, can: Path) -> list[str]:
        """Return what is set of the stage's link."""
        return [f"link.channel={can}/can", f"link.silence={max(0.02, self.silence / 250)}", "link.patience=20"]

    def typed(self, words: Sequence[str], setup: Setup, can: Path, folder: Path) -> list[str]:
        """Return a command as it is run."""
        words = [word.format(round=folder, stage=self.stage, can=can) for word in words]
        of_stage = words[:2] == ["stagectl", "run"]
        settings = _set(self.link(can)) if of_stage else self.settings(setup, can)
        return self.run([*words, *settings], self.priority + 1)  # the other ends have computers of their own

    def run(self, words: Sequence[str], priority: int) -> list[str]:
        """Return how a module is run, with a priority where it is granted."""
        first = ["chrt", "-f", str(priority)] if self.priority and is_real_time_granted() else []
        return [*first, sys.executable, "-m", *words]

    @contextlib.contextmanager
    def standing(self, setup: Setup, can: Path) -> Iterator[None]:
        """Have a setup's simulators stand there for the length of the block."""
        with contextlib.ExitStack() as stack:
            if setup.stage is not None:
                patience = _set([each for each in self.link(can) if "silence" in each])
                stage = ["firmware_sim", "stage", "--pty", "--folder", str(can), *setup.stage, *patience]
                stage += ["--config", str(self.stage / "s.toml")]
                stack.enter_context(_simulator(self.run(stage, self.priority), "CAN adapter"))
            robot = ["firmware_sim", "robot", *(word.format(can=can) for word in setup.robot)]
            robot += self.settings(setup, can)
            stack.enter_context(_simulator(self.run(robot, self.priority), "force sensor"))
            yield


_PATIENCE = {"tracker.blind": 0.05, "tracker.lag": 0.05, "force_sensor.silence": 0.02}


def free_port() -> int:
    """Return a UDP port that is free; those behind it are taken to be."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def _set(settings: Sequence[str]) -> list[str]:
    return [word for each in settings for word in ("--set", each)]


@contextlib.contextmanager
def _simulator(command: list[str], last: str) -> Iterator[None]:
    """Run a simulator until the block is left; it is there once its last address is printed."""
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        try:
            while not (line := process.stdout.readline()).startswith(last):
                if not line:
                    raise OSError(f"{' '.join(command[-8:])} does not start")
            yield
        finally:
            process.terminate()
            process.wait(_END)
