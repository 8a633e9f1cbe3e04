"""The rig file that a calibration makes: the given one with the PIDs, the outer loops' weights and a bound on them."""

from collections.abc import Sequence

from calibration.stage_axes.calibration import AxisCalibration
from stagectl.config import ChosenWeights, Inner, Outer, StageConfig
from stagectl.stage.design import Design

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
    made, given = {each.axis: each.beyond for each in found}, config.outer.beyond
    beyond = tuple(made.get(axis, given[at % len(given)]) for at, axis in enumerate(config.stage.axes))
    return config.outer.model_copy(update={"beyond": beyond if len(set(beyond)) > 1 else beyond[:1]})


def _weights(config: StageConfig, found: Sequence[AxisCalibration]) -> ChosenWeights:
    """Return the weights of every axis; a bandwidth of 0 where there are none."""
    made = {each.axis: each.outer.weights if isinstance(each.outer, Design) else None for each in found}
    whole = {}
    for name, given in config.weights:
        before = given or (0.0,) * len(config.stage.axes)
        whole[name] = tuple(
            float(getattr(made[axis], name, 0.0)) if axis in made else before[at]
            for at, axis in enumerate(config.stage.axes)
        )
    return ChosenWeights(**whole)
