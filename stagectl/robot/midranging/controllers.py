"""The controllers that a mid-ranging rig file describes."""

from dataclasses import replace

from ctlblocks.block import Block
from stagectl.robot.midranging.design import KINDS, Loops, ValveFactors, internal_model_axis, valve_axis
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel
from stagectl.robot.midranging.valve_position import ValvePosition, ValvePositionAxis
from stagectl.robot.midranging_config import MidrangeConfig

CONTROLLERS = tuple(sorted(("aimc", *KINDS)))


def controller(name: str, config: MidrangeConfig, axes: int = 1) -> Block:
    """Make one of `CONTROLLERS` for some axes; ValueError for another name, or settings that do not fit together."""
    if name not in CONTROLLERS:
        raise ValueError(f"controller is {name!r}, must be one of {', '.join(CONTROLLERS)}")
    if name == "aimc":
        return InternalModel([internal_model(config)] * axes)
    return ValvePosition([_valve(name, config)] * axes)


def fast_loop(config: MidrangeConfig) -> LoopModel:
    """Return the micro manipulator's loop as it was identified."""
    return LoopModel(config.pair.fast_outputs, config.pair.fast_inputs)


def slow_loop(config: MidrangeConfig) -> LoopModel:
    """Return the macro manipulator's loop as it was identified."""
    return LoopModel(config.pair.slow_outputs, config.pair.slow_inputs)


def internal_model(config: MidrangeConfig) -> InternalModelAxis:
    """Return adaptive internal model control that keeps the bandwidths of both loops."""
    learning = config.learning.model_dump()
    gated = LeastSquares(smoothing=fast_loop(config).time_constant(config.pair.rate), **learning)
    estimation = Estimation(**config.estimating.model_dump())
    return internal_model_axis(_loops(config), _governor(config), gated, estimation, _factors(config))


def known_pair(config: MidrangeConfig, gain: float) -> InternalModelAxis:
    """Return the same controller told what is to be estimated: a process of `gain` (1, > 0) times the first gain."""
    axis = internal_model(config)
    told = LeastSquares(forgetting=1.0, noise=config.learning.noise, deviation=1e-12)
    fast = axis.fast.with_process_gain(gain)
    return replace(axis, fast=fast, fast_learning=told, slow_learning=told)


def _valve(name: str, config: MidrangeConfig) -> ValvePositionAxis:
    return valve_axis(name, _loops(config), _governor(config), _factors(config))


def _loops(config: MidrangeConfig) -> Loops:
    pair = config.pair
    delays = pair.fast_delay, pair.slow_delay
    return Loops(fast_loop(config), slow_loop(config), pair.rate, *delays, pair.order, pair.middle)


def _governor(config: MidrangeConfig) -> Governor:
    return Governor(config.inner.numerator, config.inner.denominator, config.inner.limit, config.pair.travel)


def _factors(config: MidrangeConfig) -> ValveFactors:
    return ValveFactors(**config.valve.model_dump())
