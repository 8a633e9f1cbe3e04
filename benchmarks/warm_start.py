"""What a warm start saves: shots to the objective, cold and from a drive of the library, on ten simulated vibrators.

`python -m benchmarks.warm_start [LAW ...] [SEED ...] [--write]`, a minute or two a seed; prints a line a case and then
the table of `docs/library.md`.  Each machine is calibrated by multisine and learns `LEARNED` shots; the last drive is
what is kept.  Then it starts again as `CASES` say, without audio, once cold and once from that drive.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from benchmarks.direct import Machine, shots
from benchmarks.learning_seeds import identified
from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, spread, table, told, words
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.learning.warm_start import KnownDrive
from vibractl.quality import holds_from
from vibractl.setup import Setup, judged_lines, setup

SEEDS = range(1, 11)
LEARNED = {"kalman": 12, "thesis": 30}
SHOTS = {"kalman": 12, "thesis": 30}
JUMP = ("simulator.options.trend_seconds=1",)
SETTLED = 2.0
"""s of silence, in which a trend of one second has come to its end."""
IN_AIR, IN_WATER = ("reference.signal=chirp:40:75:5",), ("simulator.options.medium=water",)


@dataclass(frozen=True)
class Case:
    """What is the same when the drive is learned and when it is tried, what only then, and whether seeds differ."""

    name: str
    both: tuple[str, ...] = ()
    then: tuple[str, ...] = ()
    measured_again: bool = False
    other: int = 0


CASES = (
    Case("unchanged"),
    Case("0.5 % drift", then=("simulator.options.trend=0.005", *JUMP)),
    Case("2 % drift", then=("simulator.options.trend=0.02", *JUMP)),
    Case("10 % more nonlinear", then=("simulator.options.nonlinearity=1.1",)),
    Case("air to water", both=IN_AIR, then=IN_WATER, measured_again=True),
    Case("another machine", measured_again=True, other=1),
)


@dataclass(frozen=True)
class Run:
    """One run.

    `met`, shot from which the objective holds, infinite if never; `over`, worst line of each shot, dB over the limit;
    `levels`, of each shot, 1 or below; `events`, the library's decisions and at which level in dB.
    """

    met: float
    over: list[float]
    levels: list[float]
    events: list[tuple[str, float]]


def learned(made: Setup, count: int) -> tuple[Run, KnownDrive]:
    """Let a machine learn; return the run, and its last drive for the next."""
    machine = Machine(made.config)
    machine.emit(np.zeros((round(SETTLED * made.shot.rate), len(made.config.audio.drive_channels))))
    over, levels, events = [], [], []
    level, lines = made.algorithm().level, made.law.start
    for shot in shots(made, count, machine):
        learner = shot.learner
        over.append(shot.over)
        levels.append(level)
        events += [
            (each.event, each.fields["level_db"]) for each in learner.algorithm.decisions if "entry" in each.fields
        ]
        last, level, lines = lines, learner.algorithm.level, learner.lines.copy()
    first = holds_from([worst <= 0 and level == 1.0 for worst, level in zip(over, levels, strict=True)])
    judged, checked = judged_lines(made.law, made.reference, made.config), made.config.learning.check_levels
    known = KnownDrive("kept", last, learner.heard.copy(), learner.algorithm.belief.response, judged, checked)
    return Run(np.inf if first is None else first, over, levels, events), known


def made_for(seed: int, model_of: tuple[str, ...], settings: tuple[str, ...]) -> Setup:
    """Put a run together on a machine, with a model that was measured under settings of its own."""
    own = f"simulator.options.seed={seed}"
    return setup(rig_file.load(None, RigConfig, (own, *settings)), identified((own, *model_of)).matrix, False)


@cache
def kept(seed: int, settings: tuple[str, ...], count: int) -> KnownDrive:
    """Return the last drive of a run on a machine."""
    return learned(made_for(seed, (), settings), count)[1]


def tried(seed: int, case: Case, law: str) -> tuple[Run, Run]:
    """Return the cold and the warm run of a case."""
    settings = (f"learning.law={law}", *case.both)
    known = kept(seed, settings, LEARNED[law])
    place = (seed - 1 + case.other) % len(SEEDS) + 1
    made = made_for(place, case.then if case.measured_again else (), (*settings, *case.then))
    cold, _ = learned(made, SHOTS[law])
    warm, _ = learned(replace(made, known=known), SHOTS[law])
    return cold, warm


def row(case: Case, law: str, runs: list[tuple[Run, Run]]) -> list[str]:
    """Return a row of the table: medians, and the worst seed in brackets."""
    cold, warm = zip(*runs, strict=True)
    refused = [each.events[0][1] for each in warm if each.events and each.events[0][0] == "library_refused"]
    where = ", ".join(f"{refused.count(level)} at {level:g}" for level in sorted(set(refused)))
    loud = [max(worst for worst, level in zip(each.over, each.levels, strict=True) if level < 1.0) for each in warm]
    full = [next(worst for worst, level in zip(each.over, each.levels, strict=True) if level == 1.0) for each in warm]
    first = [each.over[0] for each in cold]
    cells = [case.name, law, spread([each.met for each in cold]), spread([each.met for each in warm])]
    cells += [f"{len(refused)} of {len(runs)}" + (f" ({where} dB)" if where else "")]
    return [*cells, *(spread(levels, ".0f") for levels in (loud, full, first))]


def every_case(seed: int, law: str) -> list[tuple[Run, Run]]:
    """Return the runs of every case on one machine."""
    return [tried(seed, case, law) for case in CASES]


def main(laws: list[str], seeds: list[int]) -> None:
    rows = []
    for law in laws:
        of_cases = zip(*over_seeds(every_case, seeds, law=law), strict=True)
        for case, runs in zip(CASES, of_cases, strict=True):
            rows.append(row(case, law, list(runs)))
            runs_told = (f"{seed}: {told(warm.met)}" for seed, (_, warm) in zip(seeds, runs, strict=True))
            print(f"{case.name}, {law}, warm;", *runs_told, flush=True)
    head = ["case", "law", "shot, cold", "warm", "refused"]
    head += ["over the limit, dB: check below 0 dB", "first whole shot, warm", "... cold"]
    put(table(head, rows), "library.md", "warm start")


if __name__ == "__main__":
    numbers = [int(text) for text in words() if text not in LEARNED]
    main([text for text in words() if text in LEARNED] or list(LEARNED), numbers or list(SEEDS))
