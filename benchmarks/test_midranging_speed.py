"""Adaptive internal model control a sample a call: compiled, and in plain numpy."""

import math
from dataclasses import replace
from statistics import median
from time import perf_counter

import numpy as np

from benchmarks.midranging_numpy import NumpyAxis
from firmware_sim.macro_micro_blocks import MacroMicro
from rigkit import config as rig_file
from stagectl.experiments.midranging.scenario import scenario
from stagectl.robot.midranging.controllers import internal_model
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging_config import MidrangeConfig

RATE, SAMPLES = 250.0, 6_000


def axis_of(travel: float, *settings: str) -> InternalModelAxis:
    made = internal_model(rig_file.load(None, MidrangeConfig, ["pair.order=3", "learning.noise=2e-5", *settings]))
    return replace(made, governor=replace(made.governor, travel=travel), estimation=Estimation(0.0))


def seen_by(axis: InternalModelAxis) -> tuple[list[list[np.ndarray]], np.ndarray]:
    """Return what the controller saw in a closed loop, a sample a row, and its answers, shape (samples, 2), m."""
    block, plant, chosen = (
        InternalModel([axis]),
        MacroMicro(noise=2e-5, gains=((8.0, 1.5), (16.0, 0.6))),
        scenario("thesis-2", RATE),
    )
    block.prepare(RATE, 1)
    plant.prepare(RATE, 1)
    made = [np.zeros((1, port.width)) for port in block.outputs]
    shown = [np.zeros((1, 1)) for _ in plant.outputs]
    seen, answers = [], []
    for value in chosen.reference[:SAMPLES]:
        seen.append([np.array([[value]]), *(signal.copy() for signal in shown[:3])])
        block.process(*seen[-1], *made)
        answers.append([made[0][0, 0], made[1][0, 0]])
        plant.process(made[0], made[1], *shown)
    return seen, np.array(answers)


def compiled_call(axis: InternalModelAxis, seen: list[list[np.ndarray]]) -> float:
    """Return the seconds of a call."""
    block = InternalModel([axis])
    block.prepare(RATE, 1)
    made = [np.zeros((1, port.width)) for port in block.outputs]
    start = perf_counter()
    for signals in seen:
        block.process(*signals, *made)
    return (perf_counter() - start) / len(seen)


def plain_call(axis: InternalModelAxis, seen: list[list[np.ndarray]]) -> tuple[float, np.ndarray]:
    """Return the seconds of a call in numpy, and the answers, shape (samples, 2), m."""
    plain, start = NumpyAxis(axis, RATE), perf_counter()
    got = [plain.step(*(float(signal[0, 0]) for signal in signals)) for signals in seen]
    return (perf_counter() - start) / len(seen), np.array(got)


def test_numpy_and_the_kernel_answer_the_same(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """With models of first order: of higher ones, parameters that cannot be told apart follow the rounding."""
    axis = axis_of(math.inf, "pair.order=1")
    seen, answers = seen_by(axis)
    _, got = benchmark.pedantic(plain_call, (axis, seen), rounds=1)
    assert abs(got - answers).max() < 1e-8 * abs(answers).max()


def calls(rounds: int = 7) -> tuple[float, float]:
    """Return the seconds of a call of one sample, order 3: compiled, the median of some rounds, and in numpy."""
    axis = axis_of(math.inf, "learning.gate=0", "learning.alarm=false")
    seen, _ = seen_by(axis)
    return median(compiled_call(axis, seen) for _ in range(rounds)), plain_call(axis, seen)[0]


def test_a_sample_of_order_three(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print what a call of one sample costs, with and without the travel, and in numpy."""
    axis = axis_of(math.inf, "learning.gate=0", "learning.alarm=false")
    seen, _ = seen_by(axis)
    compiled, in_numpy = calls()
    bounded = median(compiled_call(axis_of(5e-3), seen) for _ in range(7))
    print(f"\nnumpy {1e6 * in_numpy:.1f} us, compiled {1e6 * compiled:.2f} us ({in_numpy / compiled:.0f} times), "
          f"with the travel 100 samples ahead {1e6 * bounded:.2f} us")  # fmt: skip
    block = InternalModel([axis])
    block.prepare(RATE, 1)
    made = [np.zeros((1, port.width)) for port in block.outputs]
    benchmark(block.process, *seen[0], *made)
