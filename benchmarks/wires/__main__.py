"""Live commands over the simulated wires of a robot cell, one after another, with every silence on its wire counted.

`python -m benchmarks.wires --make abb --minutes 30 --stage FOLDER`, as root: `firmware-sim robot` of that make stands
on this computer, and beside it, where a command needs one, `firmware-sim stage`; each live command is run as a user
runs it, with `--yes`, and begun again in a new folder when all have had their turn.  What goes over the robot's wire is
noted by the kernel's clock.  A witness on each core tells when the machine itself stood still.

FOLDER has the stage's rig file and models: `calibrate stage --config stage.toml --axis all --out FOLDER/s.h5`.
"""

import argparse
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.page_table import table
from benchmarks.wires.cell import SETUPS, WIRES, Bench, Setup, free_port
from benchmarks.wires.listener import Listener
from benchmarks.wires.silences import MACHINE, OURS, ROBOT, Heard, heard
from benchmarks.wires.witness import seen, witnesses
from rigkit.run_folder import read_events

HEAD = (
    "command", "runs", "cycles", "longest from answer to answer, ms", "over 12 ms", MACHINE, ROBOT, OURS,
    "report to answer, 99.9 %, ms", "unanswered", "ended",
)  # fmt: skip
_ATTEMPTS = 4
_SETTLED = 6.0
"""s in which the witnesses have written what they saw."""


def main() -> None:
    """Run for so many minutes, and print the table."""
    given = _given()
    folder = given.out or Path(tempfile.mkdtemp(prefix="wires-"))
    folder.mkdir(parents=True, exist_ok=True)
    wire = WIRES[given.make]
    bench = Bench(wire, given.port or free_port(), given.priority, given.silence, given.stage.absolute())
    rows = list[dict[str, Any]]()
    with witnesses(folder) as files, Listener(bench.port) as listener:
        for row in _runs(bench, folder, listener, time.monotonic() + 60 * given.minutes, given.only):
            rows.append(row)
            _say(row)
        time.sleep(_SETTLED)
    late = [seen(file) for file in files]
    found = [(row["command"], row["ended"], _judged(folder / row["times"], late)) for row in rows]
    kept = [dict(zip(("command", "ended", "heard"), (a, b, asdict(c)), strict=True)) for a, b, c in found]
    (folder / "wires.json").write_text(json.dumps({"make": given.make, "lost": listener.lost, "runs": kept}, indent=1))
    print(
        f"\n{given.make}, robot.silence={bench.silence}, load {os.getloadavg()[1]:.1f}, {listener.lost} packets unseen"
    )
    for file, each in zip(files, late, strict=True):
        over = each[:, 1]
        print(f"{file.stem}: {(over > 0.004).sum()} times over 4 ms late, worst {1e3 * over.max(initial=0.0):.1f} ms")
    print(f"\n{table(HEAD, _rows(found))}")


def _given() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--make", choices=sorted(WIRES), default="abb")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--stage", type=Path, required=True, help="folder with s.toml and s-AXIS.h5")
    parser.add_argument("--out", type=Path, help="folder for runs and figures")
    parser.add_argument("--priority", type=int, default=10, help="of the simulators, one less than of commands; or 0")
    parser.add_argument("--silence", type=int, default=25, help="robot.silence, in cycles, and patience elsewhere")
    parser.add_argument("--port", type=int, default=0, help="UDP, and four behind it; else any that is free")
    parser.add_argument("--only", nargs="*", default=[each.name for each in SETUPS], help="of the setups")
    return parser.parse_args()


def _runs(bench: Bench, folder: Path, listener: Listener, until: float, only: list[str]) -> Iterator[dict[str, Any]]:
    """Run all commands in turn until the time is up; one that has begun comes to its end."""
    for number in count(1):
        here = folder / f"round-{number}"
        here.mkdir()
        for setup in (each for each in SETUPS if each.name in only):
            if time.monotonic() > until:
                return
            yield from _setup(bench, setup, here, listener, until)


def _setup(bench: Bench, setup: Setup, here: Path, listener: Listener, until: float) -> Iterator[dict[str, Any]]:
    """Run a setup's commands; a calibration that was held is begun again, and goes on from there."""
    (here / setup.name).mkdir()
    with tempfile.TemporaryDirectory() as can, bench.standing(setup, Path(can)):
        for number, (name, words) in enumerate(setup.commands):
            command = bench.typed(words, setup, Path(can), here / setup.name)
            out = Path(words[words.index("--out") + 1].format(round=here / setup.name))
            for attempt in range(_ATTEMPTS if name.startswith("calibrate") else 1):
                if time.monotonic() > until or (attempt and out.exists()):
                    break
                yield _run(name, command, out, here / f"{setup.name}-{number}-{attempt}", listener)


def _run(name: str, command: list[str], out: Path, file: Path, listener: Listener) -> dict[str, Any]:
    listener.taken()
    begin = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    file.with_suffix(".log").write_text(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    times = file.with_suffix(".npz")
    np.savez(times, **dict(zip(("reports", "answers", "refused"), listener.taken(), strict=True)))
    path = str(times.relative_to(file.parents[1]))
    return {"command": name, "times": path, "ended": _ended(done, out), "seconds": time.monotonic() - begin}


def _ended(done: subprocess.CompletedProcess[str], run: Path) -> str:
    """Return why a command has ended, from its run's events or by its own words."""
    events = [event for event in read_events(run) if event["event"] == "ended"] if run.is_dir() else []
    reasons = [event["reason"] for event in events if event.get("reason")]
    if reasons:
        return str(reasons[-1])
    said = [line for line in done.stderr.splitlines() if line.strip()]
    return "whole" if done.returncode == 0 else (said or ["nothing said"])[-1]


def _say(row: dict[str, Any]) -> None:
    print(f"{time.strftime('%H:%M:%S')} {row['command']}: {row['seconds']:.0f} s, {row['ended']}", flush=True)


def _judged(times: Path, late: list[np.ndarray]) -> Heard:
    with np.load(times) as kept:
        return heard(kept["reports"], kept["answers"], kept["refused"], late)


def _rows(found: list[tuple[str, str, Heard]]) -> list[list[object]]:
    """Return a row for each command, of all its runs, and one of them all."""
    names = list(dict.fromkeys(name for name, _, _ in found))
    rows = [_row(name, [each for each in found if each[0] == name]) for name in names]
    return [*rows, _row("all", found)]


def _row(name: str, found: list[tuple[str, str, Heard]]) -> list[object]:
    heards = [each for _, _, each in found]
    every = [silence for each in heards for silence in each.silences]
    whose = [sum(silence.whose == one for silence in every) for one in (MACHINE, ROBOT, OURS)]
    broken = [ended for _, ended, _ in found if ended != "whole"]
    return [
        f"`{name}`",
        len(found),
        sum(each.cycles for each in heards),
        f"{1e3 * max(each.largest for each in heards):.1f}",
        len(every),
        *whose,
        f"{1e3 * max(each.slow for each in heards):.1f}",
        sum(each.unanswered for each in heards),
        f"{len(found) - len(broken)} whole" + "".join(f"; {text}" for text in dict.fromkeys(broken)),
    ]


if __name__ == "__main__":
    main()
