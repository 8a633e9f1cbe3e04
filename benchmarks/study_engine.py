"""What a study costs beside its tasks, and what it bears.

`python -m benchmarks.study_engine [--tasks 24] [--kills 400]`, minutes.

Throughput: as many tasks a second as two processes that share them and know nothing of a study, both in turn in one
run, from the first task to the last.  Overhead: a task that does next to nothing, in a warm worker.  Kills: tasks that
wait for a second, while a worker is killed every five, must end with the hash of an undisturbed run.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from rigkit.progress import progress
from rigkit.stop import StopRequest
from rigkit.study import programs
from rigkit.study.crew import ENVIRONMENT, Worker
from rigkit.study.engine import Study
from rigkit.study.folder import StudyFolder
from rigkit.study.local import local
from rigkit.study.plan import Plan, read_plan
from rigkit.study.results import study_hash
from rigkit.study.task import Task
from stagectl.planning.example_pocket import EXAMPLE_POCKET
from tests.vibrostage.killing import killed_every
from tests.vibrostage.trial import programs_with_trial

PROCESSES = 2
ROUNDS = 2
POCKETS = 400
"""Of a task: about a second on one core."""
STUDY = f"""
name = "pockets"
commands = [
  "stagectl plan pocket.json --planner uncertain --untrained --pockets {POCKETS} --seed {{seed}} --json t.json",
]
files = ["pocket.json"]
seeds = {{first = %d, count = %d}}
figures.gap = {{file = "t.json", path = "pockets[-1].gap"}}
"""
WAITING = """
name = "waiting"
commands = ["trial {seed} second told.json"]
seeds.count = %d
figures.gap = {file = "told.json", path = "gap"}
"""
ALONE = """
import json, os, sys, time
from rigkit.study import programs
tasks = json.loads(sys.stdin.readline())
programs.call(tasks[0])
print("ready", flush=True)
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # a pipe that nobody reads would fill
sys.stdin.readline()
for words in tasks[1:]:
    assert programs.call(words) == 0
"""


def plan(folder: Path, first: int, count: int) -> Plan:
    (folder / "pocket.json").write_text(EXAMPLE_POCKET)
    (folder / "study.toml").write_text(STUDY % (first, count))
    return read_plan(folder / "study.toml", programs.names())


def in_a_study(place: Path, count: int) -> float:
    """Return tasks a second, of workers that are warm as those of `alone` are."""
    made = plan(place, 0, PROCESSES + count)
    with StudyFolder(place / "out", made) as folder, local(PROCESSES, folder.files, folder.tasks) as hands:
        first = [task for seed, _ in zip(made.seeds(), range(PROCESSES), strict=False) for task in seed]
        for future in [hands.executor.submit(hands.perform, task) for task in first]:
            future.result()
        study = Study(folder)
        began = time.perf_counter()
        with progress("study", 1.0) as meter:
            study.run(hands, meter, StopRequest())
        return (PROCESSES + count) / (time.perf_counter() - began)


def alone(place: Path, count: int) -> float:
    """Return tasks a second of processes that share the tasks and know nothing of each other."""
    made = plan(place, 0, PROCESSES + count + PROCESSES)
    tasks = [list(task.commands[0]) for seed in made.seeds() for task in seed]
    environment = {**os.environ, **ENVIRONMENT}
    own = []
    for number in range(PROCESSES):
        folder = place / str(number)
        folder.mkdir()
        (folder / "pocket.json").write_text(EXAMPLE_POCKET)
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
        pipes["start_new_session"] = True  # as a study's workers: the kernel shares the cores among sessions
        own.append(subprocess.Popen([sys.executable, "-c", ALONE], cwd=folder, env=environment, **pipes))
        own[-1].stdin.write(json.dumps(tasks[number::PROCESSES]) + "\n")
        own[-1].stdin.flush()
    for process in own:
        while process.stdout.readline() != "ready\n":
            pass
    began = time.perf_counter()
    for process in own:
        process.stdin.write("\n")
        process.stdin.close()
    for process in own:
        process.stdout.read()
        assert process.wait() == 0
    return (PROCESSES + count) / (time.perf_counter() - began)


def throughput(count: int) -> None:
    ratios = []
    for number in range(ROUNDS):
        with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
            rates = {}
            for which in (in_a_study, alone) if number % 2 else (alone, in_a_study):
                rates[which] = which(Path(one if which is alone else other), count)
        ratios.append(rates[in_a_study] / rates[alone])
        print(f"study {rates[in_a_study]:.3f}, alone {rates[alone]:.3f} tasks/s: {ratios[-1]:.3f}", flush=True)
    print(f"throughput of {PROCESSES} workers re {PROCESSES} independent processes: {np.median(ratios):.3f} (median)")


def overhead() -> None:
    with tempfile.TemporaryDirectory() as place:
        files, scratch = Path(place, "files"), Path(place, "tasks")
        files.mkdir()
        scratch.mkdir()
        worker, spent = Worker(files, scratch), []
        for number in range(220):
            task = Task(f"{number}", "none", number, {}, (("vibractl", "--version"),), {}, 60.0, "nothing")
            began = time.perf_counter()
            outcome = worker.perform(task)
            spent.append((time.perf_counter() - began, outcome.cpu))
        worker.end()
    wall, cpu = 1e3 * np.array(spent[20:]).T
    print(
        f"a task that does nothing: {np.median(wall):.1f} ms (95 %: {np.quantile(wall, 0.95):.1f}), "
        f"{np.median(cpu):.1f} ms of processor time"
    )


def kills(count: int) -> None:
    """Tasks that wait for a second, without a kill and with one every five seconds."""
    with tempfile.TemporaryDirectory() as place, pytest.MonkeyPatch.context() as patch:
        programs_with_trial(Path(place), patch)
        calm = waited(Path(place) / "calm", count)
        killed, disturbed = killing(Path(place), count)
    print(f"{killed} kills; the hash is {'the same' if calm == disturbed else 'ANOTHER'}")


def killing(place: Path, count: int) -> tuple[int, str]:
    with killed_every(5.0, os.getpid()) as killed:
        found = waited(place / "disturbed", count)
    return len(killed), found


def waited(place: Path, count: int) -> str:
    """Run the tasks, and return the study's hash."""
    place.mkdir()
    (place / "study.toml").write_text(WAITING % count)
    made = read_plan(place / "study.toml", programs.names())
    with StudyFolder(place / "out", made) as folder:
        with local(PROCESSES, folder.files, folder.tasks) as hands, progress("kills", 1.0) as meter:
            Study(folder).run(hands, meter, StopRequest())
        rows = folder.rows()
    again, failed = sum(row.tries - 1 for row in rows), sum(row.status != 0 for row in rows)
    print(f"{len(rows)} tasks, {failed} failed, begun again {again} times", flush=True)
    return study_hash(rows, made.figures)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--tasks", type=int, default=24)
    parser.add_argument("--kills", type=int, default=0)
    given = parser.parse_args()
    overhead()
    if given.tasks:
        throughput(given.tasks)
    if given.kills:
        kills(given.kills)


if __name__ == "__main__":
    main()
