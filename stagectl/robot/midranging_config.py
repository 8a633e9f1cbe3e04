"""The mid-ranging rig file: the pair of manipulators, its controllers, and the simulated pair."""

import math
from typing import Any, Literal

from pydantic import Field

from rigkit.config import Section, code, keywords, setting

Terms = tuple[float, ...]


class Pair(Section):
    """The identified macro and micro manipulator: y_k = sum a_i y_{k-i} + sum b_i w_{k-i}."""

    rate: float = setting(250.0, "samples/s", "sample rate of mid-ranging", ge=10, le=10_000)
    fast_outputs: Terms = setting((0.96,), "", "a_i of the micro manipulator's closed loop", min_length=1, max_length=3)
    fast_inputs: Terms = setting((0.04,), "", "its b_i", min_length=1, max_length=3)
    slow_outputs: Terms = setting(
        (math.exp(-0.004),), "", "a_i of the macro manipulator's closed loop", min_length=1, max_length=3
    )
    slow_inputs: Terms = setting((1.0 - math.exp(-0.004),), "", "its b_i", min_length=1, max_length=3)
    fast_delay: float = setting(0.0, "s", "known dead time of the micro manipulator", ge=0, le=1)
    slow_delay: float = setting(0.0, "s", "of the macro manipulator, of stagectl step", ge=0, le=1)
    order: int = setting(1, "", "order of the models that are estimated, at least that of these", ge=1, le=3)
    middle: float = setting(0.0, "m", "middle of the micro manipulator's travel")
    travel: float = setting(25e-3, "m", "from there to either end of it", gt=0, le=10)


class Inner(Section):
    """The controller inside the micro manipulator's loop, in powers of z^-1."""

    numerator: Terms = setting((5.0,), "1/s", "its numerator, with a direct term", min_length=1, max_length=4)
    denominator: Terms = setting((1.0,), "", "its denominator", min_length=1, max_length=4)
    limit: float = setting(10e-3, "m/s", "where its control signal saturates", gt=0, le=1e3)


class Learning(Section):
    """Recursive least squares on both loops."""

    forgetting: float = setting(0.999, "", "for each sample that is used", gt=0, le=1)
    noise: float = setting(1e-6, "m", "standard deviation of the positions' sensors", gt=0, le=1)
    deviation: float = setting(0.3, "", "prior standard deviation of each parameter, and its upper bound", gt=0, le=100)
    gate: float = setting(
        3.0, "", "estimate while a loop's smoothed input is so many times the noise off its mean", ge=0
    )
    alarm: bool = setting(True, "", "reset the estimator when the residuals are too large for the noise")


class Estimating(Section):
    """The phase before control: square waves on both loops."""

    seconds: float = setting(4.0, "s", "shortest duration of the phase; 0: none", ge=0, le=600)
    accuracy: float = setting(
        0.05, "", "it ends when the models' relative output error, without noise, is this", gt=0, le=1
    )
    acceptable: float = setting(0.4, "", "largest such error with which adaptive control begins; else MVPC", gt=0, le=1)
    half_periods: float = setting(7.0, "", "of the macro manipulator's wave, longest", gt=0, le=1000)
    latest: float = setting(0.4, "", "of a time constant, longest dead time tried; 0: that of pair", ge=0, le=1)
    fast_amplitude: float = setting(0.5e-3, "m", "of the micro manipulator's wave", gt=0, le=1)
    slow_amplitude: float = setting(0.5e-3, "m", "of the macro manipulator's wave", gt=0, le=1)
    fast_half_period: float = setting(0.5, "s", "of the micro manipulator's wave", gt=0, le=100)
    slow_half_period: float = setting(1.0, "s", "of the macro manipulator's wave", gt=0, le=100)


class Valve(Section):
    """Valve position control, tuned by lambda from the pair's models reduced to first order."""

    fast_factor: float = setting(1.0, "", "closed-loop time constant of the fast loop over its own", gt=0, le=100)
    slow_factor: float = setting(1.0, "", "closed-loop time constant of the slow loop over its own", gt=0, le=100)
    tracking_factor: float = setting(1.0, "", "anti-windup time over the fast loop's time constant", gt=0, le=100)
    feed: float = setting(0.0, "", "share of the slow loop's effect subtracted from the fast reference", ge=0, le=1)


class Session(Section):
    """The run."""

    lead: float = setting(14.0, "s", "before the reference begins: the estimation phase, and rest", ge=0, le=600)
    live: bool = setting(False, "", "the robot of [robot] and the stage of [link]; else the pair of simulator")
    axis: Literal["x", "y", "z"] = setting("x", "", "live: the axis of scenarios that have one")
    smoothing: float = setting(0.02, "s", "live: time constant of a low-pass for the stage's references", gt=0, le=1)
    seen: Literal["robot", "tracker"] = setting(
        "robot", "", "live: source of the relative position beside the stage, the robot itself or [tracker]"
    )


class Simulator(Section):
    """The simulated pair."""

    plant: str = code("firmware_sim.macro_micro_blocks:MacroMicro", "module:Class of the pair's Block")
    options: dict[str, Any] = keywords("keywords it is built with", "plant")


class MidrangeConfig(Section):
    """Mid-ranging: the tables below."""

    pair: Pair = Field(default_factory=Pair)
    inner: Inner = Field(default_factory=Inner)
    learning: Learning = Field(default_factory=Learning)
    estimating: Estimating = Field(default_factory=Estimating)
    valve: Valve = Field(default_factory=Valve)
    session: Session = Field(default_factory=Session)
    simulator: Simulator = Field(default_factory=Simulator)
