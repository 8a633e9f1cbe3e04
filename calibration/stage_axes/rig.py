"""The rig file that a calibration makes: the given one with the PIDs, the outer loops' weights and a bound on them."""

from collections.abc import Sequence
from dataclasses import replace

from calibration.stage_axes.calibration import AxisCalibration
from stagectl.config import ChosenWeights, Inner, Outer, StageConfig
from stagectl.stage.allowed_gains import of_axis
from stagectl.stage.design import Design
from stagectl.stage.weights import Weights

CHOSEN = "inner", "outer", "weights"
"""Tables of a rig file that a calibration chooses."""


def calibrated_rig(config: StageConfig, found: Sequence[AxisCalibration]) -> StageConfig:
    """Return the rig file for `stagectl run`; what was not calibrated stays.

    Parameters
    ----------
    config : StageConfig
    found : sequence of AxisCalibration
    """
    made = {"inner": _inner(config, found), "outer": _outer(config, found), "weights": _weights(config, found)}
    return config.model_copy(update=made)


def _inner(config: StageConfig, found: Sequence[AxisCalibration]) -> Inner:
    made = {each.axis: each.opened.inner for each in found}
    whole = {}
    for name in ("gain", "bandwidth"):
        given: tuple[float, ...] = getattr(config.inner, name)
        whole[name] = tuple(
            getattr(made[axis], name)[0] if axis in made else given[at % len(given)]
            for at, axis in enumerate(config.stage.axes)
        )
    return config.inner.model_copy(update=whole)


def _outer(config: StageConfig, found: Sequence[AxisCalibration]) -> Outer:
    """Return the bounds with the gains that are allowed at every frequency; of other axes as they were."""
    made, outer, axes = {each.axis: each.allowed for each in found}, config.outer, config.stage.axes
    before = outer.allowed or outer.beyond
    allowed = tuple(made.get(axis, of_axis(before, at)) for at, axis in enumerate(axes))
    return outer.model_copy(update={"allowed": allowed})


def _weights(config: StageConfig, found: Sequence[AxisCalibration]) -> ChosenWeights:
    """Return the weights of every axis; a bandwidth of 0 where there are none."""
    made = {each.axis: _chosen(each.outer) if isinstance(each.outer, Design) else None for each in found}
    whole = {}
    for name, given in config.weights:
        before = given or (0.0,) * len(config.stage.axes)
        whole[name] = tuple(
            float(getattr(made[axis], name, 0.0)) if axis in made else before[at]
            for at, axis in enumerate(config.stage.axes)
        )
    return ChosenWeights(**whole)


def _chosen(design: Design) -> Weights:
    """Return a loop's weights with the gains that it reaches where it is bounded frequency by frequency."""
    made = {"beyond": 1.005 * design.beyond, "forward_share": 1.005 * design.forward_share}
    return replace(design.weights, **{name: float(f"{value:.3g}") for name, value in made.items()})
