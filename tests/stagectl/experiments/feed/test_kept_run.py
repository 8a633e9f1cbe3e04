"""A run of force control in its folder: killed, stopped, and read where the version before has written it.

Guards against recordings that a kill takes along, and against folders that a lab has and that can no longer be read.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, records_of, run
from rigkit.experiment.runner import STOPPED, Conduct
from stagectl.application import PROGRAM
from stagectl.experiments.feed.job import Job
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.read_back import FORCE, Files, read_back
from tests.stagectl.experiments.feed.small_pocket import small
from tests.stagectl.experiments.feed.test_command import POCKET, WORDS
from tests.until import until


def _run(*arguments: str) -> None:
    PROGRAM.only(arguments[0])(list(arguments), standalone_mode=False)


def _of(path: Path) -> Pockets:
    made = read_back(path, records_of(path))
    assert isinstance(made, Pockets)
    return made


@pytest.fixture
def pocket(tmp_path: Path) -> str:
    file = tmp_path / "pocket.json"
    file.write_text(json.dumps(POCKET))
    return str(file)


def test_of_the_pocket_under_way_all_but_the_last_moments_are_kept(tmp_path: Path, pocket: str) -> None:
    path = tmp_path / "run"
    words = [sys.executable, "-m", "stagectl", "force", "--task", pocket, "--paced", "--out", str(path), *WORDS]
    growing = path / "force-1.part.wav"
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        until(lambda: (growing.exists() and os.stat(growing).st_size > 400_000) or program.poll() is not None)
        program.send_signal(signal.SIGKILL)
    assert program.returncode == -signal.SIGKILL
    _run("report", str(path))
    (row,) = json.loads((path / "summary.json").read_text())["pockets"]
    assert row["fault"] == "killed"
    assert row["force_peak"] > 5.0
    again = list(replayed(path, FORCE))
    assert len(again) > 30
    assert all(each.identical for each in again)


def _stopped(path: Path, asked: float) -> None:
    """Mill the first of two pockets, and stop after so many seconds of it."""
    plan, seen = small(), [0.0]
    made = Pockets(plan.cell, Job("pocket", plan.pocket, "exact", pockets=2), plan.model)
    files = Files(made.job, None)

    def stopped() -> bool:
        seen[0] += 1.0
        return seen[0] > asked

    with create(path, FORCE, plan.cell, made, files.take_into) as folder:
        reasons, found = run(folder, FORCE, made, Conduct(stopped))
    assert reasons == {"force-1": STOPPED}
    assert [each["fault"] for each in found["pockets"]] == [STOPPED]


@pytest.mark.parametrize("asked", [3, 40, 60], ids=["before it follows", "on the way", "in the wood"])
def test_a_pocket_that_its_user_stops_is_replayed_into_its_hold(tmp_path: Path, asked: float) -> None:
    _stopped(tmp_path / "run", asked)
    again = list(replayed(tmp_path / "run", FORCE))
    assert len(again) > 30
    assert all(each.identical for each in again)


def _as_of_old(run: Path, path: Path) -> None:
    """Write a run as version 0.1.0 did: a table for each pocket, and what was chosen in the events."""
    made, records = _of(run), records_of(run)
    shutil.copytree(run, path, ignore=shutil.ignore_patterns("*.wav", "events.jsonl", "report.html", ".lock"))
    events = []
    for each in made.kept(records):
        record = each.done.recording
        kept = record.select([name for name in record.names if not name.startswith("cut_")])
        about = {"control": each.plan.control, "piece": str(each.plan.piece)}
        bare = Recording(kept.names, kept.units, kept.rate, kept.data, about)
        recording.write(path / f"{each.plan.name}.csv", bare)
        if each.plan.feeds is not None:
            (path / "feeds.json").write_text(json.dumps(dict(each.plan.feeds)))
        chosen = [segment.in_path for segment in each.done.segments]
        told = {"time": "2026-01-01T00:00:00Z", "event": "milled", "name": each.plan.name}
        events.append(json.dumps({**told, "reason": each.done.reason, "path": chosen}))
    (path / "events.jsonl").write_text("\n".join(events) + "\n")


def test_a_folder_of_the_version_before_is_reported_and_replayed(tmp_path: Path, pocket: str) -> None:
    run, old = tmp_path / "run", tmp_path / "old"
    _run("force", "--task", pocket, "--compare", "--out", str(run), *WORDS)
    _as_of_old(run, old)
    _run("report", str(old))
    found, before = (json.loads((each / "summary.json").read_text()) for each in (old, run))
    assert found == before
    _run("replay", str(old))
    assert len((old / "segments.csv").read_text()) == len((run / "segments.csv").read_text())  # but for a strip's side
