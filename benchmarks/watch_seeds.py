"""What `--watch` does about a mode near 545 Hz that moves in mid-run, and that it says nothing when none moves.

`python -m benchmarks.watch_seeds [SEED ...] [--write]`, a minute or two a seed; prints the table of `docs/watch.md`.
Each simulated vibrator is calibrated by multisine and learns the default reference without audio: `SHOTS` shots of
which the mode moves after `ONSET`, once watched and once not, and `CLEAN` shots in which it stays.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.direct import met, shots
from benchmarks.learning_seeds import SHOT, identified
from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, spread, table, words
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.quality import decibels
from vibractl.setup import setup

SEEDS = range(1, 11)
ONSET, SHOTS, CLEAN = 15, 30, 60
WIDTHS = (1.0, 1.5)
MOVES = ("simulator.options.moving_mode=545", "simulator.options.moving_seconds=6")


@dataclass(frozen=True)
class Outcome:
    """One run.

    `over`, worst line of each shot, dB over the limit; `found`, shots of the first alarm of each band; `probes`, shots
    with a chirp; `chirp`, what the chirps' shots differ by from the shot before on the worst line, dB over the limit;
    `before` and `after`, norm of the error map in each band; `kinds`, events in their order.
    """

    over: list[float]
    found: list[int]
    probes: list[int]
    chirp: list[float]
    before: list[float]
    after: list[float]
    kinds: list[str]

    @property
    def met(self) -> float:
        """Shot from which the objective holds to the end."""
        return met(self.over)


def watched(seed: int, count: int, *settings: str) -> Outcome:
    """Learn, and take down what was decided."""
    own = (f"simulator.options.seed={seed}",)
    made = setup(rig_file.load(None, RigConfig, (*own, *settings)), identified(own).matrix)
    run, probing, last = Outcome([], [], [], [], [], [], []), False, np.zeros(0)
    for number, heard in enumerate(shots(made, count)):
        run.over.append(heard.over)
        lines = heard.judge.lines(heard.error)[heard.judge.judged]
        if probing:
            run.probes.append(number)
            run.chirp.append(float(decibels((lines - last) / heard.judge.limit).max()))
        for each in heard.learner.algorithm.decisions:
            run.kinds.append(each.event)
            if each.event == "divergence":
                run.found.append(number)
            if each.event == "reidentified":
                run.before.append(each.fields["contraction_before"])
                run.after.append(each.fields["contraction_after"])
        probing, last = heard.learner.algorithm.purpose == "reidentify", lines
    return run


def of_seed(seed: int) -> dict[object, Outcome]:
    """Return all runs of one vibrator."""
    runs: dict[object, Outcome] = {"clean": watched(seed, CLEAN, "watch.on=true")}
    for widths in WIDTHS:
        moves = (*MOVES, f"simulator.options.moving_widths={widths}", f"simulator.options.moving_at={ONSET * SHOT}")
        runs[widths] = watched(seed, SHOTS, "watch.on=true", *moves)
        runs[widths, "alone"] = watched(seed, SHOTS, *moves)
    return runs


def row(widths: float, runs: list[dict[object, Outcome]]) -> list[str]:
    """Return a row of the table."""
    seen, alone = [of[widths] for of in runs], [of[widths, "alone"] for of in runs]
    alarmed = [run for run in seen if run.found]
    bands = [len(run.found) for run in alarmed]
    spent = [len(run.probes) / len(run.found) for run in alarmed]
    lasting = [f"{sum(np.isfinite(run.met) for run in kind)} of {len(runs)}" for kind in (seen, alone)]
    outside = [f"{sum(over > 0 for over in run.over[ONSET:])}" for run in seen]
    outside_alone = [f"{sum(over > 0 for over in run.over[ONSET:])}" for run in alone]
    return [
        f"{widths:g}",
        f"{len(alarmed)} of {len(runs)}",
        spread([run.found[0] - ONSET for run in alarmed]),
        spread(bands),
        f"{max(spent, default=0):g}",
        f"{max((level for run in seen for level in run.chirp), default=-np.inf):.1f}",
        spread([ratio for run in seen for ratio in run.before], ".1f"),
        spread([ratio for run in seen for ratio in run.after], ".1f"),
        *(f"{kept}; {', '.join(of)}" for kept, of in zip(lasting, (outside, outside_alone), strict=True)),
    ]


def main(seeds: list[int]) -> None:
    runs = []
    for seed, of in zip(seeds, over_seeds(of_seed, seeds), strict=True):
        runs.append(of)
        for name, run in of.items():
            told = f"met from {run.met:g}, found {run.found}, chirps {np.round(run.chirp, 1)}, {run.kinds}"
            print(f"seed {seed}, {name}: {told}; {np.round(run.over[ONSET:], 1)}", flush=True)
    head = ["moves by, widths", "alarm on", "shots after onset", "bands", "most chirp shots a band"]
    head += ["chirp shot less the one before, worst line, dB over the limit", "error map before", "... after"]
    head += ["met at the end; shots over the limit from onset on, each seed", "... without the watch"]
    put(table(head, [row(widths, runs) for widths in WIDTHS]), "watch.md", "watch seeds")
    alarms = sum(len(of["clean"].found) for of in runs)
    print(f"{alarms} alarms on {len(runs)} vibrators whose modes stay, over {CLEAN} shots each")


if __name__ == "__main__":
    main([int(text) for text in words()] or list(SEEDS))
