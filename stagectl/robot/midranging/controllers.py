"""The controllers that a mid-ranging rig file describes."""

import math
from dataclasses import replace

from ctlblocks.block import Block
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel, integral, lambda_tuned
from stagectl.robot.midranging.valve_position import ValvePosition, ValvePositionAxis
from stagectl.robot.midranging_config import MidrangeConfig

CONTROLLERS = ("aimc", "mvpc", "mvpc-aw", "vpc")


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
    """Return adaptive internal model control that keeps the bandwidths of both loops, as (3.14) does.

    The desired responses are of first order with the loops' time constants.
    """
    fast, slow, rate = fast_loop(config), slow_loop(config), config.pair.rate
    times = fast.time_constant(rate), slow.time_constant(rate)
    order = max(config.pair.order, fast.order, slow.order)
    wanted = [LoopModel.first_order(time, rate) for time in times]
    return InternalModelAxis(
        fast=fast.of_order(order),
        slow=slow.of_order(order),
        desired_fast=wanted[0],
        desired_slow=wanted[1],
        governor=Governor(config.inner.numerator, config.inner.denominator, config.inner.limit, config.pair.travel),
        fast_learning=LeastSquares(smoothing=times[0], **config.learning.model_dump()),
        slow_learning=LeastSquares(smoothing=times[1], **config.learning.model_dump()),
        middle=config.pair.middle,
        estimation=Estimation(**config.estimating.model_dump()),
        fast_delay=config.pair.fast_delay,
        slow_delay=config.pair.slow_delay,
        valve=_valve("mvpc-aw", config),
    )


def known_pair(config: MidrangeConfig, gain: float) -> InternalModelAxis:
    """Return the same controller told what is to be estimated: a process of `gain` (1, > 0) times the first gain."""
    axis = internal_model(config)
    told = LeastSquares(forgetting=1.0, noise=config.learning.noise, deviation=1e-12)
    fast = axis.fast.with_process_gain(gain)
    return replace(axis, fast=fast, fast_learning=told, slow_learning=told)


def _valve(name: str, config: MidrangeConfig) -> ValvePositionAxis:
    rate, factors = config.pair.rate, config.valve
    fast, slow = fast_loop(config).time_constant(rate), slow_loop(config).time_constant(rate)
    wanted = factors.slow_factor * slow
    return ValvePositionAxis(
        fast=lambda_tuned(fast, factors.fast_factor * fast),
        slow=integral(wanted) if name == "vpc" else lambda_tuned(slow, wanted),
        middle=config.pair.middle,
        tracking=factors.tracking_factor * fast if name == "mvpc-aw" else math.inf,
        limit=config.inner.limit,
        inner_gain=config.inner.numerator[0] / config.inner.denominator[0],
        slow_time_constant=slow,
        feed=factors.feed,
    )
