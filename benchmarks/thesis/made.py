"""Figures of the thesis that no program prints: each case is run in its group's folder and returns what is kept."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import planning, planning_chapter_7, time_domain_ilc
from benchmarks.thesis.derived import clamped, compared, force_error, models, ratios, shots, spectra, watched
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from stagectl.planning.exact import least_time
from stagectl.planning.features import FeaturesPlanner
from stagectl.planning.milling import Milled, mill, total
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.sequential import Rule, SequentialPlanner

TABLES = 50
"""Random tables of types for each size of pocket."""
LIFTING = 1.0
"""s, of the tables in which a side is slower."""
TEN_BY_TWENTY: Mapping[str, float] = {"E": 0.6697, "W": 0.6697, "N": 0.7003, "S": 0.7003}
"""s per cell of a slot, fig. 8.8: with these and `ACCELERATING` the three times that are printed come out."""
ACCELERATING = 0.243
"""s a segment."""
SLOWER = 4.0
"""Times longer, sec. 8.3."""
LOOPS = (("whole", 0.0, 1000.0, 1.0), ("faster", 0.0, 1000.0, 10.0), ("smaller", 300.0, 700.0, 1.0))
"""Name, V from and to, Hz."""
DRAWN = 10
"""Tables on which weights are trained."""
CREEPING = (10.0, 30.0)
"""s after the ramp to 500 V."""


def creep() -> dict[str, float]:
    """Say how fast the stacks of the simulated stage, seed 1, grow at a constant 500 V: um/s, by axis."""
    plant, rate = PiezoStagePlant(10_000.0), 10_000
    ramp = np.linspace(0.0, 500.0, rate // 2)
    voltage = np.concatenate([ramp, np.full(round(CREEPING[1] * rate), 500.0)])[:, None] * np.ones(3)
    still = np.zeros_like(voltage)
    extension, position, absolute = (np.zeros_like(voltage) for _ in range(3))
    plant.run(voltage, still, still, extension, position, absolute)
    first, last = (len(ramp) + round(each * rate) - rate for each in CREEPING)
    means = [extension[begin : begin + rate].mean(axis=0) for begin in (first, last)]
    grown = 1e6 * (means[1] - means[0]) / (CREEPING[1] - CREEPING[0])
    return dict(zip("xyz", map(float, grown), strict=True))


def loops() -> dict[str, float]:
    """Say how far the loop of x's stack opens over its span, seed 1, by the triangle: V and Hz; 1."""
    told = {}
    for name, low, high, frequency in LOOPS:
        samples = round(10_000 / frequency)
        up = np.linspace(low, high, samples // 2, endpoint=False)
        triangle = np.tile(np.concatenate([up, np.linspace(high, low, samples // 2, endpoint=False)]), 4)
        voltage = triangle[:, None] * np.ones(3)
        still = np.zeros_like(voltage)
        extension, position, absolute = (np.zeros_like(voltage) for _ in range(3))
        PiezoStagePlant(10_000.0).run(voltage, still, still, extension, position, absolute)
        last = extension[-samples:, 0]
        rising, falling = last[: samples // 2], last[samples // 2 :][::-1]
        told[name] = float(np.abs(falling - rising).max() / np.ptp(last))
    return told


def weights() -> dict[str, float]:
    """Train the features' weights on 13 x 13 cells: means, and their largest deviations from table to table, 1."""
    pockets = [pocket for pocket, _ in planning.drawn(DRAWN, 13, 13, "EWNS")]
    found = np.array([FeaturesPlanner(pocket, seed).weights for seed, pocket in enumerate(pockets)])
    mean, spread = found.mean(axis=0), np.abs(found - found.mean(axis=0)).max(axis=0)
    return {"w1": mean[0], "w2": mean[1], "w1_spread": spread[0], "w2_spread": spread[1]}


def time_domain() -> dict[str, Any]:
    """Identify one side of the vibrator at order 18, and learn by (6.8)."""
    found = time_domain_ilc.outcome(1, 18)
    told = {"vaf": found.vaf, "zeros_outside": found.outside, "last_shot": len(found.level) - 1}
    return told | {"ran_away": len(found.level) <= time_domain_ilc.SHOTS}


def chapter_7() -> dict[str, Any]:
    """Mill the pockets of table 7.1 with the training that is printed: s, by simulation."""
    pocket = planning_chapter_7.published()
    rate = {name: each * (5.0 if name[0] == "E" else 1.0) for name, each in pocket.rate.items()}
    slow = replace(pocket, rate=rate)
    trained = planning_chapter_7.training()
    runs = {
        "1": _three(pocket, SequentialPlanner(pocket, trained)),
        "3": _three(pocket, SequentialPlanner(pocket, {})),
        "4": _three(pocket, SequentialPlanner(pocket, {}, Rule(eta=1.25))),
        "5": _three(slow, SequentialPlanner(slow, {})),
    }
    spoiled = [planning_chapter_7.spoiled_run(pocket, seed) for seed in range(planning_chapter_7.NOISE_DRAWS)]
    lowered, seconds = planning_chapter_7.weighed_forces(pocket)
    return {
        "rule_over_optimum": runs["1"][2] / least_time(pocket) - 1.0,
        "slow_over_optimum": runs["5"][2] / least_time(slow) - 1.0,
        "auto_mean": float(np.mean(runs["3"])),
        "simulations": runs | {"2": [_total(each) for each in spoiled[0][0]]},
        "deviation_lowered": float(np.mean([each[1] for each in spoiled])),
        "force_deviation_lowered": lowered,
        "force_weighed": seconds,
    }


def two_directions() -> dict[str, Any]:
    """Compare chapter 7's rule with Q-learning (Method 1) on 12 x 12 and 13 x 13 cells: shares and mean gaps, 1."""
    told: dict[str, Any] = {}
    for size in (12, 13):
        pockets = list(planning.drawn(TABLES, size, size, "EW"))
        rule, learned = (planning.gaps(name, pockets) for name in ("sequential", "qlearning"))
        told[f"{size}x{size}"] = {
            "rule_optimal": float(np.mean(rule < planning.OPTIMAL)),
            "learned_optimal": float(np.mean(learned < planning.OPTIMAL)),
            "alike": float(np.mean(np.abs(rule - learned) < planning.OPTIMAL)),
            "learned_worse": float(np.mean(learned > rule + planning.OPTIMAL)),
            "rule_gap": float(rule.mean()),
            "learned_gap": float(learned.mean()),
        }
    return told


def slower_side() -> dict[str, Any]:
    """Make the side that a planner begins with 40 % slower, 18 x 18 cells: mean times, s, of both methods."""
    pockets = [pocket for pocket, _ in planning.drawn(TABLES, 18, 18, "EWNS", LIFTING)]
    runs = {name: np.array([planning.slowed(name, pocket) for pocket in pockets]) for name in ("qlearning", "features")}
    times = {name: float(run[:, 1].mean()) for name, run in runs.items()}
    stays = {name: float(run[:, 0].mean()) for name, run in runs.items()}
    return {"time": times, "stays": stays, "four_over_two": times["features"] / times["qlearning"]}


def known_slower_side() -> dict[str, Any]:
    """Tell both methods beforehand which side is 40 % slower, 18 x 18 cells: mean times, s."""
    times: dict[str, list[float]] = {"qlearning": [], "features": []}
    for pocket, _ in planning.drawn(TABLES, 18, 18, "EWNS", LIFTING):
        side = mill(pocket, planner("qlearning", pocket))[0].cut.side
        known = replace(pocket, theta={side: planning.SLOWDOWN})
        for name, taken in times.items():
            taken.append(total(mill(known, planner(name, known))))
    means = {name: float(np.mean(taken)) for name, taken in times.items()}
    return {"time": means, "four_over_two": means["features"] / means["qlearning"]}


def ten_by_twenty() -> dict[str, str]:
    """Write fig. 8.8's pockets, quick.json and slow.json, as `stagectl plan` reads them."""
    rate = {f"{feed}2": seconds for feed, seconds in TEN_BY_TWENTY.items()}
    rate |= {f"{feed}1{hand}": seconds for feed, seconds in TEN_BY_TWENTY.items() for hand in "ud"}
    pocket = Pocket(20, 10, 2, "EWNS", rate, t_acc=ACCELERATING)
    for name, factor in (("quick", 1.0), ("slow", SLOWER)):
        text = json.dumps({**asdict(replace(pocket, t_acc=factor * ACCELERATING)), "rate": rate})
        Path(f"{name}.json").write_text(text, encoding="utf-8")
    return {"quick": "quick.json", "slow": "slow.json"}


CASES: Mapping[str, Callable[..., Mapping[str, Any]]] = {
    "creep": creep,
    "loops": loops,
    "weights": weights,
    "time-domain": time_domain,
    "chapter-7": chapter_7,
    "two-directions": two_directions,
    "slower-side": slower_side,
    "known-slower-side": known_slower_side,
    "ten-by-twenty": ten_by_twenty,
    "clamped": clamped,
    "force-error": force_error,
    "models": models,
    "ratios": ratios,
    "shots": shots,
    "spectra": spectra,
    "compared": compared,
    "watched": watched,
}


def _three(pocket: Pocket, chosen: SequentialPlanner) -> list[float]:
    return [_total(mill(pocket, chosen)) for _ in range(planning_chapter_7.POCKETS)]


def _total(done: list[Milled]) -> float:
    return float(total(done))
