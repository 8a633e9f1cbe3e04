"""A week in the lab at random: each step is one that a technician might take, and the truth is kept beside it.

What was recorded under which rig file is written down here, and not asked of the program: so that what a model or a run
says of its origin can be found false.
"""

import multiprocessing
import os
import random
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from calibration.__main__ import main as calibrate
from rigkit import config as rig_file
from rigkit.origin import RUN, checksum, flat, read_origin
from rigkit.service.client import DaemonError
from tests.rigkit.service.served import ROOT, Served, answering, free_port
from tests.scenario.lab import Lab
from tests.scenario.lab_week import RIG
from tests.until import until
from vibractl.__main__ import main as vibractl
from vibractl.config import RigConfig
from vibractl.model_file import read_model

WIRED = ("audio.input_full_scale", "audio.output_full_scale", "audio.drive_channels", "rig.name")
"""What a model must share with the rig that it is used on."""
MACHINE = "simulator.options.seed"
EDITS = (
    ("audio.input_full_scale=300.0",), ("audio.input_full_scale=400.0",), ("audio.output_full_scale=15.0",),
    ("audio.output_full_scale=10.0",), ("audio.drive_channels=[1, 2]",), ("audio.drive_channels=[2, 1]",),
    ("rig.name=other", "simulator.options.seed=3"), ("rig.name=other", "simulator.options.seed=3"),
    ("rig.name=simulated-vibrator", "simulator.options.seed=1"), ("audio.attempts=2",), ("audio.attempts=3",),
    ("rig.name=simulated-vibrator", "simulator.options.seed=2"), ("limits.peak=8.0",), ("limits.peak=9.0",),
)  # fmt: skip
"""No two rig files of which recordings would be the same bits: no scale is twice another, each machine has its seed."""
MODELS, RUNS = ("a.h5", "b.h5"), ("runs/one", "runs/two", "runs/three")
SHORT = (*RIG, "audio.attempts=3", "simulator.options.seed=1")

Truth = dict[str, Any]
"""Wiring and machine, by key, as they were."""


def truth_of(config: Path) -> Truth:
    """Return what a rig file says of wiring and machine, read as plain TOML."""
    told = flat(tomllib.loads(config.read_text()))
    return {key: told[key] for key in (*WIRED, MACHINE)}


@dataclass
class Week:
    """A lab, and what truly happened in it.

    Parameters
    ----------
    lab : Lab
        With a rig file, and nothing else.
    chance : random.Random
    steps : list of str
        What was done, for whoever reads of a failure.
    """

    lab: Lab
    chance: random.Random
    steps: list[str] = field(default_factory=list)
    recorded: dict[str, list[Truth]] = field(default_factory=dict)
    measured: dict[str, list[Truth]] = field(default_factory=dict)
    stops: list[float] = field(default_factory=list)
    """s that each STOP of a daemon has taken."""
    broken_off: str | None = None
    """The model whose measurement was broken off last, and may be gone on with."""
    planned: list[Callable[[], str]] = field(default_factory=list)
    """What comes next, before anything at random."""

    @classmethod
    def begun(cls, path: Path, seed: int) -> "Week":
        """Return a lab that has measured and learned once."""
        path.mkdir()
        (path / "rig.toml").write_text(rig_file.dump(rig_file.load(None, RigConfig, SHORT)))
        (path / "runs").mkdir()
        week = cls(Lab(path), random.Random(seed))
        words = ("run", "--config", "rig.toml", "--model", "a.h5", "--out", "runs/one", "--shots", "1")
        week.do(lambda: week._call(calibrate, "vibrator", "--config", "rig.toml", "--out", "a.h5"))
        week.do(lambda: week._call(vibractl, *words))
        return week

    def step(self) -> None:
        """Do what was planned, or something at random."""
        if self.planned:
            self.do(self.planned.pop(0))
            return
        kinds: tuple[tuple[Callable[[], str], int], ...] = (
            (self._calibrate, 4), (self._edit, 3), (self._swap, 2), (self._copy, 1), (self._run, 4),
            (self._resume, 4), (self._edit_run, 1), (self._kill, 1), (self._break_off, 3), (self._prune, 1),
            (self._stop, 1),
        )  # fmt: skip
        self.do(self.chance.choices([kind for kind, _ in kinds], [weight for _, weight in kinds])[0])

    def do(self, does: Callable[[], str]) -> None:
        """Do something, and look whether all that is there says the truth."""
        rig = truth_of(self.lab.path / "rig.toml")
        runs = {run: truth_of(run / "config.toml") for run in self._runs()}
        before = self._recordings()
        self.steps.append(f"{does.__name__}: ")
        self.steps[-1] += does()
        self._look(rig, runs, before, is_pruned=does == self._prune)

    def _call(self, program: Callable[[], int], *words: str) -> str:
        status, said = self.lab.call(program, *words)
        assert status in (0, 2), (status, said)
        assert "Traceback" not in said
        assert status == 0 or said.count("error: ") == 1, said
        return f"{' '.join(words)}: {said.strip().splitlines()[-1] if status else 'done'}"

    def _calibrate(self) -> str:
        """Measure; most often go on with what was broken off, whatever became of the rig file in between."""
        out, flags = self.chance.choice(MODELS), self.chance.choice(((), (), ("--again",), ("--recompute",)))
        if self.broken_off is not None and self.chance.random() < 0.8:
            out, flags, self.broken_off = self.broken_off, (), None
        return self._call(calibrate, "vibrator", "--config", "rig.toml", "--out", out, *flags)

    def _edit(self) -> str:
        edit = self.chance.choice(EDITS)
        self.lab.edit("rig.toml", RigConfig, *edit)
        return ", ".join(edit)

    def _swap(self) -> str:
        places = [*MODELS, *(f"{run.relative_to(self.lab.path)}/model.h5" for run in self._runs())]
        there = [place for place in places if (self.lab.path / place).is_file()]
        if len(there) < 2:
            return "nothing to swap"
        source, target = self.chance.sample(there, 2)
        shutil.copyfile(self.lab.path / source, self.lab.path / target)
        return f"{source} over {target}"

    def _copy(self) -> str:
        runs = self._runs()
        target = self.lab.path / "runs" / f"copy-{len(self.steps)}"
        if runs:
            shutil.copytree(self.chance.choice(runs), target, ignore=shutil.ignore_patterns(".lock"))
        return target.name

    def _run(self) -> str:
        return self._call(vibractl, *self._fresh())

    def _fresh(self) -> tuple[str, ...]:
        model, run, shots = self.chance.choice(MODELS), self.chance.choice(RUNS), self.chance.randint(1, 2)
        return tuple(f"run --config rig.toml --model {model} --out {run} --shots {shots}".split())

    def _resume(self) -> str:
        runs = self._runs()
        if not runs:
            return "nothing to resume"
        run = self.chance.choice(runs)
        shots = len(list((run / "shots").glob("*.wav"))) + 1
        return self._call(vibractl, "run", "--resume", str(run.relative_to(self.lab.path)), "--shots", str(shots))

    def _edit_run(self) -> str:
        runs = self._runs()
        if not runs:
            return "nothing to edit"
        run, edit = self.chance.choice(runs), self.chance.choice(EDITS)
        self.lab.edit(f"{run.relative_to(self.lab.path)}/config.toml", RigConfig, *edit)
        return f"{run.name}: {', '.join(edit)}"

    def _kill(self) -> str:
        """Begin to measure or to learn, and kill it at any moment."""
        out = self.chance.choice(MODELS)
        program, words = self.chance.choice(
            ((calibrate, ("vibrator", "--config", "rig.toml", "--out", out)), (vibractl, self._fresh()))
        )
        self._begun_and_killed(lambda process: process.join(self.chance.uniform(0.05, 1.5)), program, *words)
        return f"killed: {' '.join(words)}"

    def _break_off(self) -> str:
        """Begin to measure, and kill it when a part is recorded: so that there is something that goes on.

        In every other case somebody edits the rig file, and then goes on.
        """
        out = self.chance.choice(MODELS)
        before = self._sounds()
        words = ("vibrator", "--config", "rig.toml", "--out", out, *(["--again"] * (self.lab.path / out).is_file()))

        def recorded(process: BaseProcess) -> None:
            until(lambda: not process.is_alive() or self._sounds() > before + 1)

        self._begun_and_killed(recorded, calibrate, *words)
        self.broken_off, self.planned = out, [self._edit, self._calibrate] * (self.chance.random() < 0.5)
        return f"broken off: {' '.join(words)}"

    def _begun_and_killed(self, when: Callable[[BaseProcess], None], program: Callable[[], int], *words: str) -> None:
        process = multiprocessing.get_context("fork").Process(target=self.lab.call, args=(program, *words))
        process.start()
        when(process)
        process.kill()
        process.join()

    def _prune(self) -> str:
        return self._call(vibractl, "prune", "runs", "--newest", "2")

    def _stop(self) -> str:
        """No daemon runs: that is said, from any folder, and nothing is made there."""
        place = self._anywhere()
        before = sorted(place.iterdir())
        with_rig = Lab(place).call(vibractl, "stop", "--config", str(self.lab.path / "rig.toml"))
        assert with_rig[0] == 2
        assert sorted(place.iterdir()) == before
        return "stop"

    def daemon(self) -> str:
        """Have a daemon learn, and stop it from any folder while it does."""
        rig, model = self.lab.path / "rig.toml", self.lab.path / self.chance.choice(MODELS)
        if not model.is_file():
            return "no model for a daemon"
        (self.lab.path / "data").mkdir(exist_ok=True)
        shutil.copyfile(model, self.lab.path / "data" / "model.h5")
        self.lab.edit("rig.toml", RigConfig, f"daemon.address=127.0.0.1:{free_port()}")
        command = [sys.executable, "-m", "vibractl", "daemon", "--config", str(rig)]
        process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        with answering(Served(rig_file.load(rig, RigConfig).daemon, process)) as served:
            return self._stopped(served, f"daemon-{len(self.steps)}")

    def _stopped(self, served: Served, run: str) -> str:
        with served.client() as client, client.control("Ada"):
            client.command("arm", "a test")
            try:
                client.begin("run", run=run, shots=1000)
            except DaemonError as fault:
                return f"the daemon does not begin: {fault}"
        until(lambda: served.named("shot") or served.named("end"))
        place = self._anywhere()
        begin = time.monotonic()
        status, said = Lab(place).call(vibractl, "stop", "--config", str(self.lab.path / "rig.toml"))
        assert (status, said) == (0, "")
        with served.client() as client:
            until(lambda: client.snapshot()["state"]["name"] == "DISARMED")
        self.stops.append(time.monotonic() - begin)
        until(lambda: served.named("end"))
        return f"{run} was stopped from {place}"

    def _anywhere(self) -> Path:
        return self.chance.choice(
            [Path("/"), self.lab.path, *(path for path in self.lab.path.rglob("*") if path.is_dir())]
        )

    def _runs(self) -> list[Path]:
        return sorted(path.parent for path in self.lab.path.glob("**/runs/*/config.toml"))

    def _sounds(self) -> int:
        """Return how many there are; unlike a glob, a walk does not mind that another process moves them."""
        return sum(name.endswith(".wav") for *_, names in os.walk(self.lab.path) for name in names)

    def _recordings(self) -> dict[str, Path]:
        return {checksum(path): path for path in sorted(self.lab.path.rglob("*.wav"))}

    def _look(self, rig: Truth, runs: dict[Path, Truth], before: dict[str, Path], is_pruned: bool) -> None:
        after = self._recordings()
        assert is_pruned or not before.keys() - after.keys(), "a recording is lost"
        for total in after.keys() - before.keys():
            run = after[total].parents[1]
            self.recorded.setdefault(total, []).append(runs.get(run, rig))
        for path in sorted(self.lab.path.rglob("*.h5")):
            if path.parent.name != "shots" and not path.parent.name.startswith("."):
                self._look_at_model(path)
        for run in self._runs():
            self._look_at_run(run, after.keys() - before.keys())

    def _look_at_model(self, path: Path) -> None:
        """See that a new model says that it was measured with what its recordings were made with."""
        total = checksum(path)
        told = flat(tomllib.loads(read_model(path).provenance["config"]))
        said = {key: told[key] for key in (*WIRED, MACHINE)}
        if total not in self.measured:
            sounds = sorted(path.with_suffix(".raw").glob("*.wav"))
            assert sounds, f"{path} is new, and there is no recording of it"
            self.measured[total] = [truth for sound in sounds for truth in self.recorded[checksum(sound)][-1:]]
        assert all(truth == said for truth in self.measured[total]), f"{path} says {said}: {self.measured[total]}"

    def _look_at_run(self, run: Path, new: set[str]) -> None:
        """See that a run says that it began with what its shots were made with, and that its own model drove it."""
        shots = [checksum(path) for path in sorted((run / "shots").glob("*.wav"))]
        origin = read_origin(run / RUN)
        assert origin is not None
        for total in shots:
            truths = self.recorded[total]
            told = {key: origin.flat[key] for key in WIRED}
            assert told in [{key: truth[key] for key in WIRED} for truth in truths], f"{run}: {told}, {truths}"
        if new.intersection(shots):
            models = self.measured[checksum(run / "model.h5")]
            fits = all(truth[key] == origin.flat[key] for truth in models for key in WIRED)
            assert fits, f"{run} was driven with a model of {models}"
            assert origin.parts["model.h5"] == checksum(run / "model.h5"), f"{run} went on with another model"
