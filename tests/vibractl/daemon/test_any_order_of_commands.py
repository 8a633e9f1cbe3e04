"""Commands in any order, on the vibrator's own rig: no illegal step, and a drive within limits from rest to rest."""

import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from rigkit import config as rig_file
from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.state import NotNow
from tests.rigkit.service.test_state import ENDING, LEGAL
from tests.until import until
from tests.vibractl.daemon.kept_drive import KeptDrive
from tests.vibractl.daemon.killed import straight_model
from vibractl.config import Audio, Daemon, Learning, Limits, Reference, RigConfig, Simulator
from vibractl.daemon.rig import Vibrator

RATE = 44_100
LIMITS = Limits()
SHOTS = 60
"""More than any walk lives to hear, and no more than a full disk has room for: a third of a gigabyte."""
COMMANDS = (
    "arm",
    "disarm",
    "begin",
    "hold",
    "resume",
    "abort",
    "stop",
    "acknowledge",
    "reload",
    "wait",
    "play",
    "finish",
)


class Walk:
    """A vibrator that is commanded at random.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: Path) -> None:
        (folder / "runs").mkdir()
        straight_model(folder / "model.h5")
        self._config = RigConfig(
            audio=Audio(isolated=False, attempts=1),
            reference=Reference(signal="chirp:40:90:4", amplitude=1.0),
            learning=Learning(law="thesis", gains=(0.5,)),
            simulator=Simulator(plant="tests.vibractl.daemon.kept_drive:KeptDrive"),
            daemon=Daemon(data=str(folder)),
        )
        self._peak = LIMITS.peak
        self.journal = Journal(folder / "events.jsonl")
        self.control = Control(Vibrator(self._load), Lease(1e6), self.journal)
        self._key = self.control.take_control("Ada", False)["key"]
        self._runs = 0
        self.quiet: list[tuple[int, int]] = []
        """From where to where nothing may have been played: after a STOP, until the next run."""
        KeptDrive.openings.clear()

    def _load(self) -> RigConfig:
        limits = self._config.limits.model_copy(update={"peak": self._peak})
        return rig_file.load(None, RigConfig).model_copy(
            update={
                name: getattr(self._config, name) for name in ("audio", "reference", "learning", "simulator", "daemon")
            }
            | {"limits": limits}
        )

    def do(self, command: str) -> None:
        """Give a command; what the state does not allow is refused."""
        ways: dict[str, Callable[[], object]] = {
            "begin": self._begin,
            "stop": self._stop,
            "reload": self._reload,
            "wait": self._wait,
            "play": self._play,
            "finish": lambda: self.ended(),
        }
        known = ways.get(command, lambda: getattr(self.control, command)(self._key, "at random"))
        with suppress(NotNow):
            known()

    def ended(self) -> None:
        """Let what is under way come to its end."""
        if self.control.machine.busy:
            self.control.stop("Ada", "enough")
            until(lambda: self.control.settle() or not self.control.machine.busy)

    def _begin(self) -> None:
        self._runs += 1
        self.control.begin(self._key, "run", {"run": str(self._runs), "shots": SHOTS}, "")

    def _stop(self) -> None:
        self.control.stop("Bob", "at random")
        begin = KeptDrive.samples()
        until(lambda: self.control.settle() or not self.control.machine.busy)
        self.quiet.append((begin + round(LIMITS.ramp * RATE) + 101 * 512, KeptDrive.samples()))

    def _reload(self) -> None:
        self._peak = 8.0 if self._peak == LIMITS.peak else LIMITS.peak
        assert self.control.reload(self._key)["keys"] == ["limits.peak"]

    def _wait(self) -> None:
        """Until a shot more is recorded, if a run goes on."""
        before = self.control.desk and self.control.desk.plain()["done"]
        until(lambda: self.control.machine.state != "RUNNING" or self._done() > (before or 0))

    def _play(self) -> None:
        """Until half a second more was played, if a run goes on: in the middle of a shot."""
        before = KeptDrive.samples()
        until(lambda: self.control.machine.state != "RUNNING" or KeptDrive.samples() > before + RATE // 2)

    def _done(self) -> float:
        return self.control.desk.plain()["done"] if self.control.desk else float("inf")


@settings(max_examples=2, suppress_health_check=[HealthCheck.too_slow])
@example(["stop", "arm", "begin", "play", "stop"])
@given(st.lists(st.sampled_from(COMMANDS), min_size=4, max_size=14))
def test_commands_in_any_order(commands: list[str]) -> None:
    walked(commands)


@pytest.mark.slow
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.sampled_from(COMMANDS), min_size=4, max_size=14))
def test_many_commands_in_any_order(commands: list[str]) -> None:
    walked(commands)


def walked(commands: list[str]) -> None:
    """Give the commands in the midst of a run, and look at the states and the drive that came of it."""
    with tempfile.TemporaryDirectory() as folder:
        walk = Walk(Path(folder))
        for command in ("arm", "begin", "wait", "play", *commands):
            walk.do(command)
        walk.ended()
        told = [entry for entry in walk.journal.since(0) if "before" in entry]
        walk.control.close(60)
        walk.journal.close()
    assert told
    assert {(entry["event"], entry["before"], entry["state"]) for entry in told} <= LEGAL | ENDING
    assert not [entry for entry in told if entry["event"] == "fault"]
    assert not [entry["why"] for entry in told if "has not begun" in entry["why"]]
    played = KeptDrive.played()
    assert np.abs(played).max() <= LIMITS.peak
    for opening in KeptDrive.openings:
        drive = np.concatenate([np.zeros((1, 2)), *opening, np.zeros((1, 2))])  # it was at rest, and is again
        assert np.abs(np.diff(drive, axis=0)).max() * RATE <= LIMITS.slew
    assert played.any()
    for begin, end in walk.quiet:
        assert not played[begin:end].any()
